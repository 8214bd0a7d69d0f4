"""The charts of a validation: accuracy by model, every test in its plane of intensities, fragility."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from harness.records.sets import ReliabilityBin
from harness.records.validation import ValidationRecord
from harness.validation.scenes import GRAVITY_M_S2
from reports.charts import Json
from reports.charts.palette import HAIRLINE, INK, faint, look

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
        {
            "type": "scatter", "mode": "markers", "x": [100 * item.value], "y": [name], "showlegend": False,
            "marker": {"size": 11, "color": looks.get(name, (BASELINE_COLOUR, ""))[0]},
            "error_x": {
                "type": "data", "symmetric": False, "array": [100 * (item.high - item.value)],
                "arrayminus": [100 * (item.value - item.low)], "thickness": 2,
            },
            "hovertemplate": f"{name} %{{x:.0f}} %<extra></extra>",
        }
        for name, item in rows if item is not None
    ]  # fmt: skip
    layout = {
        "height": 130 + 44 * len(rows), "xaxis": {"title": {"text": "right  [%]"}, "range": [0, 102], "gridcolor": HAIRLINE},
        "yaxis": {"autorange": "reversed", "automargin": True}, "margin_top": 14,
    }  # fmt: skip
    return {"data": data, "layout": layout}


def _plane(record: ValidationRecord) -> Json:
    data: list[Json] = []
    for fell, words, symbol, colour in ((False, "stood", "circle-open", "#0072B2"), (True, "fell", "x", "#D55E00")):
        rows = [row for row in record.rows if row.observed.startswith(FELL) == fell and row.pga_g > 0.0]
        data.append(
            {
                "type": "scatter", "mode": "markers", "name": words, "text": [row.test for row in rows],
                "x": [row.pgv_m_s / (GRAVITY_M_S2 * row.pga_g) for row in rows], "y": [row.pga_g for row in rows],
                "marker": {"symbol": symbol, "size": 9, "color": colour},
                "hovertemplate": "%{text}: %{y:.3f} g<extra></extra>",
            }
        )  # fmt: skip
    curves = [("measured", INK, "solid", record.observed.contour)]
    curves += [(name, *_styles(record)[name], item.contour) for name, item in record.models.items()]
    for name, colour, dash, contour in curves:
        if contour is not None:
            line = contour.contour_50
            data.append(
                {
                    "type": "scatter", "mode": "lines", "name": f"half fall: {name}", "x": line.ratio_s, "y": line.pga_g,
                    "line": {"color": colour, "dash": dash, "width": 3 if name == "measured" else 1.6},
                }
            )  # fmt: skip
    layout = {
        "height": 440, "xaxis": {"title": {"text": "PGV / PGA  [s]"}, "gridcolor": HAIRLINE, "rangemode": "tozero"},
        "yaxis": {"title": {"text": "PGA  [g]"}, "gridcolor": HAIRLINE, "rangemode": "tozero"},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom"},
    }  # fmt: skip
    return {"data": data, "layout": layout}


def _fragility(record: ValidationRecord) -> Json:
    curves = [("measured", INK, "solid", record.observed.fragility_pgv)]
    curves += [(name, *_styles(record)[name], item.fragility_pgv) for name, item in record.models.items()]
    data: list[Json] = []
    for name, colour, dash, curve in curves:
        if curve is None or curve.median is None:
            continue
        x = curve.intensity
        if name == "measured":
            data.append(
                {
                    "type": "scatter", "x": [*x, *reversed(x)], "y": [*curve.high, *reversed(curve.low)],
                    "fill": "toself", "fillcolor": faint(colour, 0.1), "line": {"width": 0}, "hoverinfo": "skip",
                    "showlegend": False,
                }
            )  # fmt: skip
        style = {"color": colour, "dash": dash, "width": 3 if name == "measured" else 1.6}
        data.append({"type": "scatter", "mode": "lines", "name": name, "x": x, "y": curve.probability, "line": style})
    layout = {
        "height": 400, "xaxis": {"title": {"text": "PGV  [m/s]"}, "type": "log", "gridcolor": HAIRLINE},
        "yaxis": {"title": {"text": "probability of overturning"}, "range": [-0.02, 1.02], "gridcolor": HAIRLINE},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom"},
    }  # fmt: skip
    return {"data": data, "layout": layout}


def reliability_diagram(curves: Sequence[tuple[str, str, str, Sequence[ReliabilityBin]]]) -> Json:
    """Of each name, colour, dash and bins: the share that fell over its bin's mean probability; true ones lie on the diagonal."""
    data: list[Json] = [
        {
            "type": "scatter", "mode": "lines+markers", "name": name, "x": [item.mean for item in bins],
            "y": [item.fell.value for item in bins], "line": {"color": colour, "dash": dash},
            "text": [f"{item.cases} tests" for item in bins],
            "error_y": {
                "type": "data", "symmetric": False, "array": [item.fell.high - item.fell.value for item in bins],
                "arrayminus": [item.fell.value - item.fell.low for item in bins],
            },
            "hovertemplate": f"{name}, %{{text}}: said %{{x:.2f}}, fell %{{y:.2f}}<extra></extra>",
        }
        for name, colour, dash, bins in curves if bins
    ]  # fmt: skip
    if data:
        line = {"color": HAIRLINE, "width": 2}
        data.insert(
            0, {"type": "scatter", "mode": "lines", "x": [0, 1], "y": [0, 1], "line": line, "showlegend": False}
        )
    layout = {
        "height": 420, "xaxis": {"title": {"text": "probability of overturning"}, "range": [-0.02, 1.02], "gridcolor": HAIRLINE},
        "yaxis": {"title": {"text": "share that overturned"}, "range": [-0.02, 1.02], "gridcolor": HAIRLINE},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom"},
    }  # fmt: skip
    return {"data": data, "layout": layout}
