"""Charts of curves that one page each shows: comparisons, assessments, benches, validations."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final, TypeVar

import numpy as np

from harness.comparison.statistics.outcomes import FELL
from harness.model.history import History, pair
from harness.questions.validate.scenes import GRAVITY_M_S2
from harness.records.assess import FragilityRecord
from harness.records.bench import DEFAULT, LEVEL, OTHER_PROJECT, TARGET, PrecisionRow, ScalingRow
from harness.records.validation import Curves, ReliabilityBin, ValidationRecord
from reports.charts import Json
from reports.charts.figure import (
    HAIRLINE,
    INK,
    MUTED,
    Look,
    across,
    axis,
    band,
    chosen,
    columns_of,
    discs,
    estimates,
    figure,
    level,
    log,
    look,
    marks,
    named,
    names,
    rows_of,
    stroke,
    upwards,
)  # fmt: skip  # fmt: skip
from reports.messages import ENGLISH, Language
from reports.source import MOVED_SHARE, event_s


def compare_figure(names: tuple[str, str], a: History, b: History, say: Language = ENGLISH) -> Json:
    """Rotations, their difference on one grid, and slips where there are any, over one axis of time."""
    both, less = pair(a, b), say("chart.first_less_second")
    looks = {name: look(name, (*names, less)) for name in (*names, less)}
    data: dict[str, list[Json]] = {
        "rotations": [
            {"name": name, "t": each.t_s, "theta": each.theta_rad} for name, each in zip(names, (a, b), strict=True)
        ],
        "difference": [{"name": less, "t": both.t_s, "difference": both.difference_rad}],
    }
    rows = [
        ("rotations", "theta", "rad", 260.0),
        ("difference", "difference", "rad", 110.0),
    ]
    if any(history.slip_m.any() for history in (a, b)):
        data["slips"] = [
            {"name": name, "t": each.t_s, "slip": 1e3 * each.slip_m} for name, each in zip(names, (a, b), strict=True)
        ]
        rows.append(("slips", "slip", "mm", 110.0))
    moved = MOVED_SHARE * float(np.abs(b.theta_rad).max(initial=0.0))
    shown = list(event_s((a, b), moved, float(both.t_s[-1])))
    drawn = {
        column: (axis(column, say(f"chart.{column}"), tickCount=5, format="~g"), height, name)
        for name, column, _, height in rows
    }

    def layers(y: Json, first: bool) -> list[Json]:
        lines = [marks("line", drawn[y["field"]][2], {"y": y} | named(looks, legend=first))]
        return chosen(lines) if first else lines

    x = across("t", say("chart.time"), {"domain": shown, "padding": 0})
    spec = rows_of([(y, height) for y, height, _ in drawn.values()], x, data, layers)
    told = [{"data": name, "of": column, "words": "", "unit": unit, "decimals": 5} for name, column, unit, _ in rows]
    whole = [float(min(each.theta_rad.min() for each in (a, b))), float(max(each.theta_rad.max() for each in (a, b)))]
    return spec | {
        "usermeta": {"views": {"event_s": shown, "duration_s": float(both.t_s[-1]), "whole": whole}, "read": told}
    }


TICKS: Final = [0.25, 0.5, 1.0, 2.0, 4.0]
"""Factors written on the axis."""


def fragility_by_factor(fragility: FragilityRecord, say: Language = ENGLISH) -> Json:
    """The probability of overturning by a factor on the shaking, with its band."""
    chance = fragility.probability_overturned
    tips = [f"× {factor:.2f}: {value:.0%}" for factor, value in zip(fragility.factor, chance, strict=True)]
    data = {"curve": [{"name": fragility.model, "x": fragility.factor, "y": chance, "tip": tips}]}
    layers = [marks("line", "curve", strokeWidth=2, color=INK), discs("curve", {}, color=INK)]
    if fragility.low:
        data["band"] = [{"x": fragility.factor, "low": fragility.low, "high": fragility.high}]
        layers.insert(
            0, marks("area", "band", {"y": {"field": "low"}, "y2": {"field": "high"}}, color=INK, opacity=0.1)
        )
    layers += level(1.0, say("chart.today"), "x", Look(MUTED, "4 3", 1.0))
    x = across("x", say("chart.factor"), log(), values=TICKS)
    return figure(
        layers, 380, data, x, upwards("y", say("chart.overturning_probability"), {"domain": [0.0, 1.0]}, format=".0%")
    )


SHAPES: Final = {LEVEL: "circle", TARGET: "diamond", DEFAULT: "square", OTHER_PROJECT: "triangle-up"}
QUANTITIES: Final = {"duration_s": "circle", "mesh_vertices": "square", "runs": "diamond", "workers": "triangle-up"}
PANELS: Final = {"wall_s": 330.0, "memory_mb": 200.0}
"""For each measure its height."""


def on_front(row: PrecisionRow, rows: Sequence[PrecisionRow]) -> bool:
    """Whether no other setting of its kind on the same scene is both faster and more accurate.

    Contact engines, which have a step, compete with each other; the analytic model, which has none, would leave no front.
    An error of exactly nothing is that of a run compared with itself: it stands in the table only.
    """
    if not row.error_rad or row.failed is not None:
        return False
    mine = row.error_rad, row.cpu_s or 0.0
    others = [
        (other.error_rad, other.cpu_s or 0.0)
        for other in rows
        if other.scene == row.scene and bool(other.dt_s) == bool(row.dt_s) and other.failed is None and other.error_rad
    ]
    return not any(error <= mine[0] and cost <= mine[1] and (error, cost) != mine for error, cost in others)


def shapes(known: Mapping[str, str]) -> Json:
    """A sign for each kind, with a key of them."""
    scale = {"domain": list(known), "range": list(known.values())}
    return {
        "shape": {
            "field": "kind",
            "type": "nominal",
            "scale": scale,
            "legend": {"symbolFillColor": MUTED, "symbolStrokeWidth": 0},
        }
    }


def precision_figure(scene: str, rows: Sequence[PrecisionRow], target_rad: float, say: Language = ENGLISH) -> Json:
    """Work–precision of one scene on logarithmic axes: a line for each engine's levels, other signs for other settings."""
    here = [row for row in rows if row.scene == scene and row.failed is None and row.error_rad]
    engines, words = (
        list(dict.fromkeys(row.engine for row in rows)),
        {group: say(f"chart.group_{group}") for group in SHAPES},
    )
    looks = {engine: look(engine, engines) for engine in engines}
    parts: list[Json] = [
        {
            "name": engine, "kind": words[group], "x": [row.cpu_s for row in mine], "y": [row.error_rad for row in mine],
            "size": [170 if row.chosen else 55 for row in mine],
            "tip": [_tip(row, say) for row in mine],
        }
        for engine in engines for group in SHAPES
        for mine in [sorted((row for row in here if (row.engine, row.group) == (engine, group)), key=_error)] if mine
    ]  # fmt: skip
    front = sorted((row for row in here if row.dt_s and on_front(row, here)), key=_error)
    best = {"x": [row.cpu_s for row in front], "y": [row.error_rad for row in front]}
    met = {
        words[group]: shape for group, shape in SHAPES.items() if any(part["kind"] == words[group] for part in parts)
    }
    drawn = named(looks)
    sign = {"fill": drawn["color"], "opacity": drawn["opacity"], **shapes(met)}
    size = {"size": {"field": "size", "type": "quantitative", "scale": None, "legend": None}}
    order = {"order": {"field": "y", "type": "quantitative"}}
    data = {"settings": parts, "levels": [part for part in parts if part["kind"] == words[LEVEL]], "front": [best]}
    layers = [
        marks("line", "front", order, color=MUTED, strokeWidth=6, opacity=0.25, interpolate="step-after"),
        marks("line", "levels", drawn | order),
        marks("point", "settings", sign | size, filled=True, strokeWidth=0),
        *level(target_rad, say("chart.target"), line=Look(INK, "6 4", 1.0)),
    ]
    layers[1] = chosen([layers[1]])[0]
    x, y = across("x", say("chart.cpu_s"), log(), **POWERS), upwards("y", say("chart.error_rad"), log(), **POWERS)
    return figure(layers, 460, data, x, y)


