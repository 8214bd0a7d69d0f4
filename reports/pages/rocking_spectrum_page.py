"""The page of a rocking spectrum: which blocks fall, and how far the others rock, by size and slenderness."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from harness.comparison.statistics import wilson
from harness.questions.assess.probability import LEVEL
from harness.records.study import RockingSpectrumRecord
from reports.blocks import Block, Chart, Verdict, command_line, facts, grid, repeat, section, table, words
from reports.blocks import verdict as verdict_of
from reports.charts import Json
from reports.charts.map_figures import number_map
from reports.messages import Language
from reports.text.wording import SAFE, SAFE_HIGH

MOST_CELLS: Final = 80
"""Sizes and slendernesses that a picture shows at most: a page grows with their product."""
Map = Sequence[Sequence[float | None]]


def blocks(_folder: Path, record: RockingSpectrumRecord, say: Language) -> list[Block]:
    """The blocks of a rocking spectrum's page."""
    falls, peaks = (
        _map(record, record.probability_overturned, "P", say),
        _map(record, record.peak_median, say("chart.peak_over_alpha"), say),
    )
    spread = say.percent(record.strength_cov)
    settings = {
        "strengths": say("text.strengths_given") if record.draws == 1 else say(
            "text.strengths", draws=record.draws, spread=spread
        ),
        "restitution": say("text.momentum") if record.restitution == "momentum" else record.restitution,
        "blocks": say(
            "text.blocks", sizes=len(record.size_m), slendernesses=len(record.slenderness), cases=record.cases
        ),
        "still_leaning": say.percent(record.undecided),
    }  # fmt: skip
    charts = [Chart("falls", say("text.spectrum_falls"), falls), Chart("peaks", say("text.spectrum_peaks"), peaks)]
    return [
        verdict(record),
        *section(say, "maps", grid(charts), words(say, "spectrum")),
        *section(say, "motions", table(say, "motions", "name pga_g pgv_m_s duration_s", record.motions)),
        # Records of older versions do not name their file.
        *repeat(
            say, record, *([command_line("study", record.file)] if record.file else []), more=[facts(say, settings)]
        ),
    ]


def verdict(record: RockingSpectrumRecord) -> Verdict:
    """The record's answer; green where no block falls often."""
    cells = [p for line in record.probability_overturned for p in line]
    # The block that falls most often decides, with the interval that so many cases leave open.
    most = wilson(round(max(cells) * record.cases), record.cases, LEVEL)
    safe = most is not None and most.value <= SAFE and most.high < SAFE_HIGH and not record.undecided
    return verdict_of(record, "agree" if safe else "differ")


def _map(record: RockingSpectrumRecord, values: Map, name: str, say: Language) -> Json:
    """A map of at most `MOST_CELLS` a side; white where half of the cases overturn and there is no median."""
    rows, columns = (_picked(len(axis)) for axis in (record.size_m, record.slenderness))
    shown = np.array([[values[i][j] for j in columns] for i in rows], dtype=np.float64)
    x = say("chart.slenderness"), [record.slenderness[j] for j in columns]
    y = say("chart.half_diagonal"), [record.size_m[i] for i in rows]
    return number_map(shown, x, y, name, say, (0.0, 1.0))


def _picked(count: int) -> list[int]:
    """Even places along an axis, its ends among them."""
    size = min(count, MOST_CELLS)
    return [round(k * (count - 1) / (size - 1)) for k in range(size)]
