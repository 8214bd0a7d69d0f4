"""The zoomable histories of all models on one time axis: rotation, motion patterns, pedestal slip, floor motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice, pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.model.history import History
from harness.model.run import Run
from reports.charts import Json
from reports.charts.figure import (
    CHOSEN,
    INK,
    LOOKING,
    MUTED,
    PATTERN_FILLS,
    ZOOMED,
    Look,
    across,
    axis,
    kinds,
    level,
    look,
    marks,
    named,
    names,
    span,
)
from reports.messages import ENGLISH, Language
from reports.source import RunSource, run_event_s
from reports.text.wording import horizon_s, prediction_s

# Samples as a page carries them: fewer for the screen with every peak kept, packed as differences of
# multiples of a step.


Array = NDArray[np.float64]

DISPLAYED_SAMPLES: Final = 12_000
"""Most samples of one curve on a page: a 10 s history at 1 ms stays whole, and four curves stay under 0.5 MB."""

LEVELS: Final = 2**18
"""Steps over an array's range: a value on a page is at most a 500 000th of the range beside the record's."""
ON_CLOCK: Final = 1e-3
"""Samples this near to multiples of their spacing, as a share of it, are taken as such: times cost nothing then."""


def shown_samples(values: Array, most: int = DISPLAYED_SAMPLES) -> NDArray[np.intp]:
    """Indices of the samples to draw, increasing: all, or first, least, largest and last of every bin.

    At most `most` (≥ 8) are kept; the extremes of `values` and both its ends are always among them.
    """
    count = len(values)
    if count <= most:
        return np.arange(count)
    edges = np.linspace(0, count, most // 4 + 1).astype(np.intp)
    starts, ends = edges[:-1], edges[1:]
    chosen = [starts, ends - 1]
    width = int((ends - starts).max())
    padded = starts[:, None] + np.minimum(np.arange(width), (ends - starts)[:, None] - 1)
    block = values[padded]
    chosen += [starts + np.argmin(block, axis=1), starts + np.argmax(block, axis=1)]
    return np.unique(np.concatenate(chosen))


def shown_together(curves: Sequence[Array], most: int = DISPLAYED_SAMPLES) -> NDArray[np.intp]:
    """Indices of the samples to draw of curves over one axis: at most so many of each, its extremes among them."""
    return np.unique(np.concatenate([shown_samples(each, most) for each in curves]))


def packed_array(values: ArrayLike, levels: int = LEVELS) -> Json:
    """Finite values (n,) or, flattened, (n, k) as `{step, order, deltas}`: `deltas` summed `order` times, times `step`.

    Whole numbers, and times on a clock, come back as they are.
    """
    array = np.asarray(values).ravel()
    step = 1.0 if array.dtype.kind in "iu" else _step(array.astype(np.float64), levels)
    steps = np.round(array / step).astype(np.int64)
    first = np.diff(steps, prepend=0)
    second = np.diff(first, prepend=0)
    order, deltas = min((1, first), (2, second), key=lambda choice: int(np.abs(choice[1]).sum()))
    return {"step": step, "order": order, "deltas": deltas.tolist()}


def _step(array: Any, levels: int) -> float:
    """The spacing of samples on a clock, for others the range over `levels`."""
    apart = np.diff(array)
    spacing = float(np.median(apart)) if len(apart) else 0.0
    # Beside a value that dwarfs it a spacing counts nothing: whole numbers end at 2^53.
    if 0.0 < np.abs(array).max(initial=0.0) < 2.0**53 * spacing:
        # A clock's spacing has few digits; a median of differences carries their rounding.
        spacing = float(f"{spacing:.9g}")
        if np.abs(array / spacing - np.round(array / spacing)).max() < ON_CLOCK:
            return spacing
    if len(array) < 2 or np.ptp(array) == 0.0:
        return _alone(array)
    # Values that differ by their rounding alone: a finer step than that has no whole number of steps.
    return max(float(np.ptp(array)) / levels, float(np.spacing(np.abs(array).max())))


def _alone(array: Any) -> float:
    """A step of which one value, or the same again and again, is a multiple."""
    return float(abs(array[0])) if len(array) and array[0] else 1.0


def numbers(values: Any) -> Any:
    """The values of a trace: packed arrays unpacked (n,), lists as they are."""
    if not isinstance(values, Mapping):
        return values
    steps = np.asarray(values["deltas"], dtype=np.int64)
    for _ in range(values["order"]):
        steps = np.cumsum(steps)
    return steps * values["step"]


ACROSS: Final = "out_of_plane_rad"
ACROSS_RAD: Final = 1e-4
"""A 3D engine's rotation across the rocking plane below this does not show beside the rotation in it."""
MOST_STRETCHES: Final = 1500
"""Most stretches of motion pattern drawn per model; shorter ones than a pixel are drawn as their longest neighbour."""
AXIS_LOOKS: Final = {
    "x": Look(INK, "", 1.0),
    "y": Look("#AA4499", "", 1.0),
    "z": Look("#3A8FC7", "", 1.0),
}


