"""Charts of curves that one page each shows: comparisons, assessments, benches, validations."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from harness.comparison.statistics import FELL
from harness.model import History, pair
from harness.questions.validate.scenes import GRAVITY_M_S2
from harness.records.assess import FragilityRecord
from harness.records.bench import LEVEL, TARGET, PrecisionRow, ScalingRow
from harness.records.validation import BaselineRecord, Curves, ModelRecord, TestRow, ValidationRecord
from reports.charts import Json
from reports.charts.figure import (
    HAIRLINE,
    INK,
    MUTED,
    Look,
    Row,
    across,
    axis,
    band,
    chosen,
    columns,
    columns_of,
    discs,
    estimates,
    figure,
    filled,
    level,
    log,
    look,
    marks,
    named,
    names,
    over_time,
    reading,
    rows_of,
    span,
    stroke,
    upwards,
    wrapped,
)
from reports.messages import ENGLISH, Language
from reports.source import MOVED_SHARE, event_s


def compare_figure(names: tuple[str, str], a: History, b: History, say: Language = ENGLISH) -> Json:
    """Rotations, their difference on one grid, and slips where there are any, over one axis of time."""
    both, less = pair(a, b), say("chart.first_less_second")
    looks = {name: look(name, (*names, less)) for name in (*names, less)}
    known = dict(zip(names, (a, b), strict=True))
    data: dict[str, list[Json]] = {
        "rotations": [{"name": name, "t": each.t_s, "theta": each.theta_rad} for name, each in known.items()],
        "difference": [{"name": less, "t": both.t_s, "difference": both.difference_rad}],
    }
    shown = [reading("rotations", "theta", "", "rad", 5), reading("difference", "difference", "", "rad", 5)]
    if any(history.slip_m.any() for history in (a, b)):
        data["slips"] = [{"name": name, "t": each.t_s, "slip": 1e3 * each.slip_m} for name, each in known.items()]
        shown.append(reading("slips", "slip", "", "mm", 5))
    rows: list[Row] = []
    for read in shown:
        y = axis(read["of"], say(f"chart.{read['of']}"), tickCount=5, labelExpr="format(datum.value, '~g')")
        lines = [marks("line", read["data"], {"y": y} | named(looks, legend=not rows))]
        rows.append((lines, 110, read) if rows else (chosen(lines), 260, read))
    end, moved = float(both.t_s[-1]), MOVED_SHARE * float(np.abs(b.theta_rad).max(initial=0.0))
    turned = np.concatenate([a.theta_rad, b.theta_rad])
    views = {
        "event_s": list(event_s((a, b), moved, end)),
        "duration_s": end,
        "whole": [float(turned.min()), float(turned.max())],
    }
    return over_time(rows, say("chart.time"), data, views)


TICKS: Final = [0.25, 0.5, 1.0, 2.0, 4.0]
"""Factors written on the axis."""


def fragility_by_factor(fragility: FragilityRecord, say: Language = ENGLISH) -> Json:
    """The probability of overturning by a factor on the shaking, with its band."""
    chance = fragility.probability_overturned
    tips = [
        f"× {say.digits(factor)}: {say.percent(value)}" for factor, value in zip(fragility.factor, chance, strict=True)
    ]
    data = {"curve": [{"name": fragility.model, "x": fragility.factor, "y": chance, "tip": tips}]}
    layers = [marks("line", "curve", strokeWidth=2, color=INK), discs("curve", {}, color=INK)]
    if fragility.low:
        data["band"] = [{"x": fragility.factor, "low": fragility.low, "high": fragility.high}]
        layers.insert(0, marks("area", "band", span("low", "high"), color=INK, opacity=0.1))
    layers += level(1.0, say("chart.today"), "x", Look(MUTED, "4 3", 1.0))
    x = across("x", say("chart.factor"), log(), values=TICKS)
    return figure(
        layers, 380, data, x, upwards("y", say("chart.overturning_probability"), {"domain": [0.0, 1.0]}, format=".0%")
    )


SHAPES: Final = {LEVEL: "circle", TARGET: "diamond"}
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


def shapes(known: Mapping[str, str], key: bool = True) -> Json:
    """A sign for each kind, with a key of them."""
    scale = {"domain": list(known), "range": list(known.values())}
    legend = {"symbolFillColor": MUTED, "symbolStrokeWidth": 0, **wrapped(known)} if key else None
    return {"shape": {"field": "kind", "type": "nominal", "scale": scale, "legend": legend}}


def precision_figure(scene: str, rows: Sequence[PrecisionRow], target_rad: float, say: Language = ENGLISH) -> Json:
    """Work–precision of one scene on logarithmic axes: a line for each engine's levels, other signs for other settings."""
    known = (row for row in rows if row.scene == scene and row.failed is None and row.error_rad)
    here = sorted(known, key=lambda row: row.error_rad or 0.0)
    engines = list(dict.fromkeys(row.engine for row in rows))
    words = {group: say(f"chart.group_{group}") for group in SHAPES}
    tips = {
        row: say(
            "chart.setting",
            name=row.engine,
            setting=row.label,
            error=say.digits(row.error_rad),
            time=say.digits(row.cpu_s or 0.0),
        )
        for row in here
    }
    parts: list[Json] = [
        {
            "name": engine, "kind": words[group],
            **columns("x y size tip", [(row.cpu_s, row.error_rad, 170 if row.chosen else 55, tips[row]) for row in mine]),
        }
        for engine in engines for group in SHAPES
        for mine in [[row for row in here if (row.engine, row.group) == (engine, group)]] if mine
    ]  # fmt: skip
    front = [row for row in here if row.dt_s and on_front(row, here)]
    met = {
        words[group]: shape for group, shape in SHAPES.items() if any(part["kind"] == words[group] for part in parts)
    }
    drawn = named({engine: look(engine, engines) for engine in engines})
    size = {"size": {"field": "size", "type": "quantitative", "scale": None, "legend": None}}
    order = {"order": {"field": "y", "type": "quantitative"}}
    data = {
        "settings": parts, "levels": [part for part in parts if part["kind"] == words[LEVEL]],
        "front": [columns("x y", [(row.cpu_s, row.error_rad) for row in front])],
    }  # fmt: skip
    layers = [
        marks("line", "front", order, color=MUTED, strokeWidth=6, opacity=0.25, interpolate="step-after"),
        *chosen([marks("line", "levels", drawn | order)]),
        marks("point", "settings", filled(drawn) | shapes(met) | size, filled=True, strokeWidth=0),
        *level(target_rad, say("chart.target"), line=Look(INK, "6 4", 1.0)),
    ]
    x, y = across("x", say("chart.cpu_s"), log(), **POWERS), upwards("y", say("chart.error_rad"), log(), **POWERS)
    return figure(layers, 460, data, x, y)


