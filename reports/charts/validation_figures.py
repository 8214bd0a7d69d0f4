"""The charts of a validation: accuracy by model, every test in its plane of intensities, fragility."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final, TypeVar

from harness.records.sets import ReliabilityBin
from harness.records.validation import Curves, ValidationRecord
from harness.validation.scenes import GRAVITY_M_S2
from reports.charts import Json
from reports.charts.figure import axis, band, curve, figure, intervals
from reports.charts.palette import HAIRLINE, INK, look

T = TypeVar("T")
BASELINE: Final = "PGV threshold"
BASELINE_COLOUR: Final = "#8a6d00"
FELL: Final = "overturned"
DASHES: Final = ("solid", "dash", "dot", "dashdot", "longdash")


def charts(record: ValidationRecord) -> list[tuple[str, str, Json]]:
    """Accuracy by model, tests in PGA against PGV/PGA with contours, fragility curves, accuracy by intensity."""
    figures = [("accuracy", "Share of tests predicted right, with 95 % intervals", _accuracy(record))]
    figures.append(("plane", "Every test, and where half of them fall", _plane(record)))
    fragility = _fragility(record)
    if fragility["data"]:
        figures.append(("fragility", "Probability of overturning against PGV", fragility))
    diagram = reliability_diagram(
        [
            *((name, *_styles(record)[name], item.probability.reliability) for name, item in record.models.items()),
            (BASELINE, BASELINE_COLOUR, "dot", record.baseline.probability.reliability),
        ]
    )
    if record.samples and diagram["data"]:
        figures.append(("reliability", "Share that fell against the probability said, with 95 % intervals", diagram))
    return figures


def _styles(record: ValidationRecord) -> dict[str, tuple[str, str]]:
    return styles({name: item.engine for name, item in record.models.items()})


def styles(engine_of: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """Colour by engine; the settings of one engine differ by their dashes."""
    engines = list(engine_of.values())
    looks: dict[str, tuple[str, str]] = {}
    for index, (name, engine) in enumerate(engine_of.items()):
        own, earlier = look(engine, engines), engines[:index].count(engine)
        others = [dash for dash in DASHES if dash != own.dash]
        looks[name] = own.colour, own.dash if earlier == 0 else others[(earlier - 1) % len(others)]
    return looks


def _accuracy(record: ValidationRecord) -> Json:
    looks = _styles(record)
    rows = [(name, item.outcomes.accuracy) for name, item in record.models.items()]
    rows = [*rows, (BASELINE, record.baseline.outcomes.accuracy)]
    data = [
        curve(
            [100 * item.value], [name], {}, mode="markers", showlegend=False, error_x=intervals([item], 100.0, thickness=2),
            marker={"size": 11, "color": looks.get(name, (BASELINE_COLOUR, ""))[0]},
            hovertemplate=f"{name} %{{x:.0f}} %<extra></extra>",
        )
        for name, item in rows if item is not None
    ]  # fmt: skip
    y = {"autorange": "reversed", "automargin": True}
    return figure(data, 130 + 44 * len(rows), axis("right  [%]", range=[0, 102]), y, margin_top=14)


def _plane(record: ValidationRecord) -> Json:
    data: list[Json] = []
    for fell, words, symbol, colour in ((False, "stood", "circle-open", "#0072B2"), (True, "fell", "x", "#D55E00")):
        rows = [row for row in record.rows if row.observed.startswith(FELL) == fell and row.pga_g > 0.0]
        x, y = [row.pgv_m_s / (GRAVITY_M_S2 * row.pga_g) for row in rows], [row.pga_g for row in rows]
        marks = {
            "name": words,
            "marker": {"symbol": symbol, "size": 9, "color": colour},
            "text": [row.test for row in rows],
        }
        data.append(curve(x, y, {}, mode="markers", hovertemplate="%{text}: %{y:.3f} g<extra></extra>", **marks))
    for name, style, contour in _curves(record, lambda item: item.contour):
        if contour is not None:
            data.append(curve(contour.contour_50.ratio_s, contour.contour_50.pga_g, style, name=f"half fall: {name}"))
    return figure(data, 440, *(axis(title, rangemode="tozero") for title in ("PGV / PGA  [s]", "PGA  [g]")))


def _curves(record: ValidationRecord, of: Callable[[Curves], T]) -> list[tuple[str, Json, T]]:
    """What was measured and each model by name: how its line is drawn, and its curve."""
    styles = {"measured": {"color": INK, "dash": "solid", "width": 3}}
    styles |= {name: {"color": colour, "dash": dash, "width": 1.6} for name, (colour, dash) in _styles(record).items()}
    return [(name, styles[name], of(item)) for name, item in {"measured": record.observed, **record.models}.items()]


def _fragility(record: ValidationRecord) -> Json:
    data: list[Json] = []
    for name, style, fitted in _curves(record, lambda item: item.fragility_pgv):
        if fitted is None or fitted.median is None:
            continue
        x = fitted.intensity
        if name == "measured":
            data.append(band([*x, *reversed(x)], [*fitted.high, *reversed(fitted.low)], INK, 0.1))
        data.append(curve(x, fitted.probability, style, name=name))
    return figure(data, 400, axis("PGV  [m/s]", type="log"), axis("probability of overturning", range=[-0.02, 1.02]))


def reliability_diagram(curves: Sequence[tuple[str, str, str, Sequence[ReliabilityBin]]]) -> Json:
    """Of each name, colour, dash and bins: the share that fell over its bin's mean probability; true ones lie on the diagonal."""
    data = [
        curve(
            [item.mean for item in bins], [item.fell.value for item in bins], {"color": colour, "dash": dash}, name=name,
            mode="lines+markers", text=[f"{item.cases} tests" for item in bins],
            error_y=intervals([item.fell for item in bins]),
            hovertemplate=f"{name}, %{{text}}: said %{{x:.2f}}, fell %{{y:.2f}}<extra></extra>",
        )
        for name, colour, dash, bins in curves if bins
    ]  # fmt: skip
    if data:
        data.insert(0, curve([0, 1], [0, 1], {"color": HAIRLINE, "width": 2}, showlegend=False))
    titles = "probability of overturning", "share that overturned"
    return figure(data, 420, *(axis(title, range=[-0.02, 1.02]) for title in titles))
