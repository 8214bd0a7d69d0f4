"""The zoomable histories of all models on one time axis: rotation, motion patterns, pedestal slip, floor motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice, pairwise
from typing import Any, Final

import numpy as np

from harness.model.history import History
from harness.model.run import PATTERN_NAMES, EngineRunRecord
from harness.records.scene import MotionRecord, SceneRecord
from reports.charts import Json
from reports.charts.figure import ABOVE, axis, band, curve, level, note, stroke
from reports.charts.palette import INK, MUTED, PATTERN_LOOKS, look
from reports.charts.samples import Array, packed_array, shown_samples
from reports.source import RunSource, run_event_s
from reports.text.wording import horizon_s, prediction_s

BAND_SAMPLES: Final = 3000
ACROSS: Final = "out_of_plane_rad"
ACROSS_RAD: Final = 1e-4
"""A 3D engine's rotation across the rocking plane below this does not show beside the rotation in it."""
GAP: Final = 0.055
BARE_PATTERNS: Final[Mapping[str, str]] = {"rest": "at rest", "rocking": "rocking"}
"""Motion patterns of a statue without a pedestal."""
MOST_STRETCHES: Final = 1500
"""Most stretches of motion pattern drawn per model; shorter ones than a pixel are drawn as their longest neighbour."""
AXIS_COLOURS: Final = {"x": INK, "y": "#AA4499", "z": "#3A8FC7"}


def histories_figure(source: RunSource) -> Json:
    """The figure as plotly's plain JSON; every curve is a record's history, peaks kept."""
    rows = _rows(source)
    axes, domains = _axes(rows)
    data: list[Json] = []
    names = list(source.histories)
    for name, history in source.histories.items():
        data += _rotation(source, name, history, names, axes["rotation"])
    if "slip" in rows:
        data += [
            _lower(name, history, 1000.0 * history.slip_m, "slip %{y:.3f} mm", names, axes["slip"])
            for name, history in source.histories.items()
        ]
    if "across" in rows:
        data += [
            _lower(name, history, history.extra[ACROSS], "out of plane %{y:.4f} rad", names, axes["across"])
            for name, history in source.histories.items()
            if ACROSS in history.extra
        ]
    if "strip" in rows:
        data += pattern_strip(source, axes["strip"])
    if "floor" in rows:
        data += _floor(source.record.motion, source.scene.gravity_m_s2, axes["floor"])
    layout = _layout(source, rows, axes, domains)
    return {"data": data, "layout": layout, "views": _views(source)}


def _rows(source: RunSource) -> dict[str, float]:
    rows = {"rotation": 5.0}
    with_patterns = [run for run in source.runs.values() if run.patterns]
    if with_patterns:
        rows["strip"] = 0.55 * len(with_patterns)
    if source.scene.pedestal is not None:
        rows["slip"] = 2.2
    if any(_leaves_the_plane(history) for history in source.histories.values()):
        rows["across"] = 1.8
    if source.record.motion.accel_m_s2:
        rows["floor"] = 1.7
    return rows


def _leaves_the_plane(history: History) -> bool:
    return ACROSS in history.extra and float(np.abs(history.extra[ACROSS]).max()) > ACROSS_RAD


def _axes(rows: Mapping[str, float]) -> tuple[dict[str, str], dict[str, tuple[float, float]]]:
    free = 1.0 - GAP * (len(rows) - 1)
    total = sum(rows.values())
    axes, domains, top = {}, {}, 1.0
    for number, (row, weight) in enumerate(rows.items(), start=1):
        bottom = max(0.0, top - free * weight / total)
        axes[row] = "y" if number == 1 else f"y{number}"
        domains[row] = (round(bottom, 4), round(top, 4))
        top = bottom - GAP
    return axes, domains


def _line(history: History, values: Any, most: int | None = None) -> tuple[Json, Json]:
    shown = shown_samples(values) if most is None else shown_samples(values, most)
    return packed_array(history.t_s[shown]), packed_array(values[shown])


def _rotation(source: RunSource, name: str, history: History, names: list[str], axis: str) -> list[Json]:
    style = look(name, names)
    t_s, theta = _line(history, history.theta_rad)
    traces: list[Json] = []
    around = _band(source.runs[name], history)
    if around is not None:
        traces.append(band(*around, style.colour, 0.18, yaxis=axis, legendgroup=name))
    tip = f"{name} θ %{{y:.5f}} rad<extra></extra>"
    traces.append(curve(t_s, theta, stroke(style), yaxis=axis, name=name, legendgroup=name, hovertemplate=tip))
    run = source.runs[name]
    if run.outcome.overturned and run.no_return_time_s is not None:
        at = run.no_return_time_s
        theta_rad = float(np.interp(at, history.t_s, history.theta_rad))
        mark = {"mode": "markers", "marker": {"symbol": "x", "size": 10, "color": style.colour}, "showlegend": False}
        tip = f"{name} passes its balance point<extra></extra>"
        traces.append(curve([at], [theta_rad], {}, yaxis=axis, legendgroup=name, hovertemplate=tip, **mark))
    return traces


