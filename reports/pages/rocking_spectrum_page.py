"""The page of a rocking spectrum: which blocks fall, and how far the others rock, by size and slenderness."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from harness.comparison.statistics.distributions import wilson
from harness.probability.stratified import LEVEL
from harness.records.rocking_spectrum import RockingSpectrumRecord
from reports.charts.figure import figure
from reports.text.chance import SAFE, SAFE_HIGH
from reports.text.wording import Verdict

MOST_CELLS: Final = 80
"""Sizes and slendernesses that a picture shows at most: a page grows with their product."""
Map = Sequence[Sequence[float | None]]


def context(_folder: Path, record: RockingSpectrumRecord) -> dict[str, object]:
    """Everything that the template shows."""
    return {
        "verdict": verdict(record),
        "falls": _map(record, record.probability_overturned, "P", 1.0),
        "peaks": _map(record, record.peak_median, "peak/α", 1.0),
    }


def verdict(record: RockingSpectrumRecord) -> Verdict:
    """The record's answer; green where no block falls often."""
    first, *points = [each.text for each in record.answer.findings] if record.answer else [""]
    cells = [p for line in record.probability_overturned for p in line]
    # The block that falls most often decides, with the interval that so many cases leave open.
    most = wilson(round(max(cells) * record.cases), record.cases, LEVEL)
    safe = most is not None and most.value <= SAFE and most.high < SAFE_HIGH and not record.undecided
    return Verdict(first, "agree" if safe else "differ", points)


def _map(record: RockingSpectrumRecord, values: Map, name: str, most: float) -> dict[str, object]:
    """A map of at most `MOST_CELLS` a side; white where half of the cases overturn and there is no median."""
    rows, columns = (_picked(len(axis)) for axis in (record.size_m, record.slenderness))
    trace = {
        "type": "heatmap", "x": [record.slenderness[j] for j in columns], "y": [record.size_m[i] for i in rows],
        "z": [[values[i][j] for j in columns] for i in rows], "zmin": 0.0, "zmax": most, "colorscale": "Cividis",
        "reversescale": True, "colorbar": {"title": {"text": name}, "thickness": 12},
        "hovertemplate": f"h/b %{{x:.3g}}<br>R %{{y:.3g}} m<br>{name} %{{z:.3g}}<extra></extra>",
    }  # fmt: skip
    titles = "slenderness h/b", "size R  [m]"
    return figure([trace], 420, *({"title": {"text": title}} for title in titles), showlegend=False, margin_top=12)


def _picked(count: int) -> list[int]:
    """Even places along an axis, its ends among them."""
    size = min(count, MOST_CELLS)
    return [round(k * (count - 1) / (size - 1)) for k in range(size)]
