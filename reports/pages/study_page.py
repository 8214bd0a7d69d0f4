"""The pages of many runs, with their charts (maps, curves, the paper's panels, fragility, roses).

Of a study (verdict, claims, outcome matrix, charts, what was asked and what was not), a rocking spectrum, a trust map.
"""

import json
import shlex
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.accuracy.horizon import MODEL
from harness.comparison.statistics import fit_fragility, wilson
from harness.model import Finding, grouped, info
from harness.questions.assess.probability import LEVEL
from harness.questions.study.cases import SAME_CELL, Place, filled
from harness.questions.trust import CELLS_NAME
from harness.records.run import STILL_RAD, falls, in_domain
from harness.records.scene import SceneRecord
from harness.records.study import CaseRun, ClaimVerdict, Panel, RockingSpectrumRecord, StudyRecord, StudyRow
from harness.records.trust import CLASSES, HELD, Saved, TrustCell, TrustMap, TrustRecord, knows_most
from harness.statics.standstill import STILL_M
from reports.blocks import (
    Block,
    Cell,
    Chart,
    Drawing,
    Facts,
    Group,
    Legend,
    Section,
    Table,
    Text,
    Verdict,
    code,
    command_line,
    facts,
    grid,
    notes,
    repeat,
    section,
    table,
    verdict,
    words,
)
from reports.charts.figure import (
    BETWEEN,
    CELL,
    FLOOR_COLOUR,
    INK,
    PEDESTAL_COLOUR,
    SURFACES,
    ZOOMED,
    Json,
    Look,
    across,
    axis,
    band,
    cells,
    choice,
    chosen,
    columns,
    columns_of,
    estimates,
    figure,
    kinds,
    level,
    look,
    marks,
    model_looks,
    named,
    names,
    points,
    rows_of,
    upwards,
)
from reports.drawing.kinematics import poses, top_shift_m
from reports.drawing.pictures import Picture, RoseCurve, rose_of, scene_svg
from reports.messages import ENGLISH, Language
from reports.source import (
    LEAST,
    SAFE,
    SAFE_HIGH,
    Answers,
    Condition,
    symbol,
    symbols,
    told_family,
    told_symbol,
    tone_of_study,
)

# Overturning maps: each model's outcomes as colours, and the boundaries of all models on one picture.

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
    outcomes = filled([*samples, *agreed], {place: str(codes[place]) for place in samples}, (0, 1))
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


# Maps of numbers: how far the statue rotates and its pedestal slides over what varies, and where the pedestal would tip.

MOST_PLACES: Final = 10_000
"""Larger maps show where the statue falls only: a number for every place would make the page large."""
TIPPING: Final = ("pedestal_tipping_margin_m", "pedestal_tipping_margin_at_impact_m")
"""The margins of the record: the pedestal's half width less the reach of the floor's force, in motion and at impacts."""


MAPPED: Final = {"peak": ("peak_theta_rad", 1.0, "rad", STILL_RAD), "slip": ("peak_slip_m", 1e3, "mm", 1e3 * STILL_M)}
"""What maps show: the value of a run, in how many of which unit, and up to where it is rounding."""


def design_figures(answers: Answers, say: Language = ENGLISH) -> list[tuple[str, Json]]:
    """For each model maps of the largest rotation where it stands, and where it slides of the pedestal's largest displacement.

    Places that would tip the pedestal are marked. Empty when what varies makes no map, or a place stands for several conditions.
    """
    shown = [name for name in MAPPED if name != "peak" or len(answers.cases) <= MOST_PLACES]
    found = [
        (say(f"chart.map_{name}", model=model), _value_map(name, model, answers, answers.single_plane, say))
        for name in shown for model in answers.models if answers.single_plane is not None
    ]  # fmt: skip
    return [(title, drawn) for title, drawn in found if drawn is not None]