POWERS: Final = {"format": ".0e", "tickCount": 5}
"""How the powers of ten of a logarithmic axis are written."""


def _tip(row: PrecisionRow, say: Language) -> str:
    """What a setting says under the pointer."""
    return say(
        "chart.setting",
        name=row.engine,
        setting=row.label,
        error=say.digits(row.error_rad or 0.0),
        time=say.digits(row.cpu_s or 0.0),
    )


def _error(row: PrecisionRow) -> float:
    return row.error_rad or 0.0


def scaling_figure(items: Sequence[ScalingRow], say: Language = ENGLISH) -> Json:
    """Time above, peak memory below, on logarithmic axes; one line for each engine (colour) and quantity (sign)."""
    engines = list(dict.fromkeys(item.engine for item in items))
    looks = {engine: look(engine, engines) for engine in engines}
    parts: list[Json] = []
    for engine, quantity in dict.fromkeys((item.engine, item.quantity) for item in items):
        mine = sorted((i for i in items if (i.engine, i.quantity) == (engine, quantity)), key=lambda i: i.value)
        sizes = {
            "x": [item.value / mine[0].value for item in mine],
            **{key: [getattr(item, key) for item in mine] for key in PANELS},
        }
        parts.append({"name": engine, "kind": say.heading(quantity), **sizes})
    quantities = {
        say.heading(name): shape for name, shape in QUANTITIES.items() if any(item.quantity == name for item in items)
    }
    most, least = max(max(part["x"]) for part in parts), min(item.wall_s for item in items)
    data = {"sizes": parts, "proportional": [{"x": [1.0, most], "wall_s": [least, least * most]}]}

    def layers(y: Json, first: bool) -> list[Json]:
        drawn = named(looks, legend=first)
        signs = shapes(quantities)
        key = signs if first else {"shape": signs["shape"] | {"legend": None}}
        each = {"detail": {"field": "kind"}}
        mine = [
            marks("line", "sizes", {"y": y} | drawn | each),
            marks(
                "point",
                "sizes",
                {"y": y, "fill": drawn["color"], "opacity": drawn["opacity"], **key},
                filled=True,
                size=60,
                strokeWidth=0,
            ),
        ]
        with_line = marks("line", "proportional", {"y": y}, color=MUTED, strokeWidth=6, opacity=0.25)
        return [*chosen(mine), with_line] if first else mine

    x = across("x", say("chart.size"), log(), tickCount=4)
    return rows_of(
        [(axis(key, say(f"chart.{key}"), scale=log(), tickCount=5), height) for key, height in PANELS.items()],
        x,
        data,
        layers,
    )


