"""Overturning maps: each model's outcomes as colours, and the boundaries of all models on one picture."""

from __future__ import annotations

import json
import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.questions.study.case_selection import SAME_CELL, Place, filled
from harness.questions.trust.point import MODEL
from harness.records.bench import Cell
from harness.records.study import CaseRun
from harness.records.trust import CLASSES, TrustCell, TrustMap
from reports.charts import Json
from reports.charts.figure import (
    CELL,
    INK,
    SURFACES,
    ZOOMED,
    Look,
    across,
    axis,
    cell_edges,
    cells,
    choice,
    chosen,
    figure,
    kinds,
    look,
    marks,
    model_looks,
    named,
    names,
    upwards,
)
from reports.messages import ENGLISH, Language
from reports.text.wording import Condition, family, symbol

FAMILIES: Final = ("none", "stands", "other", "wall", "overturns", "failed")
COLOURS: Final = ("#ffffff", "#bfe0ee", "#b9bec6", "#E69F00", "#c8562d", "#000000")
PALE: Final = {"stands": "#e3f2f8", "other": "#e3e5e9", "wall": "#f8e1b8", "overturns": "#edc3b3", "failed": "#808080"}
"""Places that were not computed, since all around them agree."""
CODES: Final = (*FAMILIES, *(f"around {name}" for name in PALE))
SHADES: Final = 24
"""Steps of colour over a map of numbers."""
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


def map_figures(
    models: Sequence[str], conditions: Sequence[Condition], keys: Sequence[str], say: Language = ENGLISH
) -> list[tuple[str, Json]]:
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
        where = [f"{say.heading(key)} {value}" for key, value in zip(rest, values, strict=True)]
        xs, ys = (sorted({item.number(key) for item in members}) for key in axes)
        grids = [grid for model in models for grid in [_grid(model, members, axes, xs, ys, say)] if grid is not None]
        if len(grids) > 1:
            figures.append((" · ".join([say("chart.boundaries"), *where]), _boundaries(grids, axes, xs, ys, say)))
        figures += [(" · ".join([grid.model, *where]), _map(grid, axes, xs, ys, say)) for grid in grids]
    return figures


