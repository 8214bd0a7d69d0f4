"""A rocking spectrum: blocks of every size and slenderness in a set of motions, by one compiled sweep for each motion.

Peak rotation over the balance angle against size and slenderness, after Makris and Konstantinidis (Earthquake Engineering and
Structural Dynamics 32, 2003), and beside it the share of the motions that overturn.
"""

import csv
import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from analytic import Block, Form, Outcome, ensemble
from analytic.excitation import Excitation
from harness.comparison.statistics import wilson
from harness.input.mistakes import UserTable, agree
from harness.input.motions import SceneMotion, prepare
from harness.input.motions.recordfile import STANDARD_GRAVITY_M_S2
from harness.input.motions.spec import RecordSpec, Source
from harness.input.tables import read_model
from harness.model import Answer, Array, Say, info, machine, read_each, versions
from harness.records.base import write_whole
from harness.records.study import RockingSpectrumRecord, SpectrumMotion, SpectrumSummary
from harness.runs.execute import OnProgress
from harness.runs.runner import Pool

KIND: Final = "rocking_spectrum"
MAP_NAME: Final = "spectrum.csv"
COLUMNS: Final = (
    "size_m",
    "slenderness",
    "probability_overturned",
    "low",
    "high",
    "peak_median_over_alpha",
    "peak_84_over_alpha",
)
REFUSES: Final = dict.fromkeys(
    ("--export", "--resume", "--dask", "--witness"),
    f"a study of cases: a rocking spectrum is computed at once, its map is {MAP_NAME}",
)
RING_DOWN_S: Final = 5.0
"""Time after a motion's end in which rocking may still decide."""
HIGH: Final = 0.84
"""The quantile of the peak beside the median: one standard deviation of a lognormal."""
DIGITS: Final = 5
"""Significant digits of a peak in the record: the sweep aims at 1e-6 rad."""


class ValueRange(UserTable):
    """`count` values from `start` to `stop`."""

    start: Annotated[float, Field(gt=0.0, le=1e3)]
    stop: Annotated[float, Field(gt=0.0, le=1e3)]
    count: Annotated[int, Field(ge=2, le=1000)]
    spacing: Literal["linear", "log"] = "linear"

    @model_validator(mode="after")
    def _rises(self) -> Self:
        agree((self.stop > self.start, "stop", f"more than start = {self.start:g}", f"{self.stop:g}"))
        return self

    def values(self) -> Array:
        """The values, shape (count,)."""
        grid = np.geomspace if self.spacing == "log" else np.linspace
        return np.asarray(grid(self.start, self.stop, self.count))


class SpectrumFile(UserTable):
    """A whole file of `kind = "rocking_spectrum"`: motions, half diagonals R in m, slendernesses h/b.

    `draws` strengths of each motion are drawn from a lognormal of median 1 and `strength_cov`. A motion turned round shakes a
    symmetric block to the mirrored history, and need not be run.
    """

    kind: Literal["rocking_spectrum"]
    title: Annotated[str, Field(min_length=1)]
    motion: Annotated[list[Source], Field(min_length=1, max_length=1000)]
    size_m: ValueRange
    slenderness: ValueRange
    restitution: Literal["momentum"] | Annotated[float, Field(ge=0.0, le=1.0)] = "momentum"
    strength_cov: Annotated[float, Field(ge=0.0, le=2.0)] = 0.0
    draws: Annotated[int, Field(ge=1, le=10_000)] = 1
    seed: Annotated[int, Field(ge=0)] = 0

    @model_validator(mode="after")
    def _whole(self) -> Self:
        together, start = (self.draws > 1) == (self.strength_cov > 0.0), self.slenderness.start
        agree(
            (together, "draws", "draws and strength_cov together", f"{self.draws}, {self.strength_cov:g}"),
            (start > 1.0, "slenderness", "blocks higher than wide: start above 1", f"{start:g}"),
        )
        return self


