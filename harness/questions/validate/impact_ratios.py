"""Measured ratios of angular velocities over the first impact of free-rocking blocks, beside the model's and an imposed one.

One line a trial: `group` (trials of one block), `trial`, `width_m, height_m, depth_m, mass_kg`, `ratio_measured`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from analytic.closed_form import rectangle_ratio
from harness.model import Answer, Array, Mistake, caution, info, refuse
from harness.questions.validate.measured_set import MeasuredSet, Rows, read_groups
from harness.records.validation import MeasuredRecord, MeasuredTable

COLUMNS: Final = ("group", "trial", "width_m", "height_m", "depth_m", "mass_kg", "ratio_measured")
ROWS: Final = (
    "group", "slenderness", "trials", "measured_mean", "measured_sd", "housner", "housner_less_measured", "its_error",
    "imposed_less_measured",
)  # fmt: skip
SUMS: Final = ("law", "bias", "rms", "rms_over_scatter", "trials", "scatter_of_repeats")


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
    for name, table in read_groups(path, COLUMNS):
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
        tables=[MeasuredTable("laws", SUMS, sums), MeasuredTable("groups", ROWS, rows)],
        findings=found,
    )
