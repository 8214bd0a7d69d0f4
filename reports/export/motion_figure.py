"""A motion's picture: three histories, the response spectrum against its target, the Arias intensity's build-up."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Final

import numpy as np

from harness.input.motions.inspect import DAMPING, PERIODS_S, Inspection, in_g
from harness.input.motions.measures import arias_share
from harness.input.motions.series import displacement_m, velocity_m_s
from reports.text.numbers import drawn_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS: Final = ("#0b3c5d", "#c8553d", "#5a8f5a", "#8a6d3b", "#6b5b95", "#444444")
_MOST_POINTS: Final = 4000
_BAND_COLOUR: Final = "#dddddd"
_HEAD_ROOM: Final = 1.22
"""Of the spectrum's axis, for its legend."""
_LEAST_G: Final = 1e-3
_ORIGIN_WIDTH: Final = 170


def figure(inspection: Inspection) -> Figure:
    """A matplotlib figure (11 × 7.5 inches) of an inspection; save it with `savefig` in any format."""
    from matplotlib.figure import Figure

    drawing = Figure(figsize=(11.0, 7.5))
    left = drawing.add_gridspec(3, 1, left=0.085, right=0.575, top=0.9, bottom=0.075, hspace=0.14)
    right = drawing.add_gridspec(
        2, 1, height_ratios=(1.8, 1.0), left=0.655, right=0.985, top=0.9, bottom=0.075, hspace=0.24
    )
    histories = [drawing.add_subplot(left[row, 0]) for row in range(3)]
    _histories(histories, inspection)
    drawing.align_ylabels(histories)
    _spectrum(drawing.add_subplot(right[0, 0]), inspection)
    _build_up(drawing.add_subplot(right[1, 0]), inspection)
    title, origin = _title(inspection)
    drawing.text(0.02, 0.965, drawn_text(title), fontsize=12, weight="bold")
    drawing.text(0.02, 0.93, drawn_text(origin), fontsize=9, color="#444444")
    return drawing


def _title(inspection: Inspection) -> tuple[str, str]:
    """The title, and the line below it: event, station and format, or what was done."""
    facts = [inspection.source.get(key, "") for key in ("event", "station", "format")]
    said = [" ".join(part.split()) for part in facts if part]
    if not said:
        said = list(inspection.traces[0].series.done[-2:])
    return inspection.title, textwrap.shorten(" · ".join(said), _ORIGIN_WIDTH, placeholder=" …")


def _histories(axes: list[Axes], inspection: Inspection) -> None:
    labels = ("acceleration (g)", "velocity (m/s)", "displacement (m)")
    for i, trace in enumerate(inspection.traces):
        series = trace.series
        kept = _outline(series.accel_m_s2)
        for axis, values in zip(
            axes, (in_g(series.accel_m_s2), velocity_m_s(series), displacement_m(series)), strict=True
        ):
            axis.plot(
                series.t_s[kept], values[kept], color=_COLOURS[i % len(_COLOURS)], lw=0.8, label=drawn_text(trace.name)
            )
    for axis, label in zip(axes, labels, strict=True):
        axis.set_ylabel(label)
        axis.axhline(0.0, color="#999999", lw=0.5, zorder=0)
        axis.margins(x=0.0)
        axis.grid(alpha=0.25)
    for axis in axes[:-1]:
        axis.tick_params(labelbottom=False)
    axes[-1].set_xlabel("time (s)")
    peaks = [f"{t.name}: PGA {t.measures.pga_g:.3f} g, PGV {t.measures.pgv_m_s:.3f} m/s" for t in inspection.traces]
    handles, _ = axes[0].get_legend_handles_labels()
    axes[0].legend(handles, peaks, fontsize=8, loc="upper right", framealpha=0.85)


def _outline(
    accel: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    """Samples that draw the same picture: all, or each bin's least and greatest, so that no peak is lost."""
    if accel.size <= _MOST_POINTS:
        return np.arange(accel.size)
    width = -(-2 * accel.size // _MOST_POINTS)
    whole = accel.size // width * width
    bins = accel[:whole].reshape(-1, width)
    start = np.arange(0, whole, width)
    ends = np.array([0, accel.size - 1])
    return np.unique(np.concatenate([start + bins.argmin(1), start + bins.argmax(1), ends]))


def _spectrum(axis: Axes, inspection: Inspection) -> None:
    target = inspection.target
    if target is not None:
        wanted = in_g(target.accel_m_s2(PERIODS_S))
        axis.fill_between(PERIODS_S, 0.9 * wanted, 1.1 * wanted, color=_BAND_COLOUR, label="target ± 10 %", zorder=1)
        axis.plot(PERIODS_S, wanted, color="black", lw=1.4, ls="--", label=drawn_text(target.name), zorder=3)
    for i, trace in enumerate(inspection.traces):
        axis.plot(
            PERIODS_S,
            in_g(trace.spectrum_m_s2),
            color=_COLOURS[i % len(_COLOURS)],
            lw=1.1,
            label=drawn_text(trace.name),
        )
    axis.set_xscale("log")
    axis.set_xlim(PERIODS_S[0], PERIODS_S[-1])
    axis.set_ylim(0.0, _HEAD_ROOM * max(float(axis.dataLim.y1), _LEAST_G))
    ticks = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0)
    axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.minorticks_off()
    damping = DAMPING if target is None else target.damping
    axis.set_xlabel("period (s)", labelpad=1.0)
    axis.set_ylabel(f"pseudo-acceleration (g), damping {damping:.0%}")
    axis.grid(alpha=0.25)
    axis.legend(fontsize=8, loc="upper right")


def _build_up(axis: Axes, inspection: Inspection) -> None:
    for i, trace in enumerate(inspection.traces):
        if trace.measures.arias_m_s == 0.0:
            continue
        share = 100.0 * arias_share(trace.series.accel_m_s2**2)
        kept = _outline(share)
        name, strong_s = drawn_text(trace.name), trace.measures.significant_5_95_s
        label = f"{name}: {trace.measures.arias_m_s:.2f} m/s, 5-95 % in {strong_s:.1f} s"
        axis.plot(trace.series.t_s[kept], share[kept], color=_COLOURS[i % len(_COLOURS)], lw=1.1, label=label)
    for level in (5.0, 95.0):
        axis.axhline(level, color="#999999", lw=0.6, ls=":")
    axis.set_xlabel("time (s)")
    axis.set_ylabel("Arias intensity (%)")
    axis.margins(x=0.0)
    axis.grid(alpha=0.25)
    if axis.lines[:-2]:
        axis.legend(fontsize=8, loc="lower right")