def _band(run: EngineRunRecord, history: History) -> tuple[Json, Json] | None:
    size = run.numerical_uncertainty_rad
    if not size or run.reliable_until_s is None:
        return None
    within = history.t_s <= run.reliable_until_s
    if np.count_nonzero(within) < 2:
        return None
    t_s, theta = history.t_s[within], history.theta_rad[within]
    shown = shown_samples(theta, BAND_SAMPLES)
    t_s, theta = t_s[shown], theta[shown]
    around = np.concatenate([theta + size, (theta - size)[::-1]])
    return packed_array(np.concatenate([t_s, t_s[::-1]])), packed_array(around)


def _lower(name: str, history: History, values: Array, words: str, names: list[str], axis: str) -> Json:
    """One model's curve in a row under the rotation."""
    style = look(name, names)
    t_s, drawn = _line(history, values)
    return curve(
        t_s, drawn, stroke(style), yaxis=axis, name=name, legendgroup=name, showlegend=False,
        hovertemplate=f"{name} {words}<extra></extra>",
    )  # fmt: skip


def _floor(motion: MotionRecord, gravity_m_s2: float, axis: str) -> list[Json]:
    t_s = packed_array(motion.t_s)
    return [
        curve(
            t_s, packed_array(np.asarray(accel) / gravity_m_s2), {"color": AXIS_COLOURS[name], "width": 1.0}, yaxis=axis,
            name=f"floor {name}", legend="legend3", hovertemplate=f"floor {name} %{{y:.3f}} g<extra></extra>",
        )
        for name, accel in motion.accel_m_s2.items()
    ]  # fmt: skip


def _views(source: RunSource) -> Json:
    """The two vertical views of the rotation: near the balance points, and whole."""
    statue = source.scene.statue
    low, high = -statue.slenderness_left_rad, statue.slenderness_right_rad
    least = min((float(item.theta_rad.min()) for item in source.histories.values()), default=0.0)
    most = max((float(item.theta_rad.max()) for item in source.histories.values()), default=0.0)
    whole = _padded(min(least, 0.0), max(most, 0.0))
    near = [max(min(least, 0.0), 1.35 * low), min(max(most, 0.0), 1.35 * high)]
    # Let go beyond its balance points, a body that falls never comes near them.
    seen = any(np.any((item.theta_rad >= near[0]) & (item.theta_rad <= near[1])) for item in source.histories.values())
    near = _padded(*near) if seen else whole
    return {"whole": whole, "near": near, "duration_s": source.scene.duration_s, "event_s": list(run_event_s(source))}


def _padded(low: float, high: float) -> list[float]:
    margin = 0.08 * (high - low) or 0.01
    return [low - margin, high + margin]


def _layout(
    source: RunSource, rows: Mapping[str, float], axes: Mapping[str, str], domains: Mapping[str, tuple[float, float]]
) -> Json:
    lowest, views = list(axes.values())[-1], _views(source)
    titles = {
        "rotation": "rotation θ  [rad]",
        "strip": "",
        "slip": "slip u  [mm]",
        "across": "across  [rad]",
        "floor": "floor  [g]",
    }
    layout: Json = {
        "xaxis": axis(
            "time  [s]", anchor=lowest, range=views["event_s"], zeroline=False, showspikes=True, spikemode="across",
            spikethickness=1, spikecolor=MUTED, spikedash="dot", hoverformat=".4f", ticksuffix="",
        ),
        "hovermode": "x unified", "hoversubplots": "axis", "barmode": "overlay", "bargap": 0.1,
        "legend": ABOVE | {"x": 0, "xanchor": "left"},
        **_marks(source, axes["rotation"]),
        "height": 320 + 90 * len(rows) + 22 * len(source.runs),
    }  # fmt: skip
    for row, name in axes.items():
        layout[name.replace("y", "yaxis")] = axis(
            titles[row], domain=list(domains[row]), automargin=True, zerolinecolor=MUTED, zerolinewidth=1, fixedrange=True,
            nticks=7 if row == "rotation" else 4,
        )  # fmt: skip
    layout["yaxis"]["range"] = views["near"]
    if "strip" in axes:
        layout[axes["strip"].replace("y", "yaxis")] |= {"autorange": "reversed", "showgrid": False, "zeroline": False}
    if "floor" in axes:
        layout["legend3"] = ABOVE | {"x": 1, "xanchor": "right", "y": domains["floor"][1], "font": {"size": 11}}
    return layout


