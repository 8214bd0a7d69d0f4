"""Overturning maps: each model's outcomes as colours, and the boundaries of all models on one picture."""

import json
import shlex
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.accuracy.horizon import MODEL
from harness.model import grouped
from harness.questions.study.cases import SAME_CELL, Place, filled
from harness.records.bench import StabilityCell
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
    cells,
    choice,
    chosen,
    columns,
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
from reports.text.answers import Answers, Condition
from reports.text.wording import told_family, told_symbol

COLOURS: Final = {
    "none": "#ffffff", "stands": "#bfe0ee", "other": "#b9bec6", "wall": "#E69F00", "overturns": "#c8562d", "failed": "#000000",
    "around stands": "#e3f2f8", "around other": "#e3e5e9", "around wall": "#f8e1b8", "around overturns": "#edc3b3",
    "around failed": "#808080",
}  # fmt: skip
"""Of what becomes of the statue at a place; paler where that was not computed, since all places around it agree."""
SHADES: Final = 24
"""Steps of colour over a map of numbers."""


Side = tuple[str, Sequence[float]]
"""An axis of a map: its title, and its values in their order."""


Grid = tuple[NDArray[np.object_], NDArray[np.object_]]
"""One model's outcomes on a map: names of `COLOURS` (rows of y, columns of x), and what is told of each place."""


def map_figures(
    answers: Answers, say: Language = ENGLISH, title: Callable[[str], str] | None = None
) -> list[tuple[str, Json]]:
    """For each combination of the other axes: all models' boundaries, then one map per model; empty when it is no map.

    `title` names an axis by its key, else its label does.
    """
    axes = answers.plane
    if axes is None:
        return []
    figures = []
    for where, members in answers.apart(axes, say):
        x, y = (((title or say.label)(key), members.numbers(key)) for key in axes)
        found = {model: _grid(model, members.cases, axes, x, y, say) for model in answers.models}
        grids = {model: grid for model, grid in found.items() if grid is not None}
        if len(grids) > 1 and any(np.isin(codes.astype(str), FALLING).any() for codes, _ in grids.values()):
            figures.append((say("chart.boundaries") + where, _boundaries(grids, x, y)))
        figures += [(model + where, _map(*grid, x, y, say)) for model, grid in grids.items()]
    return figures


def _grid(
    model: str, members: Sequence[Condition], axes: tuple[str, str], x: Side, y: Side, say: Language
) -> Grid | None:
    """Outcomes by place; where a place holds several random samples, the most frequent one and its share in words."""
    rows, places = ({value: k for k, value in enumerate(values)} for _, values in (y, x))
    placed: list[Place] = [(rows[item.number(axes[1])], places[item.number(axes[0])]) for item in members]
    answers = [(place, row) for place, item in zip(placed, members, strict=True) if (row := item.answers.get(model))]
    samples = grouped((place, row.run) for place, row in answers if row.run is not None)
    agreed = [place for place, row in answers if row.run is None and row.reason == SAME_CELL]
    if not samples:
        return None
    codes = np.full((len(y[1]), len(x[1])), "none", dtype=object)
    tips = np.full(codes.shape, say("text.not_sent"), dtype=object)
    for place, runs in samples.items():
        ends = Counter((told_family(run), told_symbol(run, say)[1]) for run in runs)
        (codes[place], words), count = ends.most_common(1)[0]
        peak = max(float(run.peak_theta_rad) for run in runs)
        key = "chart.peak" if len(runs) == 1 else "chart.in_some"
        tips[place] = say(key, what=words, peak=say.written(f"{peak:.3f}"), count=count, total=len(runs))
    known = {place: str(codes[place]) for place in samples}
    outcomes = filled([*samples, *agreed], known, (0, 1))
    for place in agreed:
        if place in outcomes:
            codes[place] = f"around {outcomes[place]}"
            tips[place] = _said(codes[place], say)
    return codes, tips


def _map(codes: NDArray[np.object_], tips: NDArray[np.object_], x: Side, y: Side, say: Language) -> Json:
    words = {code: _said(code, say) for code in COLOURS if code in codes}
    colours = {words[code]: COLOURS[code] for code in words}
    return map_of([[words[code] for code in row] for row in codes], x, y, tips, kinds(colours))


def _said(code: str, say: Language) -> str:
    """What a map's key says of a code."""
    name = code.removeprefix("around ")
    words = say(f"text.map_{'not_sent' if name == 'none' else name}")
    return say("text.map_around", what=words) if code.startswith("around ") else words