POWERS: Final = {"format": ".0e", "tickCount": 5}
"""How the powers of ten of a logarithmic axis are written."""


def scaling_figure(items: Sequence[ScalingRow], say: Language = ENGLISH) -> Json:
    """Time above, peak memory below, on logarithmic axes; one line for each engine (colour) and quantity (sign)."""
    engines = list(dict.fromkeys(item.engine for item in items))
    looks = {engine: look(engine, engines) for engine in engines}
    parts: list[Json] = []
    for engine, quantity in dict.fromkeys((item.engine, item.quantity) for item in items):
        mine = sorted((i for i in items if (i.engine, i.quantity) == (engine, quantity)), key=lambda i: i.value)
        sizes = [(item.value / mine[0].value, item.wall_s, item.memory_mb) for item in mine]
        parts.append({"name": engine, "kind": say.label(quantity), **columns("x wall_s memory_mb", sizes)})
    met = {say.label(name): shape for name, shape in QUANTITIES.items() if any(item.quantity == name for item in items)}
    most, least = max(max(part["x"]) for part in parts), min(item.wall_s for item in items)
    data = {"sizes": parts, "proportional": [{"x": [1.0, most], "wall_s": [least, least * most]}]}
    rows: list[tuple[list[Json], float]] = []
    for key, height in PANELS.items():
        y, drawn = axis(key, say(f"chart.{key}"), scale=log(), tickCount=5), named(looks, legend=not rows)
        signs = {"y": y} | filled(drawn) | shapes(met, key=not rows)
        layers = [
            marks("line", "sizes", {"y": y} | drawn | {"detail": {"field": "kind"}}),
            marks("point", "sizes", signs, filled=True, size=60, strokeWidth=0),
        ]
        if not rows:
            layers = [
                *chosen(layers),
                marks("line", "proportional", {"y": y}, color=MUTED, strokeWidth=6, opacity=0.25),
            ]
        rows.append((layers, height))
    return rows_of(rows, across("x", say("chart.size"), log(), tickCount=4), data)


