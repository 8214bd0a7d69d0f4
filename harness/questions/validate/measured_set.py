"""What measured sets have in common: a table of a name and numbers a line, a body that is thrown, models that are asked."""

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any, Final

import numpy as np

from analytic.closed_form import rectangle_ratio
from analytic.excitation import ZeroExcitation
from harness import engines
from harness.accuracy.refinement import RunTarget
from harness.input.files import decimals, decoded, read_bytes
from harness.input.scene_file import load_scene
from harness.model import (
    Answer,
    Array,
    BaseExcitation,
    Contact,
    Initial,
    Mistake,
    Pose,
    Scene,
    caution,
    info,
    refuse,
    require,
)
from harness.questions.validate.scenes import Model, parse_model
from harness.records.validation import Cell, MeasuredRecord, MeasuredTable
from harness.runs.runner import Pool

LARGEST: Final = 1e9
"""No length, time, mass or rate in SI units that was measured is larger, and squares of larger ones may overflow."""
FITTED: Final = 1.0 / 3.0
"""Share of a set on which coefficients are fitted."""
Rows = list[Sequence[Cell]]


@dataclass(frozen=True, eq=False)
class MeasuredSet:
    """A table of measurements and what is asked of it: the scene whose statue was thrown, the models, draws of each throw.

    `on_progress` hears how many throws are computed, of how many. `told` makes the record of what came of it.
    """

    table: Path
    body: Scene | None
    models: Sequence[str]
    samples: int
    seed: int
    pool: Pool
    on_progress: Callable[[int, int], None]
    told: Callable[..., MeasuredRecord]

    @property
    def base(self) -> Scene:
        """The scene whose statue was thrown."""
        assert self.body is not None
        return self.body

    def asked(self, otherwise: Sequence[str]) -> list[Model]:
        """The models asked for, or the usual ones."""
        return [parse_model(name) for name in engines.asked(self.models, otherwise)]

    def shares(self, count: int) -> tuple[list[int], list[int]]:
        """Numbers of the set's members that are fitted on, a seeded third, and of those that are scored."""
        order = np.random.default_rng(self.seed).permutation(count).tolist()
        most = max(round(FITTED * count), 1)
        return sorted(order[:most]), sorted(order[most:])


def header(path: Path) -> tuple[str, ...]:
    """The names of a table's columns, however they are parted: of a table of something else too."""
    return tuple(name.strip() for name in _lines(path)[0].split(","))


def read_groups(path: Path, columns: Sequence[str]) -> list[tuple[str, Array]]:
    """The numbers (n, columns − 1) of lines that follow each other with one name in the first column, by that name.

    Raises `InputError` with every line that is wrong, and for a name that comes back after another.
    """
    first, *lines = _lines(path)
    headed = tuple(name.strip() for name in first.split(",")) == tuple(columns)
    require(headed, str(path), ", ".join(columns), first or "nothing", key="header")
    rows: list[tuple[str, list[float]]] = []
    mistakes = []
    for number, line in enumerate(lines, 2):
        if not line.strip():
            continue
        (name, *cells), place = line.split(","), f"line {number}"
        try:
            values = decimals(cells)
        except ValueError as error:
            mistakes.append(Mistake(str(path), place, "decimal numbers", str(error)))
            continue
        if len(values) != len(columns) - 1:
            mistakes.append(Mistake(str(path), place, f"{len(columns)} cells", f"{len(values) + 1}"))
        mistakes += [
            Mistake(str(path), f"{place}: {column}", f"a number of at most {LARGEST:g}", f"{value:g}")
            for column, value in zip(columns[1:], values, strict=False)
            if not abs(value) <= LARGEST
        ]
        rows.append((name.strip(), values))
    require(rows or mistakes, str(path), "at least one line of numbers", "none")
    refuse(mistakes)
    groups = [(name, np.array([values for _, values in same])) for name, same in groupby(rows, lambda row: row[0])]
    wanted = f"all lines of a {columns[0]} after each other"
    seen = Counter(name for name, _ in groups)
    refuse(
        [Mistake(str(path), f"{columns[0]} {name}", wanted, "others between them") for name in seen if seen[name] > 1]
    )
    return groups


def _lines(path: Path) -> list[str]:
    return decoded(read_bytes(path, "a table"), str(path), "a CSV file with a header").splitlines() or [""]


def body_alone(path: Path) -> Scene:
    """The scene whose statue is thrown. Raises `InputError` for one with a pedestal or a wall, which no measured throw has."""
    base = load_scene(path)
    beside = [name for name in ("pedestal", "wall") if getattr(base, name) is not None]
    refuse([Mistake(str(path), name, "a body alone over the floor", "one beside it") for name in beside])
    return base


def thrown(base: Scene, start: Pose, contact: Contact, duration_s: float, frame_s: float) -> Scene:
    """The body of a scene thrown onto a still floor, looked at in every frame."""
    still = ZeroExcitation()
    return replace(
        base,
        duration_s=duration_s,
        contact=contact,
        base_excitation=BaseExcitation(still, still, still),
        initial=Initial(pose=start),
        output_dt_s=frame_s,
    )


def target_of(model: Model, frame_s: float, steps: int) -> RunTarget:
    """The accuracy of an engine that states its error, else a step: the one that was asked for, or so many in a frame.

    Frames are whole steps: poses between two steps would be interpolated across a turn of an angle.
    """
    if model.dt_s is not None:
        steps = max(round(frame_s / model.dt_s), 1)
    elif engines.load(model.engine).capabilities.certifies:
        return RunTarget(model.accuracy_rad)
    return RunTarget(dt_s=frame_s / steps)


