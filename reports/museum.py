"""What a conservator wants to know: when it starts to move, how far it reaches, what the pedestal changes, what is not known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from harness.history import Outcome
from reports.assets import packed_array
from reports.decimate import kept_samples
from reports.numbers import heading, length, listed, short, unit
from reports.palette import HAIRLINE, INK, MUTED, look
from reports.posing import section
from reports.source import RunSource
from reports.study_figures import FLOOR_COLOUR, PEDESTAL_COLOUR
from reports.study_rows import Condition, family

Json = dict[str, Any]

WALL_COLOUR: Final = "#8c1d2f"
LIMITS: Final = (
    "The planar models know one direction of shaking, rigid bodies, sharp corners and two friction coefficients; a chipped or "
    "soft base, putty, mounts and a floor that gives are not in them. What this scene asked of those assumptions stands under "
    "“Where the model would stop being valid”. The numbers hold for this motion, not for the next earthquake."
)


@dataclass(frozen=True)
class Museum:
    """The section: sentences, and charts as (name, words, figure)."""

    sentences: Sequence[str]
    charts: Sequence[tuple[str, str, Json]]
    limits: str = LIMITS


def of_run(source: RunSource) -> Museum:
    """The section of one run: thresholds of motion by direction, reach over time against the wall."""
    sentences = [*_thresholds_in_words(source.scene, _peak_g(source)), *_reach_in_words(source)]
    charts = [("thresholds", "Acceleration below which it stays at rest, by direction", thresholds_figure(source))]
    charts += [("reach", "How far the top of the statue moves", reach_figure(source))] if source.histories else []
    return Museum(sentences, charts)


def thresholds_g(scene: Mapping[str, Any]) -> dict[str, float]:
    """Steady horizontal acceleration in g at which each motion begins: μ_s for sliding, b_s/h for tipping (section 2)."""
    statue, h = scene["statue"], float(scene["statue"]["centroid_height_m"])
    found = {
        "it tips to the left": float(statue["corner_left_m"]) / h,
        "it tips to the right": float(statue["corner_right_m"]) / h,
    }
    if scene["pedestal"] is not None:
        found["the pedestal slides"] = float(scene["contact"]["floor_static"])
    return found


def _peak_g(source: RunSource) -> float | None:
    motion = source.record["motion"]
    return motion["x_peak_m_s2"] / float(source.scene["gravity_m_s2"]) if "x_peak_m_s2" in motion else None


def _thresholds_in_words(scene: Mapping[str, Any], peak_g: float | None) -> list[str]:
    limits = thresholds_g(scene)
    first = min(limits, key=lambda name: limits[name])
    others = listed(
        f"at {unit(limits[name], 'g')} {name}" for name in sorted(limits, key=lambda item: limits[item])[1:]
    )
    sentences = [
        f"It stays at rest up to a steady acceleration of {unit(limits[first], 'g')}; there {first}. Each alone: {others}."
    ]
    if peak_g is not None:
        ratio = peak_g / limits[first]
        word = f"{short(ratio, 2)} times that" if ratio >= 1.0 else f"{100 * ratio:.0f} % of that"
        sentences.append(f"This floor motion peaks at {unit(peak_g, 'g')}, {word}.")
    return sentences


def _reach_in_words(source: RunSource) -> list[str]:
    shape, sentences = section(source.scene), []
    standing = [name for name in source.histories if source.runs[name]["outcome"] == Outcome.STANDS]
    for side, words in ((-1, "left"), (1, "right")):
        reach = {
            name: float(shape.overhang_m(source.histories[name].theta_rad, source.histories[name].slip_m, side).max())
            for name in standing
        }
        if reach:
            name = max(reach, key=lambda item: reach[item])
            rest = float(shape.overhang_m(np.zeros(1), np.zeros(1), side)[0])
            sentences.append(
                f"To the {words} no part of it comes farther than {length(max(reach[name], 0.0))} beyond its base's edge "
                f"({name}; at rest {length(rest)})."
            )
    fell = [name for name, run in source.runs.items() if Outcome(run["outcome"]).overturned]
    if fell:
        sentences.append(f"In {listed(fell)} it falls: no distance to a wall protects it then.")
    return sentences


def thresholds_figure(source: RunSource) -> Json:
    """Bars of the accelerations at which each motion begins, the floor's peak as a line."""
    limits = thresholds_g(source.scene)
    peak = _peak_g(source)
    data = [
        {
            "type": "bar", "orientation": "h", "x": list(limits.values()), "y": list(limits), "showlegend": False,
            "marker": {"color": [FLOOR_COLOUR, FLOOR_COLOUR, PEDESTAL_COLOUR][: len(limits)]}, "width": 0.55,
            "text": [f"{value:.3f} g" for value in limits.values()], "textposition": "outside", "cliponaxis": False,
            "hovertemplate": "%{y} from %{x:.3f} g<extra></extra>",
        }
    ]  # fmt: skip
    most = max([*limits.values(), peak or 0.0])
    layout: Json = {
        "height": 110 + 52 * len(limits), "xaxis": {"title": {"text": "horizontal acceleration of the floor  [g]"},
        "gridcolor": HAIRLINE, "range": [0.0, 1.25 * most]}, "yaxis": {"automargin": True}, "margin_top": 26, "shapes": [],
        "annotations": [],
    }  # fmt: skip
    if peak is not None:
        layout["shapes"] = [_level("x", peak, INK)]
        layout["annotations"] = [_note("x", peak, "this motion's peak")]
    return {"data": data, "layout": layout}