# The charts of a validation: accuracy by model, every test in its plane of intensities, fragility.

BASELINE_LOOK: Final = Look("#8a6d00", "2 3")
DASHES: Final = ("", "6 4", "1.5 3", "6 3 1.5 3", "10 4")


Seen = Sequence[tuple[str, Look, Curves]]
"""What was measured and each model by name: how its line is drawn, and its curves."""
Scored = Sequence[tuple[str, Look, ModelRecord | BaselineRecord]]
"""Each model and the threshold of intensity."""


def charts(record: ValidationRecord, say: Language = ENGLISH) -> list[tuple[str, str, Json]]:
    """Accuracy by model, tests in PGA against PGV/PGA with contours, fragility curves, accuracy by intensity."""
    looks = styles({name: item.engine for name, item in record.models.items()})
    models = [(name, looks[name], item) for name, item in record.models.items()]
    seen: Seen = [(say("chart.measured"), Look(INK, "", 3.0), record.observed), *models]
    scored: Scored = [*models, (say("word.pgv_threshold"), BASELINE_LOOK, record.baseline)]
    drawn = {
        "accuracy": _accuracy(scored, say), "plane": _plane(record.rows, seen, say), "fragility": _fragility(seen, say),
        "reliability": _reliability(scored, say) if record.samples else None,
    }  # fmt: skip
    return [(name, say(f"chart.validation_{name}"), each) for name, each in drawn.items() if each is not None]


def styles(engine_of: Mapping[str, str]) -> dict[str, Look]:
    """Colour by engine; the settings of one engine differ by their dashes."""
    engines = list(engine_of.values())
    looks: dict[str, Look] = {}
    for index, (name, engine) in enumerate(engine_of.items()):
        own, earlier = look(engine, engines), engines[:index].count(engine)
        others = [dash for dash in DASHES if dash != own.dash]
        looks[name] = Look(own.colour, own.dash if earlier == 0 else others[(earlier - 1) % len(others)])
    return looks


def _accuracy(scored: Scored, say: Language) -> Json:
    """The share of tests of which each model said the end, beside what the threshold of intensity says."""
    rows = {name: each.outcomes.accuracy for name, _, each in scored if each.outcomes.accuracy is not None}
    parts = [
        {"name": name, "y": [name], "tip": [f"{name} {100 * item.value:.0f} %"], **columns_of([item], 100.0, "x")}
        for name, item in rows.items()
    ]
    colour = named({name: look for name, look, _ in scored}, legend=False)["color"]
    layers = estimates("shares", {"color": colour}, "x")
    x = across("x", say("chart.right"), {"domain": [0, 100]})
    return figure(layers, 40 + 40 * len(rows), {"shares": parts}, x, names("y", list(rows), grid=False))