def _grid(
    model: str,
    members: Sequence[Condition],
    axes: tuple[str, str],
    xs: Sequence[float],
    ys: Sequence[float],
    say: Language,
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
    tips = [[say("text.not_sent")] * len(xs) for _ in ys]
    known: dict[Place, str] = {}
    for place, runs in samples.items():
        most, count = Counter(run.outcome for run in runs).most_common(1)[0]
        known[place] = family(most)
        codes[place] = CODES.index(family(most))
        words, peak = symbol(most, say)[1], max(float(run.peak_theta_rad) for run in runs)
        key = "chart.peak" if len(runs) == 1 else "chart.in_some"
        tips[place[0]][place[1]] = say(key, what=words, peak=f"{peak:.3f}", count=count, total=len(runs))
    outcomes = filled([*samples, *agreed], known, (0, 1))
    for place in agreed:
        if place in outcomes:
            codes[place] = CODES.index(f"around {outcomes[place]}")
            tips[place[0]][place[1]] = _said(CODES[codes[place]], say)
    return Grid(model, codes, tips)


def _map(grid: Grid, axes: tuple[str, str], xs: Sequence[float], ys: Sequence[float], say: Language) -> Json:
    met = {CODES[code] for row in grid.codes.tolist() for code in row}
    shades = dict(
        zip(CODES, zip((_said(code, say) for code in CODES), (*COLOURS, *PALE.values()), strict=True), strict=True)
    )
    colours = dict(shades[code] for code in CODES if code in met)
    words = [[shades[CODES[code]][0] for code in row] for row in grid.codes.tolist()]
    titles = [say.heading(key) for key in axes]
    return map_of(words, xs, ys, titles, grid.tips, kinds(colours))


def _said(code: str, say: Language) -> str:
    """What a map's key says of a code."""
    name = code.removeprefix("around ")
    words = say(f"text.map_{'not_sent' if name == 'none' else name}")
    return say("text.map_around", what=words) if code.startswith("around ") else words


def map_of(
    kinds_of: Sequence[Sequence[Any]],
    xs: Sequence[float],
    ys: Sequence[float],
    titles: Sequence[str],
    tips: Sequence[Sequence[str]],
    colour: Json,
    height: float = 380,
    over: Mapping[str, tuple[Sequence[Json], Json]] | None = None,
) -> Json:
    """A map with the kind of each place (rows of y) in its encoding's colours; `over` it layers with their data, by name."""
    more = over or {}
    places = [(x, y, tip) for y, row in zip(ys, tips, strict=True) for x, tip in zip(xs, row, strict=True)]
    told = dict(zip(("x", "y", "tip"), map(list, zip(*places, strict=True)), strict=True))
    data = {"cells": [cells(_edges(xs), _edges(ys), kinds_of)], "tips": [told]} | {
        name: parts for name, (parts, _) in more.items()
    }
    # A rim of the same colour, so that no ground shows between cells.
    layers = [marks("rect", "cells", CELL | {"fill": colour, "stroke": colour}, strokeWidth=0.8)]
    x, y = map_axis("x", titles[0], xs), map_axis("y", titles[1], ys)
    return figure([*layers, *(layer for _, layer in more.values())], height, data, x, y)


def number_map(
    values: NDArray[np.float64],
    xs: Sequence[float],
    ys: Sequence[float],
    titles: Sequence[str],
    unit: str,
    ends: tuple[float, float] | None = None,
    over: Mapping[str, tuple[Sequence[Json], Json]] | None = None,
) -> Json:
    """A map of numbers (rows of y), the darker the larger; white where there is none."""
    low, high = ends or (float(np.nanmin(values)), float(np.nanmax(values)))
    step = (high - low) / SHADES or 1.0
    shades = [
        [None if np.isnan(value) else low + step * (min((value - low) // step, SHADES - 1) + 0.5) for value in row]
        for row in values
    ]
    tips = [
        [
            f"{titles[0]} {x:.4g}\n{titles[1]} {y:.4g}\n" + ("–" if np.isnan(value) else f"{value:.4g} {unit}")
            for x, value in zip(xs, row, strict=True)
        ]
        for y, row in zip(ys, values.tolist(), strict=True)
    ]
    scale = {"scheme": "cividis", "reverse": True, "domain": [low, high]}
    key = {
        "title": unit,
        "orient": "top",
        "gradientLength": 160,
        "gradientThickness": 10,
        "titleOrient": "left",
        "tickCount": 4,
    }
    colour = {"field": "kind", "type": "quantitative", "scale": scale, "legend": key}
    return map_of(shades, xs, ys, titles, tips, colour, over=over)


def _boundaries(
    grids: Sequence[Grid], axes: tuple[str, str], xs: Sequence[float], ys: Sequence[float], say: Language
) -> Json:
    """Lines between the places where the statue overturns and those where it does not, one colour a model."""
    looks = {
        model: replace(look, width=look.width + 0.6)
        for model, look in model_looks([grid.model for grid in grids]).items()
    }
    data = {"borders": [border(grid.falls, xs, ys, grid.model) for grid in grids]}
    x, y = (
        map_axis(letter, say.heading(key), values) for letter, key, values in zip("xy", axes, (xs, ys), strict=True)
    )
    return figure(chosen([marks("rule", "borders", CELL | named(looks))]), 380, data, x, y)


def border(falls: NDArray[np.bool_], xs: Sequence[float], ys: Sequence[float], name: str) -> Json:
    """The lines between the places (rows of y) where the statue overturns and those where it does not."""
    across, along = _edges(xs), _edges(ys)
    lines = [(across[j + 1], across[j + 1], along[i], along[i + 1]) for i, j in np.argwhere(np.diff(falls, axis=1))]
    lines += [(across[j], across[j + 1], along[i + 1], along[i + 1]) for i, j in np.argwhere(np.diff(falls, axis=0))]
    columns = map(list, zip(*lines, strict=True)) if lines else [[]] * 4
    return {"name": name, **dict(zip(("x", "x2", "y", "y2"), columns, strict=True))}


def map_axis(letter: str, title: str, values: Sequence[float]) -> Json:
    """The axis of a map, as long as its cells."""
    edges, kind = _edges(values), _axis_kind(values)
    ticks = {"values": list(values[:: max(1, len(values) // 6)]), "format": ".3~g"} if kind == "log" else {}
    scale = {"type": kind, "domain": [edges[0], edges[-1]], "nice": False}
    return axis(letter, title, letter.upper(), scale, **ticks, grid=False, ticks=True)


def _edges(values: Sequence[float]) -> list[float]:
    """Bounds of the cells around values, on the scale on which they are drawn."""
    array = np.asarray(values, dtype=np.float64)
    return np.exp(cell_edges(np.log(array))).tolist() if _axis_kind(values) == "log" else cell_edges(array)


def _axis_kind(values: Sequence[float]) -> str:
    """Logarithmic where the values' ratios are more even than their differences."""
    array = np.asarray(values, dtype=np.float64)
    if array.min() <= 0.0 or len(array) < 3:
        return "linear"
    ratios, steps = np.diff(np.log(array)), np.diff(array)
    return "log" if np.ptp(ratios) / ratios.mean() < np.ptp(steps) / steps.mean() else "linear"


# The maps that one page each shows: of trust, of stability, of blocks.


POINT: Final = "point"
"""The chart in which a point of a map that is clicked opens, and what it is chosen by."""
CLASS_COLOURS: Final = dict(zip(CLASSES, SURFACES, strict=True))
"""Told apart by every form of colour vision: blue where the model is confirmed, the darker the more."""


LINES: Final = {
    "border": Look(INK, "", 2.4),
    "floor": Look(INK, "5 4", 2.4),
    "probability_5": Look("#8c1d2f", "2 3", 1.8),
    "probability_50": Look("#8c1d2f", "", 1.8),
    "probability_95": Look("#8c1d2f", "8 3", 1.8),
    "peak_quarter": Look(INK, "1 3", 1.2),
    "peak_half": Look(INK, "7 3 1 3", 1.2),
    "horizon": Look("#0b6e4f", "6 2 1 2", 1.8),
}
"""The lines on a trust map, all of the analytic model: where its statue falls, and `CONTOURS`."""


def trust_map(record: TrustMap, floor: TrustMap | None = None, command: str = "", say: Language = ENGLISH) -> Json:
    """Strength upwards, frequency across (of a scene's own motion one column): each point in its class's colour, with contours.

    `floor` is the map without the pedestal, of which it shows where the statue falls; `command` runs the scene: a point that is
    clicked says what runs it there.
    """
    frequencies = list(dict.fromkeys(cell["frequency_hz"] for cell in record.cells))
    strengths = list(dict.fromkeys(cell["amplitude_g"] for cell in record.cells))
    rows = [record.cells[j :: len(strengths)] for j in range(len(strengths))]
    own = frequencies == [None]
    along = [0.0] if own else [each for each in frequencies if each is not None]
    colours = {say.word(kind): CLASS_COLOURS[kind] for kind in CLASSES if record.shares.get(kind)}
    classes = [[say.word(cell["class"]) for cell in row] for row in rows]
    falls = {"border": record} if floor is None or floor is record else {"border": record, "floor": floor}
    edges = [border(_falls(each), along, strengths, say.word(f"line_{name}")) for name, each in falls.items()]
    drawn = {name for name, line in record.contours.items() if any(at is not None for at in line)} | falls.keys()
    looks = named({say.word(f"line_{name}"): look for name, look in LINES.items() if name in drawn})
    contours = [
        {"name": say.word(f"line_{name}"), **dict(zip("xy", map(list, zip(*known, strict=True)), strict=True))}
        for name in LINES
        if (known := [(x, y) for x, y in zip(along, record.contours.get(name, []), strict=False) if y is not None])
    ]
    titles = "" if own else say("chart.frequency"), say("chart.strength")
    tips = [[tip(cell, say) for cell in row] for row in rows]
    first, second = chosen([marks("rule", "border", CELL | looks), marks("tick" if own else "line", "contours", looks)])
    over = {"border": (edges, first), "contours": (contours, second)}
    spec = map_of(classes, along, strengths, titles, tips, kinds(colours), 460, over)
    if command:
        points = [cell for row in rows for cell in row]
        spec["datasets"]["tips"][0] |= {
            "more": [shlex.join([*shlex.split(command), *sets(cell)]) for cell in points],
            "point": [place(record, cell, say) for cell in points],
        }
        spec["usermeta"] = {**spec.get("usermeta", {}), "opens": POINT}
    if own:
        spec["encoding"]["x"]["axis"] = {
            "values": [0.0],
            "labelExpr": json.dumps(say("chart.own_motion")),
            "grid": False,
        }
    return spec


def _falls(record: TrustMap) -> NDArray[np.bool_]:
    """Where the statue falls by the analytic model: rows of strengths, columns of frequencies."""
    count = len(dict.fromkeys(cell["amplitude_g"] for cell in record.cells))
    fell = [cell["outcomes"].get(MODEL) == "overturned" for cell in record.cells]
    return np.array(fell).reshape(-1, count).T


def place(record: TrustMap, cell: TrustCell, say: Language) -> str:
    """What names a point among those of all maps."""
    frequency = [f"{say.digits(cell['frequency_hz'])} Hz"] if cell["frequency_hz"] else []
    return ", ".join([f"{say.digits(cell['amplitude_g'])} g", *frequency, say(f"chart.on_{record.stands_on}")])


def point_figure(maps: Sequence[TrustMap], say: Language = ENGLISH) -> Json | None:
    """What each model says of one point of the maps, which the reader chooses: rotation over time. None where nothing moved."""
    runs = [
        {
            "point": place(each, cell, say),
            "name": name,
            "t": np.linspace(0.0, run.end_s, len(run.theta_rad)),
            "theta": theta,
        }
        for each in maps
        for cell in each.cells
        for name, run in cell["paths"].items()
        if np.any(theta := np.array(run.theta_rad))
    ]
    if not runs:
        return None
    known, models = ([*dict.fromkeys(str(run[key]) for run in runs)] for key in ("point", "name"))
    # The strongest shaking of the first map stands there until another point is chosen.
    first = [each for each in known if each.endswith(say(f"chart.on_{maps[0].stands_on}"))][-1:]
    lines = {"x": across("t", say("chart.time")), "y": upwards("theta", say("chart.theta"))}
    return {
        "datasets": {"runs": runs}, "data": {"name": "runs"}, "height": 200,
        "params": [*ZOOMED, choice(POINT, say("chart.point"), known, *first)],
        **marks("line", "", lines | named({name: look(name, models) for name in models}, chosen=False)),
    }  # fmt: skip


def sets(cell: TrustCell) -> list[str]:
    """What a cell sets in the scene, as words of a command."""
    return [word for each in cell["set"] for word in ("--set", each)]


def tip(cell: TrustCell, say: Language = ENGLISH) -> str:
    """What a point says under the pointer."""
    words = [f"{say.digits(cell['amplitude_g'])} g"]
    words += [f"{say.digits(cell['frequency_hz'])} Hz"] if cell["frequency_hz"] else []
    lines = [", ".join(words), f"{say.word(cell['class'])}, {say('text.basis_' + cell['basis'])}"]
    lines += [say("chart.why", why=say.listed(map(say.word, cell["why"])))] if cell["why"] else []
    ends = [f"{name}: {say.word(end)}" for name, end in cell["outcomes"].items()]
    lines += [
        *ends,
        *([say("chart.agree_until", time=say.digits(cell["agree_until_s"]))] if cell["agree_until_s"] else []),
    ]
    for name, chance in cell["probability"].items():
        share, low, high = map(say.percent, (chance.value, chance.low, chance.high))
        lines.append(say("chart.probability", name=name, share=share, low=low, high=high))
    return "\n".join(lines)


STABILITY: Final = {"stable": "#bfe0ee", "inaccurate": "#f8e1b8", "drifting": "#E69F00", "diverged": "#c8562d"}
"""What becomes of a hard scene, and its colour."""


def stability_figure(
    settings: Sequence[str], rows: Sequence[tuple[str, Sequence[Cell | None]]], say: Language = ENGLISH
) -> Json:
    """What becomes of hard scenes, by difficulty (rows) and setting."""
    found = [
        (setting, words, say(f"text.{cell.category}"))
        for words, row in rows
        for setting, cell in zip(settings, row, strict=True)
        if cell is not None
    ]
    data = {"cells": [dict(zip(("x", "y", "kind"), map(list, zip(*found, strict=True)), strict=True))]}
    layers = [
        marks(
            "rect",
            "cells",
            {"color": kinds({say(f"text.{name}"): colour for name, colour in STABILITY.items()}, key=False)},
            stroke="#ffffff",
        ),
        marks("text", "cells", {"text": {"field": "kind"}}),
    ]
    x = names("x", settings, labelAngle=0, grid=False)
    return figure(layers, 44 * len(rows), data, x, names("y", [words for words, _ in rows], grid=False))