Row = tuple[Json, Json | None]
"""A row of the chart, and what a pointer over it is told."""


def histories_figure(source: RunSource, say: Language = ENGLISH) -> Json:
    """The chart: rows over one axis of time; every curve is a record's history, peaks kept."""
    order, views, motion = list(source.histories), _views(source), source.record.motion
    looks = {name: look(name, order) for name in order}
    t_s, gravity = np.asarray(motion.t_s), source.scene.gravity_m_s2
    data: dict[str, list[Json]] = {
        "histories": [_columns(source, name) for name in order],
        "falls": [_fall(source, name) for name in order if _falls(source.runs[name])],
        "patterns": pattern_strip(source, say),
        "floor": [
            {"name": say("chart.floor_axis", axis=axis), "t": t_s, "accel": np.asarray(accel) / gravity}
            for axis, accel in motion.accel_m_s2.items()
        ],
    }
    rows: list[Row] = [(_rotation(source, looks, views, say), _read("histories", "theta", "θ", "rad", 5))]
    if data["patterns"]:
        rows.append((_strip(data["patterns"], say), None))
    curves = named(looks, legend=False)
    if source.scene.pedestal is not None:
        rows.append(_below(say("chart.slip_u"), 130, curves, _read("histories", "slip", say("word.slip"), "mm", 3)))
    if any("across" in columns for columns in data["histories"]):
        rows.append(
            _below(say("chart.across"), 110, curves, _read("histories", "across", say("chart.out_of_plane"), "rad", 4))
        )
    if data["floor"]:
        shown = {part["name"]: AXIS_LOOKS[axis] for part, axis in zip(data["floor"], motion.accel_m_s2, strict=True)}
        title = f"{say('chart.floor') if len(shown) > 1 else next(iter(shown))}  [g]"
        drawn = named(shown, len(shown) > 1, chosen=False)
        rows.append(_below(title, 100, drawn, _read("floor", "accel", "", "g", 3)))
    for row, _ in rows:
        last = row is rows[-1][0]
        x = across(
            "t", say("chart.time") if last else "", {"domain": views["event_s"], "padding": 0}, labels=last, ticks=last
        )
        row |= {"encoding": {"x": x}, "layer": [*_doubt(source), *row["layer"]]}
    return {
        "datasets": data, "params": [*ZOOMED], "vconcat": [row for row, _ in rows], "spacing": 12,
        "resolve": {"scale": dict.fromkeys(LOOKING, "independent") | {"x": "shared"}},
        "usermeta": {"views": views, "read": [told for _, told in rows]},
    }  # fmt: skip


def _read(data: str, column: str, words: str, unit: str, decimals: int) -> Json:
    """What a pointer over a row is told at its time."""
    return {"data": data, "of": column, "words": words, "unit": unit, "decimals": decimals}


def _below(title: str, height: float, drawn: Json, told: Json) -> Row:
    """A row of curves under the rotation."""
    return _row([marks("line", told["data"], {"y": axis(told["of"], title, tickCount=4)} | drawn)], height), told


def _columns(source: RunSource, name: str) -> Json:
    """What is drawn of a model's history, and how far its error is stated."""
    history, run = source.histories[name], source.runs[name]
    columns: Json = {"t": history.t_s, "theta": history.theta_rad}
    if source.scene.pedestal is not None:
        columns["slip"] = 1000.0 * history.slip_m
    if _leaves_the_plane(history):
        columns["across"] = history.extra[ACROSS]
    size, until = run.numerical_uncertainty_rad, run.reliable_until_s
    return columns | {"name": name, "size": size or 0.0, "until": until if size and until is not None else -1.0}