def motions_of(spectrum: SpectrumFile, path: Path) -> list[Excitation]:
    """The excitations of all motions. Raises `InputError` that names what is wrong of each."""
    wanted = [
        SceneMotion(RecordSpec(kind="record", **source.model_dump()), path.parent, str(path), f"motion.{number}")
        for number, source in enumerate(spectrum.motion)
    ]
    return [each.excitation for each in read_each(prepare, wanted)]


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Over all cases by size and slenderness: share that overturns, median and 84 % of the peak over α (inf: overturns)."""

    probability: Array
    median: Array
    high: Array
    undecided: float
    cases: int


def compute(
    spectrum: SpectrumFile,
    excitations: list[Excitation],
    *,
    threads: int | None = None,
    on_progress: Callable[[int, int], None] = lambda done, total: None,
) -> Spectrum:
    """Run every block of the grid in every motion with every draw of its strength: one sweep for each."""
    size, slenderness = np.meshgrid(spectrum.size_m.values(), spectrum.slenderness.values(), indexing="ij")
    alpha = np.arctan(1.0 / slenderness)
    half = size * np.sin(alpha)
    sweep = {
        "centroid_height_m": size * np.cos(alpha),
        "corner_left_m": half,
        "corner_right_m": half,
        # A homogeneous rectangle about its centroid: m (w² + h²)/12 = m R²/3, of one kilogramme.
        "inertia_kg_m2": size**2 / 3.0,
    }
    form = None if spectrum.restitution == "momentum" else Form(restitution=spectrum.restitution)
    scatter = np.sqrt(np.log1p(spectrum.strength_cov**2))
    factors = np.exp(scatter * np.random.default_rng(spectrum.seed).standard_normal(spectrum.draws))
    block, peaks, open_ends = Block.rectangle(width_m=1.0, height_m=2.0), [], 0
    cases = list(itertools.product(excitations, factors.tolist()))
    for number, (excitation, factor) in enumerate(cases):
        on_progress(number, len(cases))
        answers = ensemble(
            block,
            excitation,
            sweep={**sweep, "scale": np.full_like(size, factor)},
            threads=threads,
            duration_s=excitation.end_s + RING_DOWN_S,
            form=form,
        )
        peaks.append(np.where(answers.overturned, np.inf, answers.peak_theta_rad / alpha).astype(np.float32))
        open_ends += int(np.sum(~answers.overturned & (answers.outcomes != Outcome.STANDS)))
    on_progress(len(cases), len(cases))
    every = np.stack(peaks)
    # Of an even number of cases the lower of the two middle ones: a mean with an overturning one would be none.
    median, high = np.quantile(every, (0.5, HIGH), axis=0, method="inverted_cdf").astype(np.float64)
    return Spectrum(np.isinf(every).mean(axis=0), median, high, open_ends / every.size, len(cases))


def run_file(
    path: Path,
    folder: Path,
    pool: Pool,
    on_progress: OnProgress,
    *,
    resume: bool = False,
    say: Say = lambda finding: "",
) -> RockingSpectrumRecord:
    """The spectrum of a file: its record, with the sentences of `say`, and its map (CSV) into `folder`.

    It is one sweep for each motion, in this process, by as many threads as the pool has workers.
    """
    begin = time.process_time()
    spectrum = read_model(SpectrumFile, path)
    excitations = motions_of(spectrum, path)
    answer = compute(spectrum, excitations, threads=pool.workers, on_progress=on_progress)
    # Of a record of a minute the peak velocity is met within 1e-6 of it.
    pgv_m_s = [float(np.abs(each.velocity_m_s(np.linspace(0.0, each.end_s, 200_001))).max()) for each in excitations]
    motions = [
        SpectrumMotion(Path(source.file).name, each.peak_m_s2 / STANDARD_GRAVITY_M_S2, peak_m_s, each.end_s)
        for source, each, peak_m_s in zip(spectrum.motion, excitations, pgv_m_s, strict=True)
    ]
    record = RockingSpectrumRecord(
        title=spectrum.title,
        file=path.name,
        restitution=spectrum.restitution,
        motions=motions,
        strength_cov=spectrum.strength_cov,
        draws=spectrum.draws,
        seed=spectrum.seed,
        cases=answer.cases,
        size_m=spectrum.size_m.values().tolist(),
        slenderness=spectrum.slenderness.values().tolist(),
        probability_overturned=answer.probability.tolist(),
        peak_median=_plain(answer.median),
        peak_high=_plain(answer.high),
        undecided=answer.undecided,
        summary=SpectrumSummary(answer.cases * answer.probability.size, time.process_time() - begin),
        versions=versions(),
        machine=machine(),
    )
    record = replace(record, answer=answer_of(record))
    return write_whole(folder, record.texted(say), lambda fresh: _write_map(record, fresh / MAP_NAME))


def answer_of(record: RockingSpectrumRecord) -> Answer:
    """Which share of the blocks falls in half of the cases, and up to which size those of a slenderness do."""
    falls = np.array(record.probability_overturned) >= 0.5
    found = [info("spectrum_falls", share=float(falls.mean()), cases=record.cases)]
    for k in (0, len(record.slenderness) // 2, len(record.slenderness) - 1):
        sizes = np.flatnonzero(falls[:, k])
        up_to = "none" if not sizes.size else "all" if sizes[-1] == len(record.size_m) - 1 else "some"
        largest_m = record.size_m[sizes[-1]] if sizes.size else None
        found.append(info("spectrum_size", slenderness=record.slenderness[k], up_to=up_to, largest_m=largest_m))
    return Answer("blocks", [*found, info("spectrum_done", **vars(record.summary))])


def _plain(peaks: Array) -> list[list[float | None]]:
    """Peaks rounded to what is known of them; None where the block overturns."""
    return [[float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None for value in line] for line in peaks]


def _write_map(record: RockingSpectrumRecord, path: Path) -> None:
    """A row for each block: probability with Wilson's interval at 95 %, peaks over α (empty where they overturn)."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream)
        rows.writerow(COLUMNS)
        for i, size in enumerate(record.size_m):
            for j, slenderness in enumerate(record.slenderness):
                p = record.probability_overturned[i][j]
                share = wilson(round(p * record.cases), record.cases)
                bounds = (share.low, share.high) if share else (0.0, 1.0)
                rows.writerow([size, slenderness, p, *bounds, record.peak_median[i][j], record.peak_high[i][j]])