def _level(axis: str, value: float, colour: str) -> Json:
    other = "y" if axis == "x" else "x"
    place = {f"{axis}0": value, f"{axis}1": value, f"{other}0": 0, f"{other}1": 1, f"{other}ref": "paper"}
    return {"type": "line", **place, "line": {"color": colour, "width": 1.5, "dash": "dash"}}


def _note(axis: str, value: float, text: str) -> Json:
    place = (
        {"x": value, "yref": "paper", "y": 1.0, "yanchor": "bottom"}
        if axis == "x"
        else {"xref": "paper", "x": 1, "y": value}
    )
    return {**place, "text": text, "showarrow": False, "font": {"size": 11, "color": MUTED}} | (
        {} if axis == "x" else {"xanchor": "right", "yanchor": "bottom"}
    )


def reach_figure(source: RunSource) -> Json:
    """Displacement of the statue's top over time in every model, with the wall where the scene has one."""
    shape, wall = section(source.scene), source.scene["wall"]
    names = list(source.runs)
    data, most = [], 0.0
    for name, history in source.histories.items():
        style = look(name, names)
        moved = shape.top_displacement_m(history.theta_rad, history.slip_m)
        kept = kept_samples(moved, 4000)
        if source.runs[name]["outcome"] == Outcome.STANDS:
            most = max(most, float(np.abs(moved).max()))
        data.append(
            {
                "type": "scatter", "mode": "lines", "name": name, "x": packed_array(history.t_s[kept], "f4"),
                "y": packed_array(moved[kept], "f4"), "hovertemplate": f"{name} %{{y:.3f}} m<extra></extra>",
                "line": {"color": style.colour, "dash": style.dash, "width": style.width},
            }
        )  # fmt: skip
    layout: Json = {
        "height": 340, "xaxis": {"title": {"text": "time  [s]"}, "gridcolor": HAIRLINE},
        "yaxis": {"title": {"text": "top moves by  [m]"}, "gridcolor": HAIRLINE, "zerolinecolor": MUTED},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom"}, "hovermode": "x",
    }  # fmt: skip
    if wall is not None:
        at = float(wall["distance_m"]) * (1 if wall["side"] == "right" else -1)
        layout |= {"shapes": [_level("y", at, WALL_COLOUR)], "annotations": [_note("y", at, f"wall, {wall['side']}")]}
        most = max(most, float(wall["distance_m"]))
    limit = 1.15 * most or 0.1
    layout["yaxis"]["range"] = [-limit, limit]
    return {"data": data, "layout": layout}