def best_designs(answers: Answers) -> list[Finding]:
    """For each model that slides: of the designs in which the statue stands and nothing tips, the least slip, and which has it
    where one has. Shakings are no designs.
    """
    axes = answers.single_plane
    if axes is None or any(key.startswith("motion.") for key in axes):
        return []
    found = []
    for model in answers.models:
        runs = [(run, item) for item, run in answers.runs(model)]
        if not any(run.peak_slip_m > 0.0 for run, _ in runs):
            continue
        good = [(run, item) for run, item in runs if _stands(run) and not _tips(run)]
        if not good:
            found.append(info("no_design_stands", designs=len(runs), model=model))
            continue
        slip_m = min(float(run.peak_slip_m) for run, _ in good)
        best, *others = [item for run, item in good if run.peak_slip_m == slip_m]
        at = {} if others else {key: best.number(key) for key in axes}
        found.append(info("best_design", good=len(good), designs=len(runs), slip_m=slip_m, at=at, model=model))
    return found


def _stands(run: CaseRun) -> bool:
    """Whether the statue stands by what a run tells within its model's domain."""
    return told_family(run) == "stands"


def _tips(run: CaseRun) -> bool:
    margins = [run.validity.get(name) for name in TIPPING]
    return any(isinstance(margin, float) and margin < 0.0 for margin in margins)


def _value_map(name: str, model: str, answers: Answers, axes: tuple[str, str], say: Language) -> Json | None:
    """A map of one of `MAPPED`, of the slips with the places that tip; None where it is nought, or rounding, everywhere."""
    column, factor, unit, least = MAPPED[name]
    x, y = ((say.label(key), answers.numbers(key)) for key in axes)
    there = {tuple(item.number(key) for key in axes): run for item, run in answers.runs(model)}
    told = {place: factor * abs(getattr(run, column)) for place, run in there.items() if name == "slip" or _stands(run)}
    values = np.array([[told.get((at, up), np.nan) for at in x[1]] for up in y[1]])
    if not np.nanmax(values, initial=0.0) > least:
        return None
    crosses = marks("point", "tipping", shape="cross", angle=45, size=36, filled=True, color=INK)
    tipping = [columns("x y", [place for place, run in there.items() if _tips(run)])]
    return number_map(values, x, y, unit, say, over={"tipping": (tipping, crosses)} if name == "slip" else None)


# Studies along one axis: each model's outcome, largest rotation and slip against what varies.

MOST_GROUPS: Final = 6
"""More combinations of what else varies are no curves of one axis: the table shows them."""


def curve_figures(answers: Answers, say: Language = ENGLISH) -> list[tuple[str, Json]]:
    """For each axis of numbers, and each combination of the others, a chart of all models; none where there is a map."""
    numeric = [key for key in answers.axes if answers.plane is None and len(answers.numbers(key)) >= LEAST]
    groups = [(key, answers.apart([key], say)) for key in numeric]
    return [
        (say("text.by", name=say.label(key)) + where, _curves(members, key, say))
        for key, apart in groups if len(apart) <= MOST_GROUPS for where, members in apart
    ]  # fmt: skip


def _curves(answers: Answers, key: str, say: Language) -> Json:
    """Outcome and, where a statue that stands rocks or slides, largest rotation and slip; of one that falls these say nothing."""
    looks = model_looks(answers.models)
    along = {model: sorted(answers.runs(model), key=lambda each: each[0].number(key)) for model in answers.models}
    parts: list[Json] = [
        {
            "name": model, "x": [item.number(key) for item, _ in runs],
            "outcome": [told_symbol(run, say)[1] for _, run in runs],
            "theta": [abs(run.peak_theta_rad) if _stands(run) else None for _, run in runs],
            "slip": [1e3 * run.peak_slip_m if _stands(run) else None for _, run in runs],
        }
        for model, runs in along.items()
    ]  # fmt: skip
    outcomes = list(dict.fromkeys(words for part in parts for words in part["outcome"]))
    rows = [(names("outcome", outcomes[::-1], grid=True), 40 + 26 * len(outcomes))]
    for column, height, least in (("theta", 180, STILL_RAD), ("slip", 140, 1e3 * STILL_M)):
        if any((value or 0.0) > least for part in parts for value in part[column]):
            rows.append((axis(column, say(f"chart.{column}"), scale={"zero": True}), height))
    joined = all(len(set(part["x"])) == len(part["x"]) for part in parts)  # no line through draws of one place
    drawn = [(points("runs", looks, y, k == 0, joined), height) for k, (y, height) in enumerate(rows)]
    return rows_of(drawn, across("x", say.label(key)), {"runs": parts})


