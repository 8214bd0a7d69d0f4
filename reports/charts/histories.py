"""The zoomable histories of all models on one time axis: rotation, motion patterns, pedestal slip, floor motion."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.model import Array, number
from harness.records.run import SLIDES_M, STILL_RAD
from harness.records.scene import StatueRecord
from harness.statics.standstill import STILL_M
from reports.charts import Json
from reports.charts.figure import (
    HEIGHT,
    INK,
    MUTED,
    PATTERN_FILLS,
    Look,
    Row,
    axis,
    chosen,
    columns,
    kinds,
    level,
    look,
    marks,
    named,
    names,
    over_time,
    reading,
    span,
)
from reports.messages import ENGLISH, Language
from reports.source import RunSource, run_event_s
from reports.text.wording import horizon_s, prediction_s

# Samples as a page carries them: fewer for the screen with every peak kept, packed as differences of multiples of a step.

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
        # One value, or the same again and again, is a multiple of itself.
        return float(abs(array[0])) if len(array) and array[0] else 1.0
    # Values that differ by their rounding alone: a finer step than that has no whole number of steps.
    return max(float(np.ptp(array)) / levels, float(np.spacing(np.abs(array).max())))


ACROSS: Final = "out_of_plane_rad"
ACROSS_RAD: Final = 1e-4
"""A 3D engine's rotation across the rocking plane below this does not show beside the rotation in it."""
MOST_STRETCHES: Final = 1500
"""Most stretches of motion pattern drawn per model: shorter ones than a pixel do not show."""
BARE: Final = {"rocking": "rocking_bare"}
"""A statue without a pedestal only rocks."""
OFF: Final = {"statue_slides": "statue_off"}
"""What moves a statue on its support also throws it."""
AXIS_LOOKS: Final = {
    "x": Look(INK, "", 1.0),
    "y": Look("#AA4499", "", 1.0),
    "z": Look("#3A8FC7", "", 1.0),
}


def histories_figure(source: RunSource, say: Language = ENGLISH) -> Json:
    """The chart: rows over one axis of time; every curve is a record's history, peaks kept."""
    order, views, motion = list(source.histories), _views(source), source.record.motion
    looks = {name: look(name, order) for name in order}
    gravity = source.scene.gravity_m_s2
    floor = {axis: say("chart.floor_axis", axis=axis) for axis in motion.accel_m_s2}
    data: dict[str, list[Json]] = {
        "histories": [_columns(source, name) for name in order],
        "falls": _falls(source),
        "patterns": pattern_strip(source, say),
        "floor": [
            {"name": floor[axis], "t": np.asarray(motion.t_s), "accel": np.asarray(accel) / gravity}
            for axis, accel in motion.accel_m_s2.items()
        ],
    }
    slides = any(np.abs(part.get("slip", 0.0)).max() > 1e3 * STILL_M for part in data["histories"])
    turns = any("across" in part for part in data["histories"])
    title = next(iter(floor.values())) if len(floor) == 1 else say("chart.floor")
    curves, axes = named(looks, legend=False), {name: AXIS_LOOKS[axis] for axis, name in floor.items()}
    slip, turned = say("word.slip"), say("chart.out_of_plane")
    rows: list[Row] = [
        (_rotation(source, looks, views, say), 320, reading("histories", "theta", "θ", "rad", 5)),
        *((_strip(strips, say), 8 + 22 * len(strips), None) for strips in [data["patterns"]] if strips),
        *([_curves(say("chart.slip_u"), 130, curves, reading("histories", "slip", slip, "mm", 3))] if slides else []),
        *([_curves(say("chart.across"), 110, curves, reading("histories", "across", turned, "rad", 4))] if turns else []),
        *(
            [_curves(f"{title}  [g]", 100, named(axes, len(axes) > 1, False), reading("floor", "accel", "", "g", 3))]
            if floor else []
        ),
    ]  # fmt: skip
    doubt = _doubt(source)
    under = [([*doubt, *layers], height, read) for layers, height, read in rows]
    return over_time(under, say("chart.time"), data, views)


def _curves(title: str, height: float, drawn: Json, read: Json) -> Row:
    """A row of the curves that a pointer reads there."""
    return [marks("line", read["data"], {"y": axis(read["of"], title, tickCount=4)} | drawn)], height, read


def _columns(source: RunSource, name: str) -> Json:
    """What is drawn of a model's history, and how far its error is stated."""
    history, run = source.histories[name], source.runs[name]
    drawn: Json = {"t": history.t_s, "theta": history.theta_rad}
    if source.scene.pedestal is not None:
        drawn["slip"] = 1000.0 * history.slip_m
    if ACROSS in history.extra and float(np.abs(history.extra[ACROSS]).max()) > ACROSS_RAD:
        drawn["across"] = history.extra[ACROSS]
    size, until = run.numerical_uncertainty_rad, run.reliable_until_s
    return drawn | {"name": name, "size": size or 0.0, "until": until if size and until is not None else -1.0}


def _falls(source: RunSource) -> list[Json]:
    """Where models pass their balance points for good."""
    falls = {
        name: source.runs[name].no_return_time_s for name in source.histories if source.runs[name].outcome.overturned
    }
    return [
        {"name": name, "t": [at], "theta": [float(np.interp(at, history.t_s, history.theta_rad))]}
        for name, at in falls.items() if at is not None
        for history in [source.histories[name]]
    ]  # fmt: skip