def _leaves_the_plane(history: History) -> bool:
    return ACROSS in history.extra and float(np.abs(history.extra[ACROSS]).max()) > ACROSS_RAD


def _falls(run: Run) -> bool:
    return run.outcome.overturned and run.no_return_time_s is not None


def _fall(source: RunSource, name: str) -> Json:
    """Where a model passes its balance point for good."""
    history, at = source.histories[name], source.runs[name].no_return_time_s
    return {"name": name, "t": [at], "theta": [float(np.interp(at or 0.0, history.t_s, history.theta_rad))]}


def _row(layers: Sequence[Json], height: float) -> Json:
    return {"layer": list(layers), "height": height, "width": 1}


def _rotation(source: RunSource, looks: Mapping[str, Look], views: Json, say: Language) -> Json:
    """The rotations with their numerical errors, the balance points and the horizon of prediction."""
    statue = source.scene.statue
    whole = {"zero": False, "nice": False, "domain": views["near"]}
    y = axis("theta", say("chart.theta"), "Y", whole, tickCount=7)
    error = (
        {"filter": "datum.t <= datum.until"},
        *({"calculate": f"datum.theta {sign} datum.size", "as": name} for sign, name in (("-", "low"), ("+", "high"))),
    )
    around = {"fill": named(looks)["color"]}
    band = marks("area", "histories", {"y": y | {"field": "low"}, "y2": {"field": "high"}} | around, fillOpacity=0.18)
    crosses = {"y": y, **around}
    layers = [
        band | {"transform": list(error)},
        marks("line", "histories", {"y": y} | named(looks)) | {"params": [CHOSEN]},
        marks("point", "falls", crosses, shape="cross", angle=45, size=90, filled=True, opacity=1),
        *level(statue.slenderness_right_rad, say("chart.balance_right")),
        *level(-statue.slenderness_left_rad, say("chart.balance_left"), baseline="top"),
    ]
    horizon = prediction_s(source)
    if horizon is not None and horizon < source.scene.duration_s:
        layers += level(horizon, say("chart.horizon", time=say.digits(horizon)), "x", Look(MUTED, "2 3", 1.0))
    until = horizon_s(source)
    if until is not None and until < source.scene.duration_s:
        layers += level(
            until, say("chart.bounded", time=say.digits(until)), "x", Look(MUTED, "", 0.0), baseline="bottom", dy=-3
        )
    return _row(layers, 320)


def _doubt(source: RunSource) -> list[Json]:
    """A grey area from where no error is bounded."""
    until, end = horizon_s(source), source.scene.duration_s
    if until is None or until >= end:
        return []
    there = {"data": {"values": [{"from": until, "to": end}]}}
    return [there | marks("rect", "", span("from", "to", letter="x"), color="#7a8696", opacity=0.11)]


def _strip(patterns: Sequence[Json], say: Language) -> Json:
    """What each model does over time, in colours that are hatched too."""
    fills = {say(f"chart.pattern_{name}"): fill for name, fill in PATTERN_FILLS.items()}
    fills[say("chart.pattern_rocking_bare")] = PATTERN_FILLS["rocking"]
    met = {kind for part in patterns for kind in part["kind"]}
    order = [part["name"] for part in patterns]
    bars = {"y": names("name", order, grid=False), "color": kinds({kind: fills[kind] for kind in fills if kind in met})}
    return _row([marks("bar", "patterns", span("t", "t2", letter="x") | bars)], 8 + 22 * len(order))


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


def pattern_strip(source: RunSource, say: Language = ENGLISH) -> list[Json]:
    """The stretches of motion pattern of each model that has them; a statue without a pedestal only rocks."""
    words = {name: say(f"chart.pattern_{name}") for name in PATTERN_FILLS}
    if source.scene.pedestal is None:
        words["rocking"] = say("chart.pattern_rocking_bare")
    return [
        {
            "name": name, "t": [start for start, _, _ in drawn], "t2": [end for _, end, _ in drawn],
            "kind": [words[kind] for _, _, kind in drawn],
        }
        for name, run in source.runs.items() if run.patterns
        for drawn in [drawn_stretches(run.patterns)]
    ]  # fmt: skip


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
