"""Overturning maps: each model's outcomes as colours, and the boundaries of all models on one picture."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.records.study import CaseRun
from harness.studies.case_selection import SAME_CELL, Answer, Place, filled
from reports.charts import Json
from reports.charts.figure import curve, figure, stroke
from reports.charts.palette import model_looks
from reports.charts.static_svg import cell_edges
from reports.messages.numbers import heading
from reports.text.study_rows import SYMBOLS, Condition, family

FAMILIES: Final = ("none", "stands", "other", "wall", "overturns", "failed")
COLOURS: Final = ("#ffffff", "#bfe0ee", "#b9bec6", "#E69F00", "#c8562d", "#000000")
PALE: Final = {"stands": "#e3f2f8", "other": "#e3e5e9", "wall": "#f8e1b8", "overturns": "#edc3b3", "failed": "#808080"}
"""Places that were not computed, since all around them agree."""
CODES: Final = (*FAMILIES, *(f"around {name}" for name in PALE))
LEAST: Final = 3
"""Fewer values than this along an axis make no map: the table shows them better."""


@dataclass(frozen=True)
class Grid:
    """One model's outcomes on a map: codes (rows of y, columns of x) of `CODES`, and what is told of each place."""

    model: str
    codes: NDArray[np.int64]
    tips: list[list[str]]

    @property
    def falls(self) -> NDArray[np.bool_]:
        """Where the statue overturns, as computed or as all around agree."""
        falling: NDArray[np.bool_] = np.isin(self.codes, [CODES.index("overturns"), CODES.index("around overturns")])
        return falling


def numeric(conditions: Sequence[Condition], key: str) -> set[float]:
    """The values that a key takes, none where one of them is not a number."""
    values = {item.varied[key] for item in conditions}
    numbers = {value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool)}
    return numbers if len(numbers) == len(values) else set()


def map_axes(conditions: Sequence[Condition], keys: Sequence[str]) -> tuple[str, str] | None:
    """The two numeric keys with most values, when both have enough of them to make a map (an amplitude is drawn upwards)."""
    sizes = [
        item
        for item in sorted(((len(numeric(conditions, key)), key) for key in keys), reverse=True)
        if item[0] >= LEAST
    ]
    if len(sizes) < 2:
        return None
    first, second = sizes[0][1], sizes[1][1]
    return (second, first) if "amplitude" in first else (first, second)


def map_figures(models: Sequence[str], conditions: Sequence[Condition], keys: Sequence[str]) -> list[tuple[str, Json]]:
    """For each combination of the remaining `keys`: all models' boundaries, then one map per model; empty when it is no map."""
    axes = map_axes(conditions, keys)
    if axes is None:
        return []
    rest = [key for key in keys if key not in axes]
    groups: dict[tuple[Any, ...], list[Condition]] = {}
    for item in conditions:
        groups.setdefault(tuple(item.varied[key] for key in rest), []).append(item)
    figures = []
    for values, members in groups.items():
        where = [f"{heading(key)} {value}" for key, value in zip(rest, values, strict=True)]
        xs, ys = (sorted({item.number(key) for item in members}) for key in axes)
        grids = [grid for model in models for grid in [_grid(model, members, axes, xs, ys)] if grid is not None]
        if len(grids) > 1:
            title = "Where the statue overturns: the boundary of each model"
            figures.append((" · ".join([title, *where]), _boundaries(grids, axes, xs, ys)))
        figures += [(" · ".join([grid.model, *where]), _map(grid, axes, xs, ys)) for grid in grids]
    return figures


def _grid(
    model: str, members: Sequence[Condition], axes: tuple[str, str], xs: Sequence[float], ys: Sequence[float]
) -> Grid | None:
    """Outcomes by place; where a place holds several random samples, the most frequent one and its share in words."""
    rows, columns = ({value: k for k, value in enumerate(values)} for values in (ys, xs))
    samples: dict[Place, list[CaseRun]] = {}
    agreed: list[Place] = []
    for item in members:
        place: Place = (rows[item.number(axes[1])], columns[item.number(axes[0])])
        if (run := item.run(model)) is not None:
            samples.setdefault(place, []).append(run)
        elif model in item.answers and item.answers[model].reason == SAME_CELL:
            agreed.append(place)
    if not samples:
        return None
    codes = np.zeros((len(ys), len(xs)), dtype=np.int64)
    tips = [["not asked"] * len(xs) for _ in ys]
    known: dict[Place, Answer] = {}
    for place, runs in samples.items():
        most, count = Counter(run.outcome for run in runs).most_common(1)[0]
        known[place] = Answer(family(most), 0.0)
        codes[place] = CODES.index(family(most))
        words = SYMBOLS.get(most, ("", most))[1]
        peak = max(float(run.peak_theta_rad) for run in runs)
        tip = f"{words}, |θ| ≤ {peak:.3f} rad" if len(runs) == 1 else f"{words} in {count} of {len(runs)}"
        tips[place[0]][place[1]] = tip
    outcomes = filled([*samples, *agreed], known, (0, 1))
    for place in agreed:
        if place in outcomes:
            codes[place] = CODES.index(f"around {outcomes[place]}")
            tips[place[0]][place[1]] = f"not computed: {outcomes[place]} at the points around"
    return Grid(model, codes, tips)