# The paper's panels, fragility, roses.

SLIP_COLOUR: Final = "#009E73"
SHOWN_RAD: Final = 0.50
"""The paper's figures show rotations up to this value."""
PANEL_CURVES: Final = (
    ("floor", "theta_rad", 1.0, FLOOR_COLOUR),
    ("pedestal", "theta_rad", 1.0, PEDESTAL_COLOUR),
    ("pedestal", "slip_m", 0.1, SLIP_COLOUR),
)
"""What a panel shows of a condition: setting, curve, factor, colour."""
LEAST_RUNS: Final = 10
"""Runs at one level below which a share says little."""

LEAST_DIRECTIONS: Final = 4
"""Directions in which the statue overturns below which a rose says little."""


def panels_figure(panels: Sequence[Panel], model: str | None = None, say: Language = ENGLISH) -> Json:
    """The paper's figures 7 to 9: amplitudes across, frequencies down, of one model (default: the first).

    It opens on the least restitution; the page's reader chooses another of both.
    """
    shown_as = [(*each, say(f"chart.panel_{each[0]}_{each[1]}")) for each in PANEL_CURVES]
    kinds_of = {name: Look(colour, "", 1.4) for *_, colour, name in shown_as}
    models = list(dict.fromkeys(model for panel in panels for model in panel.curves))
    parts: list[Json] = [
        {
            "name": name, "model": of, "r": panel.restitution, "place": panel_place(panel, say),
            "t": np.asarray(curves[setting].t_s), "value": scale * np.asarray(getattr(curves[setting], column)),
        }
        for panel in panels for of, curves in panel.curves.items()
        for setting, column, scale, _, name in shown_as if setting in curves
    ]  # fmt: skip
    ends = {"domain": [0.0, max((float(part["t"][-1]) for part in parts), default=1.0)]}
    shown = {"domain": [-SHOWN_RAD, SHOWN_RAD]}
    order = [
        panel_place(panel, say) for panel in sorted(panels, key=lambda each: (each.frequency_hz, each.amplitude_g))
    ]
    params = [
        choice("model", say("chart.model"), models, model),
        choice("r", say("chart.restitution"), sorted({panel.restitution for panel in panels})),
    ]
    lines = marks(
        "line",
        "",
        {"x": across("t", say("chart.time"), ends), "y": axis("value", "", scale=shown, tickCount=5)}
        | named(kinds_of, chosen=False),
    )
    return {
        "datasets": {"panels": parts}, "params": [*ZOOMED, *params], "data": {"name": "panels"},
        "columns": len({panel.amplitude_g for panel in panels}),
        "facet": {"field": "place", "sort": list(dict.fromkeys(order)), "header": {"title": None}},
        "spec": lines | {"height": 120}, "spacing": {"row": 14, "column": BETWEEN},
    }  # fmt: skip


def panel_place(panel: Panel, say: Language = ENGLISH) -> str:
    """What is said over a panel."""
    return say.row([f"{say.short(panel.amplitude_g)} g", f"{say.short(panel.frequency_hz)} Hz"])