def _marks(source: RunSource, axis_name: str) -> Json:
    """The balance points, the end of bounded errors and the horizon of prediction: lines, a grey area, and their words."""
    statue, end = source.scene.statue, source.scene.duration_s
    sides = ((statue.slenderness_right_rad, "right", "bottom"), (-statue.slenderness_left_rad, "left", "top"))
    dashed, under = {"color": MUTED, "width": 1, "dash": "dash"}, {"layer": "below"}
    shapes = [level(at, dashed, yref=axis_name, **under) for at, _, _ in sides]
    notes = [
        note(1, at, f"balances on the {side} edge", xref="paper", xanchor="right", yref=axis_name, yanchor=anchor)
        for at, side, anchor in sides
    ]
    place = {"xref": "x", "xanchor": "left", "yref": f"{axis_name} domain"}
    until, horizon = horizon_s(source), prediction_s(source)
    if until is not None and until < end:
        grey = {"fillcolor": "#7a8696", "opacity": 0.11, "line": {"width": 0}}
        shapes.append(
            {"type": "rect", "xref": "x", "x0": until, "x1": end, "yref": "paper", "y0": 0, "y1": 1, **grey, **under}
        )
        notes.append(note(until, 0, f" error bounded until {until:.3g} s", yanchor="bottom", **place))
    if horizon is not None and horizon < end:
        at = {"xref": "x", "x0": horizon, "x1": horizon, "yref": f"{axis_name} domain", "y0": 0, "y1": 1}
        shapes.append({"type": "line", **at, "line": dashed | {"dash": "dot"}, **under})
        notes.append(note(horizon, 0, f" horizon of prediction {horizon:.3g} s", yanchor="top", **place))
    return {"shapes": shapes, "annotations": notes}


def pattern_words(scene: SceneRecord) -> Mapping[str, str]:
    """The motion patterns in words, those of a statue without a pedestal as they are then."""
    return PATTERN_NAMES if scene.pedestal is not None else {**PATTERN_NAMES, **BARE_PATTERNS}


def pattern_strip(source: RunSource, axis: str) -> list[Json]:
    traces: list[Json] = []
    shown = {name: drawn_stretches(run.patterns) for name, run in source.runs.items() if run.patterns}
    for pattern, words in pattern_words(source.scene).items():
        rows = [(name, start, end) for name, all_ in shown.items() for start, end, which in all_ if which == pattern]
        if not rows:
            continue
        colour, hatch = PATTERN_LOOKS[pattern]
        traces.append(
            {
                "type": "bar", "orientation": "h", "yaxis": axis, "name": words, "showlegend": False, "hoverinfo": "skip",
                "y": [row[0] for row in rows], "base": [row[1] for row in rows], "x": [row[2] - row[1] for row in rows],
                "width": 0.72, "offset": -0.36,
                "marker": {
                    "color": colour, "line": {"width": 0},
                    "pattern": {"shape": hatch, "size": 6, "solidity": 0.3, "fgcolor": "#ffffff", "fillmode": "overlay"},
                },
            }
        )  # fmt: skip
    return traces


def drawn_stretches(patterns: Sequence[Sequence[Any]], most: int = MOST_STRETCHES) -> list[tuple[float, float, str]]:
    """At most `most` stretches covering the same time: where there are more, each bin takes its longest pattern."""
    stretches = [(float(start), float(end), str(name)) for start, end, name in patterns]
    if len(stretches) <= most:
        return stretches
    edges = np.linspace(stretches[0][0], stretches[-1][1], most + 1).tolist()
    drawn: list[tuple[float, float, str]] = []
    first = 0
    for low, high in pairwise(edges):
        while stretches[first][1] <= low and first + 1 < len(stretches):
            first += 1
        shares: dict[str, float] = {}
        for start, end, name in islice(stretches, first, None):
            if start >= high:
                break
            shares[name] = shares.get(name, 0.0) + min(end, high) - max(start, low)
        longest = max(shares, key=lambda name: shares[name])
        if drawn and drawn[-1][2] == longest:
            drawn[-1] = (drawn[-1][0], high, longest)
        else:
            drawn.append((low, high, longest))
    return drawn