# The charts of a validation: accuracy by model, every test in its plane of intensities, fragility.


T = TypeVar("T")
BASELINE_LOOK: Final = Look("#8a6d00", "2 3")
DASHES: Final = ("", "6 4", "1.5 3", "6 3 1.5 3", "10 4")


def charts(record: ValidationRecord, say: Language = ENGLISH) -> list[tuple[str, str, Json]]:
    """Accuracy by model, tests in PGA against PGV/PGA with contours, fragility curves, accuracy by intensity."""
    figures = {"accuracy": _accuracy(record, say), "plane": _plane(record, say), "fragility": _fragility(record, say)}
    diagram = reliability_diagram(
        [
            *((name, _styles(record)[name], item.probability.reliability) for name, item in record.models.items()),
            (say("word.pgv_threshold"), BASELINE_LOOK, record.baseline.probability.reliability),
        ],
        say,
    )
    figures["reliability"] = diagram if record.samples else None
    return [(name, say(f"chart.validation_{name}"), each) for name, each in figures.items() if each is not None]


def _styles(record: ValidationRecord) -> dict[str, Look]:
    return styles({name: item.engine for name, item in record.models.items()})


def styles(engine_of: Mapping[str, str]) -> dict[str, Look]:
    """Colour by engine; the settings of one engine differ by their dashes."""
    engines = list(engine_of.values())
    looks: dict[str, Look] = {}
    for index, (name, engine) in enumerate(engine_of.items()):
        own, earlier = look(engine, engines), engines[:index].count(engine)
        others = [dash for dash in DASHES if dash != own.dash]
        looks[name] = Look(own.colour, own.dash if earlier == 0 else others[(earlier - 1) % len(others)])
    return looks


def _accuracy(record: ValidationRecord, say: Language) -> Json:
    looks = _styles(record) | {say("word.pgv_threshold"): BASELINE_LOOK}
    shares = {name: item.outcomes.accuracy for name, item in record.models.items()}
    shares[say("word.pgv_threshold")] = record.baseline.outcomes.accuracy
    rows = {name: share for name, share in shares.items() if share is not None}
    parts = [
        {"name": name, "y": [name], "tip": [f"{name} {100 * item.value:.0f} %"], **columns_of([item], 100.0, "x")}
        for name, item in rows.items()
    ]
    layers = estimates("shares", {"color": named(looks, legend=False)["color"]}, "x")
    x = across("x", say("chart.right"), {"domain": [0, 100]})
    return figure(layers, 40 + 40 * len(rows), {"shares": parts}, x, names("y", list(rows), grid=False))