def fragility_figure(answers: Answers, key: str, say: Language = ENGLISH) -> Json | None:
    """Share of overturned runs against an intensity, with 95 % intervals and the lognormal fit with its band.

    Everything else that varies is pooled; runs without an end are left out. None unless some model has at least three levels of
    ten runs each.
    """
    data: dict[str, list[Json]] = {"points": [], "fits": []}
    for model in answers.models:
        known = [(item, fallen) for item, run in answers.runs(model) if (fallen := falls(run)) is not None]
        levels = grouped((abs(item.number(key)), fallen) for item, fallen in known)
        if sum(len(fell) >= LEAST_RUNS for fell in levels.values()) >= 3:
            shares = [(x, share) for x, fell in sorted(levels.items()) if (share := wilson(sum(fell), len(fell)))]
            estimated = columns_of([share for _, share in shares])
            data["points"].append({"name": model, "x": [x for x, _ in shares], **estimated})
            data["fits"] += _fitted(model, levels)
    if not data["points"]:
        return None
    shown = {part["name"] for part in data["points"]}
    drawn = named({name: style for name, style in model_looks(answers.models).items() if name in shown})
    layers = chosen([band("fits", drawn, 0.12), marks("line", "fits", drawn), *estimates("points", drawn)])
    y = upwards("y", say("chart.share_overturns"), {"domain": [0.0, 1.0]})
    return figure(layers, 420, data, across("x", say.label(key)), y)


def _fitted(model: str, levels: Mapping[float, Sequence[bool]]) -> list[Json]:
    """The fitted curve of one model with its band; none where nothing can be fitted."""
    shaken = {x: fell for x, fell in levels.items() if x > 0.0}
    intensity = [x for x, fell in shaken.items() for _ in fell]
    curve_fit = fit_fragility(intensity, [fell for runs in shaken.values() for fell in runs])
    if curve_fit.median is None:
        return []
    xs = np.linspace(min(intensity), max(intensity), 120)
    low, high = curve_fit.band(xs)
    return [{"name": model, "x": xs, "y": curve_fit.probability(xs), "low": low, "high": high}]


def rose_picture(answers: Answers, say: Language = ENGLISH) -> Picture | None:
    """Least amplitude that overturns the statue, by direction of shaking; None without azimuths and amplitudes."""
    turn = next((key for key in answers.keys if key.endswith("azimuth_deg")), None)
    size = next((key for key in answers.keys if "amplitude" in key or key.endswith("scale")), None)
    if turn is None or size is None:
        return None
    drawn: list[RoseCurve] = []
    for model, style in model_looks(answers.models).items():
        by_angle = grouped((item.number(turn), (run, abs(item.number(size)))) for item, run in answers.runs(model))
        fell = {angle: [most for run, most in by_angle[angle] if run.outcome.overturned] for angle in sorted(by_angle)}
        if sum(map(bool, fell.values())) >= LEAST_DIRECTIONS:
            drawn.append(RoseCurve(model, {angle: min(sizes, default=None) for angle, sizes in fell.items()}, style))
    if not drawn:
        return None
    most = max(abs(item.number(size)) for item in answers.cases)
    return rose_of(drawn, most, " g" if size.endswith("_g") else "", say=say)


# What the pedestal changes over a study: how often it prevents a fall, and how far the top moves with and without it.

WALL_COLOUR: Final = "#8c1d2f"


def pedestal_effect(
    record: StudyRecord,
    answers: Answers,
    say: Language = ENGLISH,
    words: str = "chart",
) -> tuple[Finding, list[Chart]] | None:
    """What the pedestal saves in a study with and without it, by the model that tells it of most conditions; None for other
    studies.

    Where the study varies a frequency, charts of the share of falls (`saved`) and of the reach (`moved`). `words` is the table of
    the catalogue that names what the charts show.
    """
    # "keep" is no number.
    pace = next((key for key in answers.keys if key.endswith("frequency_hz") and answers.numbers(key)), None)
    if "pedestal" not in answers.varying:
        return None
    counted = {name: _saved(answers.runs(name)) for name in answers.models}
    model = knows_most(counted, answers.models[0]) or answers.models[0]
    told = info("pedestal_saves", model=model, **vars(counted[model]))
    if pace is None:
        return told, []
    runs = sorted(answers.runs(model), key=lambda each: each[0].number(pace))
    by_setting = {
        say(f"{words}.on_{setting}"): [
            (item.number(pace), run)
            for item, run in runs
            if (item.varied["pedestal"] == "none") == (setting == "floor")
        ]
        for setting in SETTINGS
    }
    named = {each: say(f"{words}.{each}") for each in ("frequency", "share_falls", "top", "wall")}
    drawn = {
        "saved": _falls_by_setting(by_setting, named, say),
        "moved": _reach_by_setting(by_setting, named, record.scene),
    }
    return told, [Chart(name, say(f"text.pedestal_{name}", model=model), figure) for name, figure in drawn.items()]