def _plane(tests: Sequence[TestRow], seen: Seen, say: Language) -> Json:
    """Every test by its intensities, with each model's contour of even chances."""
    stood, fallen = say("chart.stood"), say("chart.fell")
    parts = [
        {"kind": words, **columns("x y tip", [
            (row.pgv_m_s / (GRAVITY_M_S2 * row.pga_g), row.pga_g, f"{row.test}: {say.digits(row.pga_g)} g, {words}")
            for row in tests if row.pga_g > 0.0 and row.observed.startswith(FELL) == fell
        ])}
        for fell, words in ((False, stood), (True, fallen))
    ]  # fmt: skip
    kind: Json = {"field": "kind", "type": "nominal"}
    sign = {
        "shape": kind | {"scale": {"domain": [stood, fallen], "range": ["circle", "M-1-1L1 1M-1 1L1-1"]}},
        "stroke": kind | {"scale": {"domain": [stood, fallen], "range": ["#0072B2", "#D55E00"]}},
    }
    layers = [marks("point", "tests", sign, size=50, strokeWidth=1.6, filled=False)]
    contours = [
        (say("chart.half_fall", name=name), style, item.contour.contour_50)
        for name, style, item in seen if item.contour is not None
    ]  # fmt: skip
    lines = [{"name": words, "x": each.ratio_s, "y": each.pga_g} for words, _, each in contours]
    if contours:
        looks = {words: style for words, style, _ in contours}
        layers.append(marks("line", "contours", named(looks, chosen=False)))
    x, y = across("x", "PGV / PGA  [s]", {"zero": True}), upwards("y", "PGA  [g]", {"zero": True})
    return figure(layers, 420, {"tests": parts, "contours": lines}, x, y)


def _fragility(seen: Seen, say: Language) -> Json | None:
    """The fitted curves, that of the measured tests with its band."""
    fitted = [
        (name, style, item.fragility_pgv)
        for name, style, item in seen
        if item.fragility_pgv is not None and item.fragility_pgv.median is not None
    ]
    if not fitted:
        return None
    drawn = named({name: style for name, style, _ in fitted}, chosen=False)
    curves = [{"name": name, "x": each.intensity, "y": each.probability} for name, _, each in fitted]
    around = [
        {"name": name, "x": each.intensity, "low": each.low, "high": each.high}
        for name, _, each in fitted
        if name == seen[0][0]
    ]
    layers = [band("around", drawn, 0.1), marks("line", "curves", drawn)]
    y = upwards("y", say("chart.overturning_probability"), {"domain": [0.0, 1.0]})
    return figure(layers, 380, {"curves": curves, "around": around}, across("x", "PGV  [m/s]", log(), tickCount=6), y)


def _reliability(scored: Scored, say: Language) -> Json | None:
    """The share that fell over the mean probability of each bin; true ones lie on the diagonal."""
    bins = {name: each.probability.reliability for name, _, each in scored if each.probability.reliability}
    if not bins:
        return None
    drawn = named({name: look for name, look, _ in scored if name in bins}, chosen=False)
    parts = [
        {
            "name": name, "x": [item.mean for item in mine], **columns_of([item.fell for item in mine]),
            "tip": [
                say("chart.bin", name=name, cases=item.cases, said=say.digits(item.mean, 2), fell=say.digits(item.fell.value, 2))
                for item in mine
            ],
        }
        for name, mine in bins.items()
    ]  # fmt: skip
    layers = [
        marks("line", "true", **stroke(Look(HAIRLINE, "", 2.0))),
        marks("line", "bins", drawn),
        *estimates("bins", drawn),
    ]
    shown = {"domain": [0.0, 1.0]}
    x, y = across("x", say("chart.overturning_probability"), shown), upwards("y", say("chart.share_fell"), shown)
    return figure(layers, 400, {"bins": parts, "true": [{"x": [0.0, 1.0], "y": [0.0, 1.0]}]}, x, y)
