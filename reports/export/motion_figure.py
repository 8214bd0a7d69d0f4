"""A motion's picture: three histories, the response spectrum against its target, the Arias intensity's build-up."""

from __future__ import annotations

import textwrap
from typing import Any, Final

import numpy as np

from harness.input.motions.inspect import DAMPING, PERIODS_S, Inspection, in_g
from harness.input.motions.measures import arias_share
from harness.input.motions.series import displacement_m, velocity_m_s
from harness.model.terminal import printable
from reports.charts import Json
from reports.charts.figure import axis, curve, figure
from reports.charts.palette import MUTED
from reports.charts.samples import shown_samples
from reports.charts.static_svg import picture
from reports.drawing.shapes import Picture, Shape, Text, moved
from reports.messages import ENGLISH

ACROSS: Final = (770, 517)
"""Width in pixels of the histories, and of the charts beside them."""
HEADS_PX: Final = 64
HEIGHTS: Final = (800, 480, 320)
"""Height in pixels of the histories, the spectrum, the build-up."""
TICKS_S: Final = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0)
_COLOURS: Final = ("#0b3c5d", "#c8553d", "#5a8f5a", "#8a6d3b", "#6b5b95", "#444444")
_MOST_POINTS: Final = 4000
_BAND_COLOUR: Final = "#dddddd"
_HEAD_ROOM: Final = 1.1
"""Of the spectrum's axis."""
_LEAST_G: Final = 1e-3
_ORIGIN_WIDTH: Final = 170


def motion_picture(inspection: Inspection) -> Picture:
    """The picture of an inspection, a sheet wide."""
    title, origin = _title(inspection)
    shapes: list[Shape] = [
        Text(26.0, 28.0, title, "start", size_px=19.0),
        Text(26.0, 50.0, origin, "start", MUTED, 14.0),
    ]
    top = float(HEADS_PX)
    for chart, across, left in (
        (histories_figure(inspection), ACROSS[0], 0.0),
        (spectrum_figure(inspection), ACROSS[1], ACROSS[0]),
        (build_up_figure(inspection), ACROSS[1], ACROSS[0]),
    ):
        drawn = picture(chart, across, _MOST_POINTS)
        shapes += moved(drawn.shapes, left, top)
        top = top + drawn.height if left else HEADS_PX
    return Picture(sum(ACROSS), HEADS_PX + HEIGHTS[0], shapes)


def _title(inspection: Inspection) -> tuple[str, str]:
    """The title, and the line below it: event, station and format, or what was done."""
    facts = [inspection.source.get(key, "") for key in ("event", "station", "format")]
    said = [" ".join(part.split()) for part in facts if part]
    if not said:
        said = [ENGLISH.say(step) for step in inspection.traces[0].series.done[-2:]]
    return printable(inspection.title), textwrap.shorten(printable(" · ".join(said)), _ORIGIN_WIDTH, placeholder=" …")


def _trace(x: Any, y: Any, colour: str, name: str = "", **more: Any) -> Json:
    """One curve; of more points than are drawn those that keep its peaks."""
    samples = shown_samples(np.asarray(y), _MOST_POINTS)
    style = {"color": colour, "width": more.pop("width", 1.3), "dash": more.pop("dash", "solid")}
    return curve(np.asarray(x)[samples], np.asarray(y)[samples], style, name=name, **more)


def histories_figure(inspection: Inspection) -> Json:
    """Acceleration, velocity and displacement of every trace, one below the other."""
    data: list[Json] = []
    for i, trace in enumerate(inspection.traces):
        series, measures, colour = trace.series, trace.measures, _COLOURS[i % len(_COLOURS)]
        words = f"{trace.name}: PGA {measures.pga_g:.3f} g, PGV {measures.pgv_m_s:.3f} m/s"
        data += [
            _trace(series.t_s, in_g(series.accel_m_s2), colour, words, yaxis="y"),
            _trace(series.t_s, velocity_m_s(series), colour, yaxis="y2"),
            _trace(series.t_s, displacement_m(series), colour, yaxis="y3"),
        ]
    end = max(float(trace.series.t_s[-1]) for trace in inspection.traces)
    rows = {"yaxis": "acceleration (g)", "yaxis2": "velocity (m/s)", "yaxis3": "displacement (m)"}
    layout = {
        name: axis(words, domain=[0.68 - 0.34 * row, 1.0 - 0.34 * row], nticks=6)
        for row, (name, words) in enumerate(rows.items())
    }
    x, still = axis("time (s)", range=[0.0, end]), {"top": 54.0}
    return figure(data, HEIGHTS[0], x, layout.pop("yaxis"), showlegend=True, still=still, **layout)


def spectrum_figure(inspection: Inspection) -> Json:
    """Pseudo-acceleration by period of every trace, and of the target with its band of ± 10 %."""
    target, data = inspection.target, []
    most = max([_LEAST_G, *(float(in_g(trace.spectrum_m_s2).max()) for trace in inspection.traces)])
    if target is not None:
        wanted = in_g(target.accel_m_s2(PERIODS_S))
        most = max(most, 1.1 * float(wanted.max()))
        around = np.concatenate([PERIODS_S, PERIODS_S[::-1]]), np.concatenate([0.9 * wanted, 1.1 * wanted[::-1]])
        band = _trace(*around, _BAND_COLOUR, "target ± 10 %", fill="toself", fillcolor=_BAND_COLOUR, width=8)
        data = [band, _trace(PERIODS_S, wanted, "#000000", target.name, dash="dash", width=1.8)]
    data += [
        _trace(PERIODS_S, in_g(trace.spectrum_m_s2), _COLOURS[i % len(_COLOURS)], trace.name, width=1.6)
        for i, trace in enumerate(inspection.traces)
    ]
    damping = DAMPING if target is None else target.damping
    ends, names = np.log10(PERIODS_S[[0, -1]]).tolist(), [f"{tick:g}" for tick in TICKS_S]
    x = axis("period (s)", type="log", range=ends, tickvals=TICKS_S, ticktext=names)
    y = axis(f"pseudo-acceleration (g), damping {damping:.0%}", range=[0.0, _HEAD_ROOM * most])
    return figure(data, HEIGHTS[1], x, y, showlegend=True, still={"top": 54.0})


def build_up_figure(inspection: Inspection) -> Json:
    """How the Arias intensity of every trace builds up, in per cent."""
    data, end = [], max(float(trace.series.t_s[-1]) for trace in inspection.traces)
    for i, trace in enumerate(inspection.traces):
        if trace.measures.arias_m_s > 0.0:
            share = 100.0 * arias_share(trace.series.accel_m_s2**2)
            strong_s = trace.measures.significant_5_95_s
            words = f"{trace.name}: {trace.measures.arias_m_s:.2f} m/s, 5-95 % in {strong_s:.1f} s"
            data.append(_trace(trace.series.t_s, share, _COLOURS[i % len(_COLOURS)], words, width=1.6))
    data += [_trace([0.0, end], [level, level], "#999999", dash="dot", showlegend=False) for level in (5.0, 95.0)]
    x, y = axis("time (s)", range=[0.0, end]), axis("Arias intensity (%)", range=[0.0, 100.0], nticks=5)
    return figure(data, HEIGHTS[2], x, y, showlegend=True, still={"top": 24.0 + 15.0 * len(data[:-2])})