def _top_m(scene: SceneRecord, run: CaseRun) -> float:
    """How far the top moves at most while its statue leans and its pedestal slides, m."""
    leans = poses(scene, {"theta_rad": run.peak_theta_rad * np.array([-1.0, 1.0])})
    return float(np.abs(top_shift_m(scene, leans)).max()) + run.peak_slip_m


def _saved(runs: Sequence[tuple[Condition, CaseRun]]) -> Saved:
    """How often the pedestal prevents and causes an overturning under the same condition, where both runs tell it."""
    known = [(item.varied, fallen) for item, run in runs if (fallen := falls(run)) is not None]
    by_rest = grouped(
        (tuple(value for key, value in varied.items() if key != "pedestal"), (varied["pedestal"] == "none", fallen))
        for varied, fallen in known
    )
    pairs = [dict(pair) for pair in by_rest.values()]
    return Saved.of([(pair[True], pair[False]) for pair in pairs if len(pair) == 2])


SETTINGS: Final = {"floor": FLOOR_COLOUR, "pedestal": PEDESTAL_COLOUR}
Runs = Mapping[str, Sequence[tuple[float, CaseRun]]]
"""The runs of a setting, each with its frequency, by the setting's words."""


def _falls_by_setting(by_setting: Runs, named: Mapping[str, str], say: Language) -> Json:
    """The share of falls by setting and frequency: a bar for each."""
    fell = {
        setting: grouped((rate, fallen) for rate, run in runs if (fallen := falls(run)) is not None)
        for setting, runs in by_setting.items()
    }
    parts = [
        {
            "kind": setting, "x": [*map(say.short, ends)], "y": [100.0 * sum(each) / len(each) for each in ends.values()],
            "count": [f"{sum(each)}/{len(each)}" for each in ends.values()],
        }
        for setting, ends in fell.items()
    ]  # fmt: skip
    beside = {"xOffset": {"field": "kind", "sort": list(fell)}}
    bars = marks("bar", "falls", beside | {"color": kinds(dict(zip(fell, SETTINGS.values(), strict=True)))})
    words = marks("text", "falls", beside | {"text": {"field": "count"}}, dy=-7, clip=False)
    rates = sorted({rate for ends in fell.values() for rate in ends})
    x = names("x", [*map(say.short, rates)], named["frequency"], labelAngle=0, grid=False)
    y = upwards("y", named["share_falls"], {"domain": [0, 112]}, values=[*range(0, 101, 20)])
    return figure([bars, words], 340, {"falls": parts}, x, y)


def _reach_by_setting(by_setting: Runs, named: Mapping[str, str], scene: SceneRecord) -> Json:
    """How far the top moves by setting and frequency, and the wall."""
    moved = {
        setting: grouped((rate, _top_m(scene, run)) for rate, run in runs if falls(run) is False)
        for setting, runs in by_setting.items()
    }
    parts = [{"name": setting, "x": [*by], "y": [*map(max, by.values())]} for setting, by in moved.items() if by]
    y, wall = upwards("y", named["top"], {"zero": True}), scene.wall
    lines = [] if wall is None else level(wall.distance_m, named["wall"], line=Look(WALL_COLOUR, "6 4", 1.5))
    looks = {setting: Look(colour) for setting, colour in zip(moved, SETTINGS.values(), strict=True) if moved[setting]}
    return figure(
        [*points("reach", looks, y, first=True), *lines], 340, {"reach": parts}, across("x", named["frequency"]), y
    )