def map_of(
    kinds_of: Sequence[Sequence[Any]],
    x: Side,
    y: Side,
    tips: Sequence[Sequence[str]] | NDArray[np.object_],
    colour: Json,
    height: float = 380,
    over: Mapping[str, tuple[Sequence[Json], Json]] | None = None,
) -> Json:
    """A map with the kind of each place (rows of y) in its encoding's colours; `over` it layers with their data, by name."""
    more = over or {}
    told = columns("x y tip", [(at, up, tips[i][j]) for i, up in enumerate(y[1]) for j, at in enumerate(x[1])])
    data = {"cells": [cells(edges(x[1]), edges(y[1]), kinds_of)], "tips": [told]}
    data |= {name: list(parts) for name, (parts, _) in more.items()}
    # A rim of the same colour, so that no ground shows between cells.
    layers = [marks("rect", "cells", CELL | {"fill": colour, "stroke": colour}, strokeWidth=0.8)]
    return figure([*layers, *(layer for _, layer in more.values())], height, data, map_axis("x", x), map_axis("y", y))


def number_map(
    values: NDArray[np.float64],
    x: Side,
    y: Side,
    unit: str,
    say: Language,
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
            f"{x[0]} {say.short(at)}\n{y[0]} {say.short(up)}\n"
            + ("–" if np.isnan(value) else f"{say.short(value)} {unit}")
            for at, value in zip(x[1], row, strict=True)
        ]
        for up, row in zip(y[1], values.tolist(), strict=True)
    ]
    scale = {"scheme": "cividis", "reverse": True, "domain": [low, high]}
    key = {
        "title": unit, "orient": "top", "gradientLength": 160, "gradientThickness": 10, "titleOrient": "left", "tickCount": 4,
        "columns": {"expr": "max(1, floor((W - 90) / 62))"},
    }  # fmt: skip
    colour = {"field": "kind", "type": "quantitative", "scale": scale, "legend": key}
    return map_of(shades, x, y, tips, colour, over=over)


FALLING: Final = ("overturns", "around overturns")
"""Codes of the places where the statue overturns."""


def _boundaries(grids: Mapping[str, Grid], x: Side, y: Side) -> Json:
    """Lines between the places where the statue overturns and those where it does not, one colour a model."""
    looks = model_looks(list(grids))
    drawn = named({model: replace(look, width=look.width + 0.6) for model, look in looks.items()})
    borders = [border(np.isin(codes.astype(str), FALLING), x[1], y[1], model) for model, (codes, _) in grids.items()]
    layers = chosen([marks("rule", "borders", CELL | drawn)])
    return figure(layers, 380, {"borders": borders}, map_axis("x", x), map_axis("y", y))


def border(falls: NDArray[np.bool_], xs: Sequence[float], ys: Sequence[float], name: str) -> Json:
    """The lines between the places (rows of y) where the statue overturns and those where it does not."""
    across, along = edges(xs), edges(ys)
    lines = [(across[j + 1], across[j + 1], along[i], along[i + 1]) for i, j in np.argwhere(np.diff(falls, axis=1))]
    lines += [(across[j], across[j + 1], along[i + 1], along[i + 1]) for i, j in np.argwhere(np.diff(falls, axis=0))]
    return {"name": name, **columns("x x2 y y2", lines)}