def _plane(record: ValidationRecord, say: Language) -> Json:
    tests: list[Json] = []
    stood, fallen = say("chart.stood"), say("chart.fell")
    for fell, words in ((False, stood), (True, fallen)):
        rows = [row for row in record.rows if row.observed.startswith(FELL) == fell and row.pga_g > 0.0]
        ratio = [row.pgv_m_s / (GRAVITY_M_S2 * row.pga_g) for row in rows]
        tips = [f"{row.test}: {row.pga_g:.3f} g, {words}" for row in rows]
        tests.append({"kind": words, "x": ratio, "y": [row.pga_g for row in rows], "tip": tips})
    contours = {
        say("chart.half_fall", name=name): (style, contour.contour_50)
        for name, style, contour in _curves(record, lambda item: item.contour, say)
        if contour is not None
    }  # fmt: skip
    lines = [{"name": name, "x": each.ratio_s, "y": each.pga_g} for name, (_, each) in contours.items()]
    kind: Json = {"field": "kind", "type": "nominal"}
    sign = {
        "shape": kind | {"scale": {"domain": [stood, fallen], "range": ["circle", "M-1-1L1 1M-1 1L1-1"]}},
        "stroke": kind | {"scale": {"domain": [stood, fallen], "range": ["#0072B2", "#D55E00"]}},
    }
    layers = [marks("point", "tests", sign, size=50, strokeWidth=1.6, filled=False)]
    if contours:
        layers.append(
            marks("line", "contours", named({name: style for name, (style, _) in contours.items()}, chosen=False))
        )
    x, y = across("x", "PGV / PGA  [s]", {"zero": True}), upwards("y", "PGA  [g]", {"zero": True})
    return figure(layers, 420, {"tests": tests, "contours": lines}, x, y)


def _curves(record: ValidationRecord, of: Callable[[Curves], T], say: Language) -> list[tuple[str, Look, T]]:
    """What was measured and each model by name: how its line is drawn, and its curve."""
    measured = say("chart.measured")
    looks = {measured: Look(INK, "", 3.0)} | _styles(record)
    return [(name, looks[name], of(item)) for name, item in {measured: record.observed, **record.models}.items()]


def _fragility(record: ValidationRecord, say: Language) -> Json | None:
    """The fitted curves, that of the measured tests with its band."""
    fitted = {
        name: (style, item) for name, style, item in _curves(record, lambda each: each.fragility_pgv, say)
        if item is not None and item.median is not None
    }  # fmt: skip
    if not fitted:
        return None
    drawn = named({name: style for name, (style, _) in fitted.items()}, chosen=False)
    parts = [{"name": name, "x": item.intensity, "y": item.probability} for name, (_, item) in fitted.items()]
    around = [
        {"name": name, "x": item.intensity, "low": item.low, "high": item.high}
        for name, (_, item) in fitted.items() if name == say("chart.measured")
    ]  # fmt: skip
    layers = [band("around", drawn, 0.1), marks("line", "curves", drawn)]
    y = upwards("y", say("chart.overturning_probability"), {"domain": [0.0, 1.0]})
    return figure(layers, 380, {"curves": parts, "around": around}, across("x", "PGV  [m/s]", log(), tickCount=6), y)


def reliability_diagram(
    curves: Sequence[tuple[str, Look, Sequence[ReliabilityBin]]], say: Language = ENGLISH
) -> Json | None:
    """Of each name, look and bins: the share that fell over its bin's mean probability; true ones lie on the diagonal."""
    drawn = named({name: style for name, style, bins in curves if bins}, chosen=False)
    parts = [
        {
            "name": name, "x": [item.mean for item in bins], **columns_of([item.fell for item in bins]),
            "tip": [
                say("chart.bin", name=name, cases=item.cases, said=f"{item.mean:.2f}", fell=f"{item.fell.value:.2f}")
                for item in bins
            ],
        }
        for name, _, bins in curves if bins
    ]  # fmt: skip
    if not parts:
        return None
    data = {"bins": parts, "true": [{"x": [0.0, 1.0], "y": [0.0, 1.0]}]}
    layers = [
        marks("line", "true", **stroke(Look(HAIRLINE, "", 2.0))),
        marks("line", "bins", drawn),
        *estimates("bins", drawn),
    ]
    shown = {"domain": [0.0, 1.0]}
    return figure(
        layers,
        400,
        data,
        across("x", say("chart.overturning_probability"), shown),
        upwards("y", say("chart.share_fell"), shown),
    )