MOST_MATRIX_ROWS: Final = 300
"""Longer matrices are not read; the map shows them."""
JUDGED: Final = {"holds": "✓", "does not hold": "✕", "holds for some": "◐", "not tested": "–"}
"""The sign of each verdict on a claim."""


def study_page(_folder: Path, record: StudyRecord, say: Language) -> list[Block]:
    """The blocks of a study's page."""
    answers = Answers.of(record.rows, record.vary)
    effect, charts, rose = (
        pedestal_effect(record, answers, say),
        study_charts(record, answers, say),
        rose_picture(answers, say),
    )
    drawn: list[Chart | Drawing] = [*charts]
    drawn += [] if rose is None else [Drawing(rose.svg(say("text.study_rose")), [say("text.study_rose")], "chart-box")]
    reasons = [
        f"{count}: {say.word(reason)}" for reason, count in Counter(row.reason for row in record.rows).most_common()
    ]
    vary = [
        (say.value(key, "key"), say.row([say.value(value, "plain") for value in values]))
        for key, values in record.vary.items()
    ]
    scattered = {key: [item.number(key) for item in answers.cases] for key in answers.varying if key not in record.vary}
    vary += [
        (say.value(key, "key"), say.range([say.short(min(values)), say.short(max(values))]))
        for key, values in scattered.items()
    ]
    seconds = Facts([(name, say.value(value, "s")) for name, value in record.engine_seconds.items()])
    picture = Drawing(scene_svg(record.scene, say), [say("text.study_scene", title=record.scene.title)])
    shown = matrix(answers, say) if len(answers.cases) <= MOST_MATRIX_ROWS else None
    return [
        study_verdict(record, answers, say),
        *_claims(record, say),
        *(
            section(
                say, "panels", Chart("panels", say("text.panels_chart"), panels_figure(record.panels, say=say), 1060),
                words(say, "panels", shown=say.short(SHOWN_RAD)),
            )
            if record.panels else ()
        ),
        *section(
            say, "maps", grid(drawn)
        ),
        *(section(say, "pedestal", Text([say.say(effect[0])]), grid(effect[1])) if effect else ()),
        *(section(say, "matrix", Legend(symbols(say), say("text.matrix")), shown) if shown else ()),
        *section(say, "scene", Group("split", [picture, Facts(vary, "")])),
        *section(say, "asked", Text(reasons, "plan"), *notes(say, record.findings)),
        *repeat(
            say, record, command_line("study", record.file, *(record.asked or ())),
            more=[Group("", [seconds], say("text.engine_time"))],
        ),
    ]  # fmt: skip


def _claims(record: StudyRecord, say: Language) -> list[Section]:
    """The paper's claims down, the models across, each with its verdict and what it rests on."""
    judged = grouped((item.claim, _judged(item, say)) for item in record.claims or ())
    rows: list[list[str | Cell]] = [[f"({claim}) {say(f'claim.{claim}')}", *cells] for claim, cells in judged.items()]
    heads = [_head(name) for name in dict.fromkeys(item.model for item in record.claims or ())]
    claims = Table(say("table.claims"), [say("label.claim"), *heads], rows, "claims")
    return section(say, "claims", words(say, "claims"), claims) if rows else []


def _judged(item: ClaimVerdict, say: Language) -> Cell:
    text = item.evidence.text or say.say(item.evidence)
    return Cell(item.verdict, f"claim {item.verdict.replace(' ', '-')}", text, JUDGED[item.verdict], below=text)


def _head(model: str) -> Cell:
    engine, _, variant = model.partition(" (")
    return Cell(engine, below=variant[:-1])