def map_axis(letter: str, side: Side) -> Json:
    """The axis of a map, as long as its cells."""
    title, values = side
    ends, kind = edges(values), _scale_of(values)
    ticks = {"values": list(values[:: max(1, len(values) // 6)]), "format": ".3~g"} if kind == "log" else {}
    scale = {"type": kind, "domain": [ends[0], ends[-1]], "nice": False}
    return axis(letter, title, letter.upper(), scale, **ticks, grid=False, ticks=True)


def edges(values: Sequence[float]) -> list[float]:
    """Bounds of the cells around values: on their scale halfway to the neighbours; one alone has half a unit to each side."""
    in_logs = _scale_of(values) == "log"
    places = np.log(values) if in_logs else np.asarray(values, dtype=np.float64)
    steps = np.diff(places) if len(places) > 1 else np.ones(1)
    bounds = np.append(places[0] - 0.5 * steps[0], places + 0.5 * np.append(steps, steps[-1])[: len(places)])
    return list(map(float, np.exp(bounds) if in_logs else bounds))


def _scale_of(values: Sequence[float]) -> str:
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
    words = {name: say.word(f"line_{name}") for name in LINES}
    falls = {"border": record} if floor is None or floor is record else {"border": record, "floor": floor}
    borders = [border(_falls(each), along, strengths, words[name]) for name, each in falls.items()]
    contours = {
        name: list(zip(along, found, strict=False))
        for name, found in record.contours.items() if any(y is not None for y in found)
    }  # fmt: skip
    looks = named({words[name]: look for name, look in LINES.items() if name in contours or name in falls})
    # A line ends where its level is not met; of one frequency alone there is but its point.
    drawn, dots = ("tick", {}) if own else ("line", {"point": {"size": 25, "filled": True}})
    first, second = chosen([marks("rule", "border", CELL | looks), marks(drawn, "contours", looks, **dots)])
    lines = [{"name": words[name], **columns("x y", contours[name])} for name in LINES if name in contours]
    spec = map_of(
        [[say.word(cell["class"]) for cell in row] for row in rows],
        ("" if own else say("chart.frequency"), along),
        (say("chart.strength"), strengths),
        [[tip(cell, say) for cell in row] for row in rows],
        kinds({say.word(kind): CLASS_COLOURS[kind] for kind in CLASSES if record.shares.get(kind)}),
        460,
        {"border": (borders, first), "contours": (lines, second)},
    )
    if command:
        points = [cell for row in rows for cell in row]
        spec["datasets"]["tips"][0] |= {
            "more": [shlex.join([*shlex.split(command), *sets(cell)]) for cell in points],
            "point": [place(record, cell, say) for cell in points],
        }
        spec["usermeta"] = {"opens": POINT}
    if own:
        named_below = {"values": [0.0], "labelExpr": json.dumps(say("chart.own_motion")), "grid": False}
        spec["encoding"]["x"]["axis"] = named_below
    return spec


def _falls(record: TrustMap) -> NDArray[np.bool_]:
    """Where the statue falls by the analytic model: rows of strengths, columns of frequencies."""
    count = len(dict.fromkeys(cell["amplitude_g"] for cell in record.cells))
    fell = [cell["outcomes"].get(MODEL) == "overturned" for cell in record.cells]
    return np.array(fell).reshape(-1, count).T


def place(record: TrustMap, cell: TrustCell, say: Language) -> str:
    """What names a point among those of all maps."""
    return f"{shaking(cell, say)}, {say(f'chart.on_{record.stands_on}')}"


def shaking(cell: TrustCell, say: Language) -> str:
    """How strong a point's motion is, and how fast where it has one frequency."""
    frequency = [f"{say.digits(cell['frequency_hz'])} Hz"] if cell["frequency_hz"] else []
    return say.row([f"{say.digits(cell['amplitude_g'])} g", *frequency])


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
    chances = {
        name: dict(zip(("share", "low", "high"), map(say.percent, (each.value, each.low, each.high)), strict=True))
        for name, each in cell["probability"].items()
    }
    lines = [
        shaking(cell, say),
        f"{say.word(cell['class'])}, {say('text.basis_' + cell['basis'])}",
        *([say("chart.why", why=say.listed(map(say.word, cell["why"])))] if cell["why"] else []),
        *(f"{name}: {say.word(end)}" for name, end in cell["outcomes"].items()),
        *([say("chart.agree_until", time=say.digits(cell["agree_until_s"]))] if cell["agree_until_s"] else []),
        *(say("chart.probability", name=name, **shares) for name, shares in chances.items()),
    ]
    return "\n".join(lines)


STABILITY: Final = {
    "stable": ("●", "#bfdef2"), "inaccurate": ("◐", "#f3e96b"), "drifting": ("↗", "#f0b03d"), "diverged": ("✕", "#e0566b"),
}  # fmt: skip
"""What becomes of a hard scene, its sign and its colour."""


def stability_figure(cells: Sequence[StabilityCell], tips: Sequence[str], say: Language = ENGLISH) -> Json:
    """What becomes of hard scenes, by difficulty (rows) and setting; `tips` say more of each cell."""
    words = {name: f"{sign} {say(f'text.{name}')}" for name, (sign, _) in STABILITY.items()}
    found = [
        (
            cell.setting, cell.difficulty, words[cell.category],
            f"{STABILITY[cell.category][0]}{'*' if cell.remedy else ''}{'°' if cell.short else ''}", tip,
        )
        for cell, tip in zip(cells, tips, strict=True)
    ]  # fmt: skip
    settings, difficulties, *_ = (list(dict.fromkeys(column)) for column in zip(*found, strict=True))
    colour = kinds({words[name]: colour for name, (_, colour) in STABILITY.items()})
    layers = [
        marks("rect", "cells", {"color": colour}, stroke="#ffffff"),
        marks("text", "cells", {"text": {"field": "sign"}}),
    ]
    x, y = names("x", settings, labelAngle=0, grid=False), names("y", difficulties, grid=False)
    return figure(layers, 44 * len(difficulties), {"cells": [columns("x y kind sign tip", found)]}, x, y)