def by_name(
    pool: Pool, work: Callable[[Any], Any], throws: Sequence[Any], told: Callable[[int], None] = lambda done: None
) -> dict[str, Any]:
    """What `work` makes of each throw, by its name in their order (a `Crash` where its process died); `told` hears how many."""
    answers: dict[str, Any] = {}

    def done(throw: Any, answer: Any) -> None:
        answers[throw.name] = answer
        told(len(answers))

    pool.run(work, throws, done)
    return {throw.name: answers[throw.name] for throw in throws}


# Measured ratios of angular velocities over the first impact of free-rocking blocks, beside the model's and an imposed one.
#
# One line a trial: `group` (trials of one block), `trial`, `width_m, height_m, depth_m, mass_kg`, `ratio_measured`.

RATIO_COLUMNS: Final = ("group", "trial", "width_m", "height_m", "depth_m", "mass_kg", "ratio_measured")
GROUP_COLUMNS: Final = (
    "group", "slenderness", "trials", "measured_mean", "measured_sd", "housner", "housner_less_measured", "its_error",
    "imposed_less_measured",
)  # fmt: skip
LAW_COLUMNS: Final = ("law", "bias", "rms", "rms_over_scatter", "trials", "scatter_of_repeats")


@dataclass(frozen=True, eq=False)
class BlockTrials:
    """The trials of one block: height over width, measured ratios (n,), the model's (angular momentum about the new corner is
    kept).
    """

    name: str
    slenderness: float
    measured: Array
    housner: float


def read_ratios(path: Path) -> list[BlockTrials]:
    """The groups of a table. Raises `InputError` for a wrong one."""
    groups, mistakes = [], []
    for name, table in read_groups(path, RATIO_COLUMNS):
        sizes, ratios = table[:, 1:5], table[:, 5]
        if not (sizes > 0.0).all() or np.ptp(sizes, axis=0).any():
            mistakes.append(
                Mistake(str(path), f"group {name}", "one block: positive sizes, the same in all lines", "others")
            )
        elif not (ratios > 0.0).all():
            mistakes.append(Mistake(str(path), f"group {name}: ratio_measured", "positive ratios", f"{ratios.min():g}"))
        else:
            slenderness = float(sizes[0, 1] / sizes[0, 0])
            groups.append(BlockTrials(name, slenderness, ratios, rectangle_ratio(math.atan(1.0 / slenderness))))
    if not mistakes and (len(groups) < 2 or max(group.measured.size for group in groups) < 2):
        mistakes.append(Mistake(str(path), "", "two groups, and a repeated trial", f"{len(groups)} groups"))
    refuse(mistakes)
    return groups


def repeats_sd(groups: Sequence[BlockTrials]) -> float:
    """Standard deviation of repeated trials about their group's mean, pooled over the groups."""
    squares = sum(float(np.sum((group.measured - group.measured.mean()) ** 2)) for group in groups)
    return math.sqrt(squares / sum(group.measured.size - 1 for group in groups))


def imposed(groups: Sequence[BlockTrials]) -> list[float]:
    """One ratio for all blocks, for each group the mean of the others: no block is predicted by its own trials."""
    means = [float(group.measured.mean()) for group in groups]
    return [(sum(means) - own) / (len(means) - 1) for own in means]


def scored_ratios(measured: MeasuredSet) -> MeasuredRecord:
    """Bias and scatter of the model's ratio and of an imposed one against measured ones; `InputError` for a wrong table."""
    groups = read_ratios(measured.table)
    scatter, given = repeats_sd(groups), imposed(groups)
    rows: Rows = []
    for group, ratio in sorted(zip(groups, given, strict=True), key=lambda pair: pair[0].slenderness):
        mean, count = float(group.measured.mean()), group.measured.size
        own, error = float(group.measured.std(ddof=1)) if count > 1 else None, scatter / math.sqrt(count)
        housner = group.housner
        rows.append([group.name, group.slenderness, count, mean, own, housner, housner - mean, error, ratio - mean])
    every = np.concatenate([group.measured for group in groups])
    laws = {"housner": [group.housner for group in groups], "imposed": given}
    counts = [group.measured.size for group in groups]
    missed = {law: np.repeat(ratios, counts) - every for law, ratios in laws.items()}
    misses = {law: (float(each.mean()), float(np.sqrt(np.mean(each**2)))) for law, each in missed.items()}
    sums: Rows = [[law, bias, rms, rms / scatter, every.size, scatter] for law, (bias, rms) in misses.items()]
    bias, rms = misses["housner"]
    above = int(np.sum(every > 1.0))
    mean = float(np.mean([group.measured.mean() for group in groups]))
    found = [info("ratio_imposed", ratio=mean, rms=misses["imposed"][1])]
    if above:
        found.append(caution("ratios_gain", count=above, of=every.size))
    return measured.told(
        title=f"{every.size} measured ratios at first impacts",
        answer=Answer(
            "impact_ratios", [info("ratios_missed", bias=bias, rms=rms, scatter=scatter, share=rms / scatter)]
        ),
        tables=[MeasuredTable("laws", LAW_COLUMNS, sums), MeasuredTable("groups", GROUP_COLUMNS, rows)],
        findings=found,
    )