def study_charts(record: StudyRecord, answers: Answers, say: Language) -> list[Chart]:
    """The charts that the rows hold, each with its name on the page and its words: maps, curves, fragility."""
    if record.panels:  # the paper's arrangement shows the same as histories
        return []
    found = {
        "map": map_figures(answers, say),
        "map-design": design_figures(answers, say),
        "curve": curve_figures(answers, say),
    }
    charts = [
        Chart(f"{name}-{k}", title, figure)
        for name, figures in found.items()
        for k, (title, figure) in enumerate(figures)
    ]
    scattered = len(answers.axes) < len(answers.varying)
    for key in answers.axes if scattered else ():
        if "amplitude" in key or key.endswith("scale"):
            figure = fragility_figure(answers, key, say)
            if figure is not None:
                charts.append(Chart(f"fragility-{key}", say("text.study_fragility", key=say.label(key)), figure))
    return charts


def study_verdict(record: StudyRecord, answers: Answers, say: Language) -> Verdict:
    """The record's answer; no green without a probability."""
    ends = [told_family(run) for model in answers.models for _, run in answers.runs(model)]
    tone = tone_of_study(ends) if code(record) == "overturning" else "differ"
    return verdict(record, tone, [say.say(each) for each in best_designs(answers)])


def matrix(answers: Answers, say: Language) -> Table:
    """What was varied, and every model's answer; `differs` where models of one variant do not agree (different falls do)."""
    rows: list[list[str | Cell]] = []
    models, keys = answers.models, answers.varying
    for item in answers.cases:
        runs = [(model, run) for model in models if (run := item.run(model)) is not None and in_domain(run)]
        by_variant = grouped((model.partition(" (")[2], run.outcome) for model, run in runs)
        ends = [{"" if each.overturned else symbol(each, say)[1] for each in group} for group in by_variant.values()]
        style = "differs" if any(len(each) > 1 for each in ends) else ""
        varied = [Cell(say.value(item.varied[key], "plain"), style) for key in keys]
        rows.append([*varied, *(_answer(item.answers.get(model), say) for model in models)])
    return Table(say("table.matrix"), [*map(say.label, keys), *map(_head, models)], rows, "matrix")


def _answer(row: StudyRow | None, say: Language) -> Cell:
    """One model's answer under one condition: a sign, in its colour, with its numbers under the pointer."""
    if row is None or row.run is None:
        sign, words = symbols(say)[-1]
        return Cell("", "o-none", words if row is None else say.word(str(row.reason)), sign, words)
    run = row.run
    sign, words = told_symbol(run, say)
    stood = told_family(run) == "stands" and run.peak_theta_rad is not None
    told = {
        "peak": abs(run.peak_theta_rad) if stood else None,
        "no_return": run.no_return_time_s,
        "error": run.numerical_uncertainty_rad,
    }
    known = [say(f"text.tip_{name}", value=say.digits(value, 4)) for name, value in told.items() if value is not None]
    return Cell("", f"o-{told_family(run)}", "; ".join([words, *known]), sign, words)


# A rocking spectrum: which blocks fall, and how far the others rock, by size and slenderness.

MOST_CELLS: Final = 80
"""Sizes and slendernesses that a picture shows at most: a page grows with their product."""
Map = Sequence[Sequence[float | None]]


def rocking_spectrum_page(_folder: Path, record: RockingSpectrumRecord, say: Language) -> list[Block]:
    """The blocks of a rocking spectrum's page."""
    falls, peaks = (
        _spectrum_map(record, record.probability_overturned, "P", say),
        _spectrum_map(record, record.peak_median, say("chart.peak_over_alpha"), say),
    )
    settings = {
        "strengths": say("text.strengths_given") if record.draws == 1 else say(
            "text.strengths", draws=record.draws, spread=say.percent(record.strength_cov)
        ),
        "restitution": say("text.momentum") if record.restitution == "momentum" else record.restitution,
        "blocks": say(
            "text.blocks", sizes=len(record.size_m), slendernesses=len(record.slenderness), cases=record.cases
        ),
        "still_leaning": say.percent(record.undecided),
    }  # fmt: skip
    charts = [Chart("falls", say("text.spectrum_falls"), falls), Chart("peaks", say("text.spectrum_peaks"), peaks)]
    return [
        spectrum_verdict(record),
        *section(say, "maps", grid(charts), words(say, "spectrum")),
        *section(say, "motions", table(say, "motions", "name pga_g pgv_m_s duration_s", record.motions)),
        # Records of older versions do not name their file.
        *repeat(
            say, record, *([command_line("study", record.file)] if record.file else []), more=[facts(say, settings)]
        ),
    ]


