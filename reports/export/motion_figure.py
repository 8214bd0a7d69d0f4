"""A motion's picture: three histories, the response spectrum against its target, the Arias intensity's build-up."""

import textwrap
from collections.abc import Sequence
from typing import Final

from harness.input.motions.inspect import DAMPING, PERIODS_S, MotionInspection, in_g
from harness.input.motions.recordfile import displacement_m, velocity_m_s
from harness.input.motions.spectra import arias_share
from harness.model import printable
from reports.charts.figure import (
    LOOKING,
    MUTED,
    ZOOMED,
    Json,
    Look,
    across,
    axis,
    figure,
    level,
    log,
    marks,
    named,
    rows_of,
    span,
)
from reports.messages import ENGLISH

WIDE: Final = 1290
"""Width in pixels of the sheet."""
SHARE: Final = 0.6
"""Of the sheet's width for the histories."""
TICKS_S: Final = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0)
_COLOURS: Final = ("#0b3c5d", "#c8553d", "#5a8f5a", "#8a6d3b", "#6b5b95", "#444444")
_HEAD_ROOM: Final = 1.1
"""Of the spectrum's axis."""
_LEAST_G: Final = 1e-3
_ORIGIN_WIDTH: Final = 170


def motion_picture(inspection: MotionInspection) -> Json:
    """The picture of an inspection, a sheet wide."""
    title, origin = _title(inspection)
    charts = [histories_figure(inspection), spectrum_figure(inspection), build_up_figure(inspection)]
    data = {name: parts for chart in charts for name, parts in chart["datasets"].items()}
    left, *right = ({key: chart[key] for key in chart if key not in ("datasets", "params")} for chart in charts)
    alone = {"scale": dict.fromkeys(LOOKING, "independent")}
    beside = {"vconcat": [chart | {"width": 1.0 - SHARE} for chart in right], "resolve": alone}
    rows = [row | {"width": SHARE} for row in left["vconcat"]]
    return {
        "datasets": data, "params": [*ZOOMED], "hconcat": [left | {"vconcat": rows}, beside], "resolve": alone,
        "title": {"text": title, "subtitle": origin, "fontSize": 19, "subtitleFontSize": 14},
    }  # fmt: skip


def _title(inspection: MotionInspection) -> tuple[str, str]:
    """The title, and the line below it: event, station and format, or what was done."""
    facts = [inspection.source.get(key, "") for key in ("event", "station", "format")]
    said = [" ".join(part.split()) for part in facts if part]
    if not said:
        said = [ENGLISH.say(step) for step in inspection.traces[0].series.done[-2:]]
    return printable(inspection.title), textwrap.shorten(printable(" · ".join(said)), _ORIGIN_WIDTH, placeholder=" …")


def _looks(names: Sequence[str], width: float) -> dict[str, Look]:
    return {name: Look(_COLOURS[k % len(_COLOURS)], "", width) for k, name in enumerate(names)}


def histories_figure(inspection: MotionInspection) -> Json:
    """Acceleration, velocity and displacement of every trace, one below the other."""
    words = [
        f"{each.name}: PGA {each.measures.pga_g:.3f} g, PGV {each.measures.pgv_m_s:.3f} m/s"
        for each in inspection.traces
    ]
    parts = [
        {
            "name": name, "t": each.series.t_s, "accel": in_g(each.series.accel_m_s2), "velocity": velocity_m_s(each.series),
            "displacement": displacement_m(each.series),
        }
        for name, each in zip(words, inspection.traces, strict=True)
    ]  # fmt: skip
    end = max(float(each.series.t_s[-1]) for each in inspection.traces)
    kinds, looks = ("accel", "velocity", "displacement"), _looks(words, 1.3)
    axes = [{"y": axis(name, ENGLISH(f"chart.{name}"), tickCount=6)} for name in kinds]
    lines = [named(looks, legend=k == 0, chosen=False) for k in range(len(kinds))]
    rows = [([marks("line", "traces", y | drawn)], 205.0) for y, drawn in zip(axes, lines, strict=True)]
    return rows_of(rows, across("t", ENGLISH("chart.time"), {"domain": [0.0, end], "padding": 0}), {"traces": parts})


def spectrum_figure(inspection: MotionInspection) -> Json:
    """Pseudo-acceleration by period of every trace, and of the target with its band of ± 10 %."""
    target = inspection.target
    looks = _looks([each.name for each in inspection.traces], 1.6)
    parts: list[Json] = [
        {"name": each.name, "x": PERIODS_S, "y": in_g(each.spectrum_m_s2)} for each in inspection.traces
    ]
    most = max(_LEAST_G, *(float(part["y"].max()) for part in parts))
    data: dict[str, list[Json]] = {"spectra": parts}
    layers = []
    if target is not None:
        wanted = in_g(target.accel_m_s2(PERIODS_S))
        most = max(most, 1.1 * float(wanted.max()))
        looks = {target.name: Look("#000000", "6 4", 1.8)} | looks
        parts.append({"name": target.name, "x": PERIODS_S, "y": wanted})
        data["target"] = [{"x": PERIODS_S, "low": 0.9 * wanted, "high": 1.1 * wanted}]
        layers.append(marks("area", "target", span("low", "high"), color="#dddddd"))
    damping = DAMPING if target is None else target.damping
    periods = log(domain=[float(PERIODS_S[0]), float(PERIODS_S[-1])])
    x = across("x", ENGLISH("chart.period"), periods, values=TICKS_S, format="~g")
    y = axis("y", ENGLISH("chart.spectrum", damping=f"{damping:.0%}"), scale={"domain": [0.0, _HEAD_ROOM * most]})
    return figure([*layers, marks("line", "spectra", named(looks, chosen=False))], 330, data, x, y)


def build_up_figure(inspection: MotionInspection) -> Json:
    """How the Arias intensity of every trace builds up, in per cent."""
    end = max(float(each.series.t_s[-1]) for each in inspection.traces)
    parts: list[Json] = [
        {
            "name": ENGLISH(
                "chart.arias", name=each.name, arias=f"{each.measures.arias_m_s:.2f}",
                time=f"{each.measures.significant_5_95_s:.1f}",
            ),
            "t": each.series.t_s, "share": 100.0 * arias_share(each.series.accel_m_s2**2),
        }
        for each in inspection.traces if each.measures.arias_m_s > 0.0
    ]  # fmt: skip
    layers = [layer for at in (5.0, 95.0) for layer in level(at, line=Look(MUTED, "2 3", 1.0))]
    if parts:
        layers.insert(0, marks("line", "shares", named(_looks([part["name"] for part in parts], 1.6), chosen=False)))
    x = across("t", ENGLISH("chart.time"), {"domain": [0.0, end], "padding": 0})
    y = axis("share", ENGLISH("chart.arias_share"), scale={"domain": [0.0, 100.0]})
    return figure(layers, 170, {"shares": parts}, x, y)