def _rotation(source: RunSource, looks: Mapping[str, Look], views: Json, say: Language) -> list[Json]:
    """The rotations with their numerical errors, the balance points and the horizon of prediction."""
    statue = source.scene.statue
    whole = {"zero": False, "nice": False, "domain": views["near"]}
    y = axis("theta", say("chart.theta"), "Y", whole, tickCount=7)
    error = [
        {"filter": "datum.t <= datum.until"},
        *({"calculate": f"datum.theta {sign} datum.size", "as": name} for sign, name in (("-", "low"), ("+", "high"))),
    ]
    around = {"fill": named(looks)["color"]}
    band = marks("area", "histories", {"y": y | {"field": "low"}, "y2": {"field": "high"}} | around, fillOpacity=0.18)
    layers = [
        band | {"transform": error},
        *chosen([marks("line", "histories", {"y": y} | named(looks))]),
        marks("point", "falls", {"y": y, **around}, shape="cross", angle=45, size=90, filled=True, opacity=1),
        *level(statue.slenderness_right_rad, say("chart.balance_right")),
        *level(-statue.slenderness_left_rad, say("chart.balance_left"), baseline="top"),
    ]
    end, horizon, until = source.scene.duration_s, prediction_s(source), horizon_s(source)
    if horizon is not None and horizon < end:
        layers += level(horizon, say("chart.horizon", time=say.digits(horizon)), "x", Look(MUTED, "2 3", 1.0))
    if until is not None and until < end:
        words, none = say("chart.bounded", time=say.digits(until)), Look(MUTED, "", 0.0)
        layers += level(until, words, "x", none, {"y": HEIGHT}, baseline="bottom", dy=-3)
    return layers


def _doubt(source: RunSource) -> list[Json]:
    """A grey area from where no error is bounded."""
    until, end = horizon_s(source), source.scene.duration_s
    if until is None or until >= end:
        return []
    there = {"data": {"values": [{"from": until, "to": end}]}}
    return [there | marks("rect", "", span("from", "to", letter="x"), color="#7a8696", opacity=0.11)]


def _strip(patterns: Sequence[Json], say: Language) -> list[Json]:
    """What each model does over time, in colours that are hatched too."""
    fills = {say(f"chart.pattern_{name}"): fill for name, fill in PATTERN_FILLS.items()}
    fills |= {say(f"chart.pattern_{own}"): PATTERN_FILLS[name] for name, own in (BARE | OFF).items()}
    met = {kind for part in patterns for kind in part["kind"]}
    y = names("name", [part["name"] for part in patterns], grid=False)
    bars = {"y": y, "color": kinds({kind: fills[kind] for kind in fills if kind in met})}
    return [marks("bar", "patterns", span("t", "t2", letter="x") | bars)]


def _views(source: RunSource) -> Json:
    """The two vertical views of the rotation: near the balance points, and whole."""
    statue = source.scene.statue
    rotations = np.concatenate([[0.0], *(item.theta_rad for item in source.histories.values())])
    least, most = float(rotations.min()), float(rotations.max())
    near = max(least, -1.35 * statue.slenderness_left_rad), min(most, 1.35 * statue.slenderness_right_rad)
    # Let go beyond its balance points, a body that falls never comes near them.
    seen = np.any((rotations[1:] >= near[0]) & (rotations[1:] <= near[1]))
    whole = _padded(least, most)
    return {
        "whole": whole, "near": _worded(_padded(*near), statue) if seen else whole, "duration_s": source.scene.duration_s,
        "event_s": list(run_event_s(source)),
    }  # fmt: skip


def _padded(low: float, high: float) -> list[float]:
    # What is at rest is drawn so, not as the rounding that moves it.
    margin = 0.08 * (high - low) if high - low > STILL_RAD else 0.01
    return [low - margin, high + margin]


def _worded(view: Sequence[float], statue: StatueRecord) -> list[float]:
    """A view with room for the words beyond the balance points that are in it."""
    low, high = view
    room, left, right = 0.06 * (high - low), -statue.slenderness_left_rad, statue.slenderness_right_rad
    return [left - room if low < left < low + room else low, right + room if high - room < right < high else high]


def pattern_strip(source: RunSource, say: Language = ENGLISH) -> list[Json]:
    """The stretches of motion pattern of each model that has them, in the words of what there is."""
    off = any(number(run.validity, "statue_flight_m", 0.0) > SLIDES_M for run in source.runs.values())
    own = (BARE if source.scene.pedestal is None else {}) | (OFF if off else {})
    words = {name: say(f"chart.pattern_{own.get(name, name)}") for name in PATTERN_FILLS}
    return [
        {
            "name": name,
            **columns("t t2 kind", [(start, end, words[kind]) for start, end, kind in drawn_stretches(run.patterns)]),
        }
        for name, run in source.runs.items()
        if run.patterns
    ]


def drawn_stretches(patterns: Sequence[Sequence[Any]], most: int = MOST_STRETCHES) -> list[tuple[float, float, str]]:
    """At most `most` stretches covering the same time: where there are more, what goes on amid each of so many bins."""
    stretches = [(float(start), float(end), str(name)) for start, end, name in patterns]
    if len(stretches) <= most:
        return stretches
    ends = np.array([end for _, end, _ in stretches])
    edges = np.linspace(stretches[0][0], ends[-1], most + 1)
    kinds_of = [stretches[k][2] for k in np.searchsorted(ends, 0.5 * (edges[:-1] + edges[1:]))]
    starts = [0, *(k for k in range(1, most) if kinds_of[k] != kinds_of[k - 1]), most]
    return [(float(edges[k]), float(edges[end]), kinds_of[k]) for k, end in pairwise(starts)]
