"""The charts of a validation: accuracy by model, every test in its plane of intensities, fragility."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final, TypeVar

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

T = TypeVar("T")
BASELINE: Final = "PGV threshold"
BASELINE_LOOK: Final = Look("#8a6d00", "2 3")
FELL: Final = "overturned"
DASHES: Final = ("", "6 4", "1.5 3", "6 3 1.5 3", "10 4")


def charts(record: ValidationRecord) -> list[tuple[str, str, Json]]:
    """Accuracy by model, tests in PGA against PGV/PGA with contours, fragility curves, accuracy by intensity."""
    figures = [("accuracy", "Share of tests predicted right, with 95 % intervals", _accuracy(record))]
    figures.append(("plane", "Every test, and where half of them fall", _plane(record)))
    fragility = _fragility(record)
    if fragility is not None:
        figures.append(("fragility", "Probability of overturning against PGV", fragility))
    diagram = reliability_diagram(
        [
            *((name, _styles(record)[name], item.probability.reliability) for name, item in record.models.items()),
            (BASELINE, BASELINE_LOOK, record.baseline.probability.reliability),
        ]
    )
    if record.samples and diagram is not None:
        figures.append(("reliability", "Share that fell against the probability said, with 95 % intervals", diagram))
    return figures


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


def _accuracy(record: ValidationRecord) -> Json:
    looks = _styles(record) | {BASELINE: BASELINE_LOOK}
    shares = {name: item.outcomes.accuracy for name, item in record.models.items()}
    shares[BASELINE] = record.baseline.outcomes.accuracy
    rows = {name: share for name, share in shares.items() if share is not None}
    parts = [
        {"name": name, "y": [name], "tip": [f"{name} {100 * item.value:.0f} %"], **columns_of([item], 100.0, "x")}
        for name, item in rows.items()
    ]
    layers = estimates("shares", {"color": named(looks, legend=False)["color"]}, "x")
    x = across("x", "right  [%]", {"domain": [0, 100]})
    return figure(layers, 40 + 40 * len(rows), {"shares": parts}, x, names("y", list(rows), grid=False))


def _plane(record: ValidationRecord) -> Json:
    tests: list[Json] = []
    for fell, words in ((False, "stood"), (True, "fell")):
        rows = [row for row in record.rows if row.observed.startswith(FELL) == fell and row.pga_g > 0.0]
        ratio = [row.pgv_m_s / (GRAVITY_M_S2 * row.pga_g) for row in rows]
        tips = [f"{row.test}: {row.pga_g:.3f} g, {words}" for row in rows]
        tests.append({"kind": words, "x": ratio, "y": [row.pga_g for row in rows], "tip": tips})
    contours = {
        f"half fall: {name}": (style, contour.contour_50) for name, style, contour in _curves(record, lambda item: item.contour)
        if contour is not None
    }  # fmt: skip
    lines = [{"name": name, "x": each.ratio_s, "y": each.pga_g} for name, (_, each) in contours.items()]
    kind: Json = {"field": "kind", "type": "nominal"}
    sign = {
        "shape": kind | {"scale": {"domain": ["stood", "fell"], "range": ["circle", "M-1-1L1 1M-1 1L1-1"]}},
        "stroke": kind | {"scale": {"domain": ["stood", "fell"], "range": ["#0072B2", "#D55E00"]}},
    }
    layers = [marks("point", "tests", sign, size=50, strokeWidth=1.6, filled=False)]
    if contours:
        layers.append(
            marks("line", "contours", named({name: style for name, (style, _) in contours.items()}, chosen=False))
        )
    x, y = across("x", "PGV / PGA  [s]", {"zero": True}), upwards("y", "PGA  [g]", {"zero": True})
    return figure(layers, 420, {"tests": tests, "contours": lines}, x, y)


def _curves(record: ValidationRecord, of: Callable[[Curves], T]) -> list[tuple[str, Look, T]]:
    """What was measured and each model by name: how its line is drawn, and its curve."""
    looks = {"measured": Look(INK, "", 3.0)} | _styles(record)
    return [(name, looks[name], of(item)) for name, item in {"measured": record.observed, **record.models}.items()]


def _fragility(record: ValidationRecord) -> Json | None:
    """The fitted curves, that of the measured tests with its band."""
    fitted = {
        name: (style, item) for name, style, item in _curves(record, lambda each: each.fragility_pgv)
        if item is not None and item.median is not None
    }  # fmt: skip
    if not fitted:
        return None
    drawn = named({name: style for name, (style, _) in fitted.items()}, chosen=False)
    parts = [{"name": name, "x": item.intensity, "y": item.probability} for name, (_, item) in fitted.items()]
    around = [
        {"name": name, "x": item.intensity, "low": item.low, "high": item.high}
        for name, (_, item) in fitted.items() if name == "measured"
    ]  # fmt: skip
    layers = [band("around", drawn, 0.1), marks("line", "curves", drawn)]
    y = upwards("y", "probability of overturning", {"domain": [0.0, 1.0]})
    return figure(layers, 380, {"curves": parts, "around": around}, across("x", "PGV  [m/s]", log(), tickCount=6), y)


def reliability_diagram(curves: Sequence[tuple[str, Look, Sequence[ReliabilityBin]]]) -> Json | None:
    """Of each name, look and bins: the share that fell over its bin's mean probability; true ones lie on the diagonal."""
    drawn = named({name: style for name, style, bins in curves if bins}, chosen=False)
    parts = [
        {
            "name": name, "x": [item.mean for item in bins], **columns_of([item.fell for item in bins]),
            "tip": [f"{name}, {item.cases} tests: said {item.mean:.2f}, fell {item.fell.value:.2f}" for item in bins],
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
        across("x", "probability of overturning", shown),
        upwards("y", "share that overturned", shown),
    )