def _map(grid: Grid, axes: tuple[str, str], xs: Sequence[float], ys: Sequence[float]) -> Json:
    steps, colours = len(CODES), (*COLOURS, *PALE.values())
    scale = [[(k + side) / steps, colours[k]] for k in range(steps) for side in (0, 1)]
    trace = {
        "type": "heatmap", "x": xs, "y": ys, "z": grid.codes.tolist(), "zmin": -0.5, "zmax": steps - 0.5, "text": grid.tips,
        "colorscale": scale, "showscale": False, "xgap": 0.5, "ygap": 0.5,
        "hovertemplate": f"{heading(axes[0])} %{{x:.4g}}<br>{heading(axes[1])} %{{y:.4g}}<br>%{{text}}<extra></extra>",
    }  # fmt: skip
    return figure(
        [trace], 380, map_axis(heading(axes[0]), xs), map_axis(heading(axes[1]), ys), showlegend=False, margin_top=12
    )


def _boundaries(grids: Sequence[Grid], axes: tuple[str, str], xs: Sequence[float], ys: Sequence[float]) -> Json:
    """Lines between the places where the statue overturns and those where it does not, one colour a model."""
    looks = model_looks([grid.model for grid in grids])
    data = [border(grid.falls, xs, ys, stroke(looks[grid.model], 0.6), grid.model) for grid in grids]
    return figure(data, 380, *(map_axis(heading(key), values) for key, values in zip(axes, (xs, ys), strict=True)))


def border(falls: NDArray[np.bool_], xs: Sequence[float], ys: Sequence[float], line: Json, name: str) -> Json:
    """The line between the places (rows of y) where the statue overturns and those where it does not."""
    across, along = _edges(xs), _edges(ys)
    points: list[tuple[float | None, float | None]] = []
    for i, j in np.argwhere(np.diff(falls, axis=1)):
        points += [(across[j + 1], along[i]), (across[j + 1], along[i + 1]), (None, None)]
    for i, j in np.argwhere(np.diff(falls, axis=0)):
        points += [(across[j], along[i + 1]), (across[j + 1], along[i + 1]), (None, None)]
    return curve([x for x, _ in points], [y for _, y in points], line, name=name, hoverinfo="skip")


def map_axis(title: str, values: Sequence[float]) -> Json:
    """The axis of a map, as long as its cells."""
    return _map_axis(title, values) | {"range": _range(_edges(values), values)}


def _edges(values: Sequence[float]) -> list[float]:
    """Bounds of the cells around values, on the scale on which they are drawn."""
    array = np.asarray(values, dtype=np.float64)
    return np.exp(cell_edges(np.log(array))).tolist() if _axis_kind(values) == "log" else cell_edges(array)


def _range(edges: Sequence[float], values: Sequence[float]) -> list[float]:
    ends = [edges[0], edges[-1]]
    return [float(np.log10(value)) for value in ends] if _axis_kind(values) == "log" else ends


def _map_axis(title: str, values: Sequence[float]) -> Json:
    axis: Json = {"title": {"text": title}, "type": _axis_kind(values)}
    if axis["type"] == "log":
        shown = values[:: max(1, len(values) // 6)]
        axis |= {"tickvals": list(shown), "ticktext": [f"{value:.3g}" for value in shown]}
    return axis


def _axis_kind(values: Sequence[float]) -> str:
    """Logarithmic where the values' ratios are more even than their differences."""
    array = np.asarray(values, dtype=np.float64)
    if array.min() <= 0.0 or len(array) < 3:
        return "linear"
    ratios, steps = np.diff(np.log(array)), np.diff(array)
    return "log" if np.ptp(ratios) / ratios.mean() < np.ptp(steps) / steps.mean() else "linear"