def of_study(record: Mapping[str, Any], models: Sequence[str], found: Sequence[Condition]) -> Museum | None:
    """The section of a study with and without pedestal: reach by frequency and what the pedestal changes; else None."""
    keys = list(found[0].varied) if found else []
    pace = next((key for key in keys if key.endswith("frequency_hz")), None)
    if "pedestal" not in keys or pace is None:
        return None
    shape = section(record["scene"])
    model = next((name for name in models if name.startswith("analytic")), models[0])
    fell: dict[tuple[float, str], list[bool]] = {}
    reach: dict[tuple[float, str], float] = {}
    for item in found:
        row = item.answers.get(model)
        if row is None or row["run"] is None:
            continue
        setting = "on the floor" if item.varied["pedestal"] == "none" else "on the pedestal"
        place = (float(item.varied[pace]), setting)
        fell.setdefault(place, []).append(family(row["run"]["outcome"]) == "overturns")
        if row["run"]["outcome"] == Outcome.STANDS:
            theta = float(row["run"]["peak_theta_rad"]) * np.array([-1.0, 1.0])
            moved = float(np.abs(shape.top_displacement_m(theta, np.zeros(2))).max()) + float(row["run"]["peak_slip_m"])
            reach[place] = max(reach.get(place, 0.0), moved)
    charts = [
        ("saved", f"Share of conditions in which it overturns ({model})", _by_setting(fell, heading(pace))),
        (
            "moved",
            f"Farthest displacement of the top where it stands ({model})",
            _reach_by_setting(reach, heading(pace), record),
        ),
    ]
    return Museum([*_thresholds_in_words(record["scene"], None), *_saved_in_words(found, model)], charts)


def _saved_in_words(found: Sequence[Condition], model: str) -> list[str]:
    """How often the pedestal prevents, and how often it causes, an overturning under the same condition."""
    pairs: dict[tuple[Any, ...], dict[bool, bool]] = {}
    for item in found:
        row = item.answers.get(model)
        if row is not None and row["run"] is not None:
            rest = tuple(value for key, value in item.varied.items() if key != "pedestal")
            fell = family(row["run"]["outcome"]) == "overturns"
            pairs.setdefault(rest, {})[item.varied["pedestal"] == "none"] = fell
    both = [pair for pair in pairs.values() if len(pair) == 2]
    prevented, caused = sum(p[True] and not p[False] for p in both), sum(p[False] and not p[True] for p in both)
    bare = sum(p[True] for p in both)
    return [
        f"Of {len(both)} conditions it overturns in {bare} without the pedestal; with it {prevented} of these are prevented and "
        f"{caused} others caused ({model})."
    ]


def _by_setting(fell: Mapping[tuple[float, str], Sequence[bool]], title: str) -> Json:
    data = []
    for setting, colour in (("on the floor", FLOOR_COLOUR), ("on the pedestal", PEDESTAL_COLOUR)):
        places = sorted(place for place in fell if place[1] == setting)
        shares = [100.0 * sum(fell[place]) / len(fell[place]) for place in places]
        text = [f"{sum(fell[place])}/{len(fell[place])}" for place in places]
        data.append(
            {
                "type": "bar", "name": setting, "x": [f"{place[0]:g}" for place in places], "y": shares, "text": text,
                "textposition": "outside", "cliponaxis": False, "marker": {"color": colour},
            }
        )  # fmt: skip
    layout = {
        "height": 360, "barmode": "group", "xaxis": {"title": {"text": title}, "type": "category"},
        "yaxis": {"title": {"text": "overturns  [%]"}, "range": [0, 112], "gridcolor": HAIRLINE},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom"},
    }  # fmt: skip
    return {"data": data, "layout": layout}


def _reach_by_setting(reach: Mapping[tuple[float, str], float], title: str, record: Mapping[str, Any]) -> Json:
    data = [
        {
            "type": "scatter", "mode": "lines+markers", "name": setting, "line": {"color": colour},
            "x": [place[0] for place in sorted(reach) if place[1] == setting],
            "y": [reach[place] for place in sorted(reach) if place[1] == setting],
        }
        for setting, colour in (("on the floor", FLOOR_COLOUR), ("on the pedestal", PEDESTAL_COLOUR))
    ]  # fmt: skip
    layout: Json = {
        "height": 360, "xaxis": {"title": {"text": title}, "gridcolor": HAIRLINE},
        "yaxis": {"title": {"text": "top moves by  [m]"}, "rangemode": "tozero", "gridcolor": HAIRLINE},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom"},
    }  # fmt: skip
    wall = record["scene"]["wall"]
    if wall is not None:
        at = float(wall["distance_m"])
        layout |= {"shapes": [_level("y", at, WALL_COLOUR)], "annotations": [_note("y", at, "wall")]}
    return {"data": data, "layout": layout}