def spectrum_verdict(record: RockingSpectrumRecord) -> Verdict:
    """The record's answer; green where no block falls often."""
    cells = [p for line in record.probability_overturned for p in line]
    # The block that falls most often decides, with the interval that so many cases leave open.
    most = wilson(round(max(cells) * record.cases), record.cases, LEVEL)
    safe = most is not None and most.value <= SAFE and most.high < SAFE_HIGH and not record.undecided
    return verdict(record, "agree" if safe else "differ")


def _spectrum_map(record: RockingSpectrumRecord, values: Map, name: str, say: Language) -> Json:
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


# A trust map: one picture of where the analytic model holds, and what each class means.


BASES: Final = ("rest", "runs", "between", "checked")
"""What a point may rest on."""


def trust_page(_folder: Path, record: TrustRecord, say: Language) -> list[Block]:
    """The blocks of a trust map's page."""
    kinds = [kind for kind in CLASSES if any(each.shares[kind] for each in record.maps)]
    cells = [cell for each in record.maps for cell in each.cells]
    falls = any(cell["outcomes"].get(MODEL) == "overturned" for cell in cells)
    tone = "failed" if "refuted" in kinds else "agree" if set(kinds) <= HELD and not falls else "differ"
    where = {each.stands_on: f" {say(f'chart.on_{each.stands_on}')}" if record.maps[1:] else "" for each in record.maps}
    shares = {
        kind: say.row([f"{say.percent(each.shares[kind])}{where[each.stands_on]}" for each in record.maps])
        for kind in kinds
    }
    meanings = [(f"{say.word(kind)}, {each}", say(f"text.trust_{kind}")) for kind, each in shares.items()]
    counts = [(say(f"text.basis_{name}"), str(sum(cell["basis"] == name for cell in cells))) for name in BASES]
    spent = {
        "engines": record.engines,
        "points": record.summary.points,
        "cpu_time": say.value(record.summary.cpu_s, "s"),
    }
    command = command_line("run", record.scene.file or "SCENE", e=record.engines, set=record.overrides)
    whole = command_line(
        "trust", record.scene.file or "SCENE", coarse=record.coarse, e=record.engines, set=record.overrides,
        motion=record.motion, seed=record.seed,
    )  # fmt: skip
    *_, floor = record.maps
    run = point_figure(record.maps, say)
    return [
        verdict(record, tone),
        *section(
            say, "map",
            grid(
                Chart(each.stands_on, say(f"text.trust_on_{each.stands_on}"), trust_map(each, floor, command, say))
                for each in record.maps
            ),
            Group("", [Chart(POINT, say("text.trust_point"), run, 1060)], say("text.trust_point")) if run else None,
            words(say, "trust_map", motion=say(f"text.motion_{record.motion}"), name=CELLS_NAME),
        ),
        *section(
            say, "classes", Facts(meanings, ""), Group("", [Facts(counts)], say("text.bases")),
            Text([each.text for each in record.findings], "notes"),
        ),
        *repeat(say, record, whole, f"{command} {shlex.join(sets(record.maps[0].cells[-1]))}", more=[facts(say, spent)]),
    ]  # fmt: skip


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
    return np.array([cell["outcomes"].get(MODEL) == "overturned" for cell in record.cells]).reshape(-1, count).T


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
