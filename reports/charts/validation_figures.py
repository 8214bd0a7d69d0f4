"""The charts of a validation: accuracy by model, every test in its plane of intensities, fragility."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final, TypeVar

from harness.comparison.statistics.outcomes import FELL
from harness.questions.validate.scenes import GRAVITY_M_S2
from harness.records.sets import ReliabilityBin
from harness.records.validation import Curves, ValidationRecord
from reports.charts import Json
from reports.charts.figure import (
    across,
    band,
    columns_of,
    estimates,
    figure,
    log,
    marks,
    named,
    names,
    stroke,
    upwards,
)  # fmt: skip
from reports.charts.palette import HAIRLINE, INK, Look, look
from reports.messages import ENGLISH, Language

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
