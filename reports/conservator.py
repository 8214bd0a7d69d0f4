"""The conservator's page of a run or a study: what happens to the statue, in plain words and three pictures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from markupsafe import Markup

from harness.history import Outcome
from reports.conservator_pictures import compass, order_svg, percent, push_svg, reach_svg, safe_pushes, weakest_push
from reports.numbers import count_word, digits, length, listed, short
from reports.posing import Array, section
from reports.silhouette import silhouette_m
from reports.source import RunSource, run_source
from reports.words import AT_REST_RAD, horizon_s, motion_given, prediction_s

LIMITS: Final = (
    "The statue, its pedestal and the floor are taken as perfectly hard. A chipped or worn base, wax, putty, pins, mounts and "
    "a floor or showcase that sways are not in these numbers.",
    "Pushes are steady, level pushes at the height of the centre of gravity. A short jolt of the same strength may be borne, "
    "and an upward jolt makes the statue lighter on its feet.",
    "Friction under the statue and its pedestal was assumed, not measured, unless the notes of the full report say otherwise.",
    "The numbers hold for the shaking that was tried. The next earthquake is another one.",
)


@dataclass(frozen=True)
class Picture:
    """One picture with its heading and its explanation."""

    heading: str
    drawing: Markup
    words: Sequence[str]


def context(folder: Path, record: Mapping[str, Any]) -> dict[str, Any]:
    """Everything that the conservator's template shows."""
    if record["kind"] == "run":
        told = of_run(run_source(folder))
    else:
        from reports.conservator_study import of_effects, of_study

        told = of_study(record) if record["kind"] == "study" else of_effects(folder, record)
    return told | {"title": record["title"], "limits": LIMITS, "versions": record["versions"]}


def of_run(source: RunSource) -> dict[str, Any]:
    """Headline, points and pictures of one run."""
    answered = {name: run for name, run in source.runs.items() if not Outcome(run["outcome"]).failed}
    headline, tone = _headline(answered)
    return {
        "headline": headline,
        "tone": tone,
        "points": [*_who(answered), *_lean(source), *_pedestal_slip(source, answered), *_trust(source)],
        "pictures": [reach_picture(source), push_picture(source.scene, source.record["motion"]), order_picture(source)],
    }


def _headline(answered: Mapping[str, Any]) -> tuple[str, str]:
    ends = {_end(run["outcome"]) for run in answered.values()}
    if not ends:
        return "No model could compute what happens to the statue", "failed"
    if len(ends) == 1:
        end = ends.pop()
        return f"In this shaking the statue {end}", "agree" if end == "stays upright" else "failed"
    if "falls" in ends:
        return "In this shaking the statue may fall: the models disagree", "differ"
    return "The models disagree about what happens to the statue", "differ"


def _end(outcome: str) -> str:
    """An outcome in a museum's words."""
    kind = Outcome(outcome)
    if kind.overturned:
        return "falls"
    return {
        Outcome.STANDS: "stays upright",
        Outcome.TOUCHES_WALL: "strikes the wall",
        Outcome.LEFT_PEDESTAL: "slides off its pedestal",
        Outcome.LIFT_OFF: "is lifted off its support",
    }.get(kind, "does something the model cannot follow")


def _who(answered: Mapping[str, Any]) -> list[str]:
    groups: dict[str, list[str]] = {}
    for name, run in answered.items():
        groups.setdefault(_end(run["outcome"]), []).append(name)
    if len(groups) == 1 and len(answered) > 1:
        said = f"{count_word(len(answered)).capitalize()} computer models were asked, and all say so"
        return [f"{said}{_sides(answered)}.", *motion_given(answered)]
    if len(answered) == 1:
        return [f"Only one computer model was asked ({next(iter(answered))})."]
    ends = [f"It {listed(f'{end} in {listed(names)}' for end, names in groups.items())}."] if groups else []
    return [*ends, *motion_given(answered)]


def _sides(answered: Mapping[str, Any]) -> str:
    """To which sides it falls, where the models differ in that alone."""
    sides: dict[str, list[str]] = {}
    for name, run in answered.items():
        sides.setdefault(run["outcome"].removeprefix("overturned_"), []).append(name)
    if len(sides) == 1 or not all(Outcome(run["outcome"]).overturned for run in answered.values()):
        return ""
    return "; only the side differs: " + "; ".join(f"{side} in {listed(names)}" for side, names in sides.items())


def _standing(source: RunSource) -> list[str]:
    return [name for name in source.histories if source.runs[name]["outcome"] == Outcome.STANDS]


def _lean(source: RunSource) -> list[str]:
    """The greatest lean of the models in which it stands, as a share of the lean from which it does not come back."""
    statue, worst = source.scene["statue"], 0.0
    degrees = 0.0
    for name in _standing(source):
        theta = source.histories[name].theta_rad
        for side, key in ((1.0, "slenderness_right_rad"), (-1.0, "slenderness_left_rad")):
            peak = float((side * theta).max())
            if peak / float(statue[key]) > worst:
                worst, degrees = peak / float(statue[key]), math.degrees(peak)
    if not _standing(source):
        return []
    if degrees < math.degrees(AT_REST_RAD):
        return ["It does not rock: its base stays flat on its support."]
    return [
        f"It rocks. At its worst it leans {digits(degrees, 2)}°, which is {100.0 * worst:.0f} % of the way to the lean from "
        "which it would not come back by itself."
    ]


def _pedestal_slip(source: RunSource, answered: Mapping[str, Any]) -> list[str]:
    if source.scene["pedestal"] is None or not answered:
        return []
    most = max(float(run["peak_slip_m"]) for run in answered.values())
    return (
        [f"Its pedestal slides on the floor by up to {length(most, 2)}."]
        if most > 1e-4
        else ["Its pedestal stays put."]
    )


def _trust(source: RunSource) -> list[str]:
    end_s = float(source.scene["duration_s"])
    until, predictable_s = horizon_s(source), prediction_s(source)
    typical = "Read the distances on this page as typical, not as exact."
    if predictable_s is not None and predictable_s < end_s:
        on = f"from second {short(predictable_s, 2)} on nobody can follow it swing by swing"
        return [f"Rocking is like a tossed coin: {on}. {typical}"]
    if until is not None and until < end_s:
        return [
            f"From second {short(until, 2)} on the computed swings are not exact enough to be trusted one by one. {typical}"
        ]
    return []


def _extremes(source: RunSource) -> list[tuple[float, float]]:
    """Rotation and slip at the farthest shifts of the top to the left and to the right, over the models in which it stands."""
    shape, found = section(source.scene), []
    for side in (-1.0, 1.0):
        best: tuple[float, float, float] | None = None
        for name in _standing(source):
            history = source.histories[name]
            moved = side * shape.top_displacement_m(history.theta_rad, history.slip_m)
            k = int(np.argmax(moved))
            if best is None or moved[k] > best[0]:
                best = (float(moved[k]), float(history.theta_rad[k]), float(history.slip_m[k]))
        if best is not None and best[0] > 1e-4:
            found.append(best[1:])
    return found


def reach_picture(source: RunSource, heading: str = "How far does it move?") -> Picture:
    """How far the statue moves, against its wall; where it moves in no model but falls, its lean of no return."""
    extremes = _extremes(source)
    words = []
    outline, shape = silhouette_m(source.scene, source.mesh), section(source.scene)
    if extremes:
        words.append("The dashed lines show its farthest leans to either side; the numbers, how far its top moves.")
        clear = [(side, _beyond(outline, shape, extremes, sign)) for side, sign in (("left", -1.0), ("right", 1.0))]
        each = listed(f"{length(reach, 2)} on the {side}" for side, reach in clear)
        words.append(f"Beyond its outline at rest it needs {each}: keep that space free.")
    elif _standing(source):
        words.append(f"In {listed(_standing(source))} it does not move visibly.")
    wall = source.scene["wall"]
    if wall is not None and _standing(source):
        sign = 1.0 if wall["side"] == "right" else -1.0
        rest = _farthest(outline, shape, (0.0, 0.0), sign)
        edge = shape.corner_right_m if sign > 0 else shape.corner_left_m
        gap = float(wall["distance_m"]) + edge - rest
        left = gap - _beyond(outline, shape, extremes, sign)
        words.append(
            f"At rest {length(gap, 2)} are free between it and the wall; at its farthest lean "
            + (f"{length(left, 2)} remain." if left > 0 else "nothing remains: it would strike the wall.")
        )
    fell = [name for name, run in source.runs.items() if Outcome(run["outcome"]).overturned]
    if fell:
        words.append(f"In {listed(fell)} it falls. No distance to a wall protects it then.")
    last = _no_return(source, fell) if not extremes else []
    if last:
        words.append("The dashed line shows the lean from which it does not come back.")
    return Picture(heading, reach_svg(source, extremes or last, f"{heading} {' '.join(words)}"), words)


def _no_return(source: RunSource, fell: Sequence[str]) -> list[tuple[float, float]]:
    """The leans from which the statue does not come back, to the sides to which it falls in these models."""
    statue, ends = source.scene["statue"], {source.runs[name]["outcome"] for name in fell}
    right = [float(statue["slenderness_right_rad"])] if Outcome.OVERTURNED_RIGHT in ends else []
    left = [-float(statue["slenderness_left_rad"])] if Outcome.OVERTURNED_LEFT in ends else []
    return [(lean, 0.0) for lean in right + left]


def _farthest(outline: Array, shape: Any, pose: tuple[float, float], sign: float) -> float:
    return float((sign * shape.posed_m(outline, *pose)[0][:, 0]).max())


def _beyond(outline: Array, shape: Any, poses: Sequence[tuple[float, float]], sign: float) -> float:
    """How far the outline at these poses stands out beyond its own outline at rest, on one side."""
    rest = _farthest(outline, shape, (0.0, 0.0), sign)
    return max([0.0, *(_farthest(outline, shape, pose, sign) - rest for pose in poses)])


def push_picture(
    scene: Mapping[str, Any], motion: Mapping[str, Any], borne: Mapping[float, float] | None = None
) -> Picture:
    """Which push the statue bears, by direction, seen from above; `borne` are shakings without a fall by azimuth in degrees."""
    heading = "Which push does it bear, by direction?"
    safe, slides = safe_pushes(scene)
    least, towards = weakest_push(safe)
    direction = compass(math.degrees(math.atan2(towards[1], towards[0])))
    words = [
        "Seen from above, the statue in the middle. Inside the green area a steady sideways push does not make it tip.",
        f"It is weakest towards the {direction}: there it tips from a push of {percent(least)} of its weight on. "
        "Tipping is not yet falling: it may rock and come to rest again.",
    ]
    if slides < 1.0:
        stone = (
            "the statue" if scene["pedestal"] is None or slides < scene["contact"]["floor_static"] else "the pedestal"
        )
        words.append(f"Outside the dashed circle, {percent(slides)} of the weight, {stone} slides.")
    points = None
    if borne:
        azimuths = sorted(borne)
        turned = np.radians(azimuths)
        points = np.array([borne[key] for key in azimuths])[:, None] * np.column_stack([np.cos(turned), np.sin(turned)])
        worst = min(borne, key=lambda key: borne[key])
        words.append(
            "The blue line is the strongest shaking, by direction, that it bore without falling in every case tried; least "
            f"towards the {compass(worst)}, {percent(borne[worst])} of the weight."
        )
    if any(f"{axis}_m_s2" in motion for axis in "xy"):
        words.append("The pink line is the push of this shaking from moment to moment.")
    return Picture(heading, push_svg(scene, motion, f"{heading} {' '.join(words)}", points), words)


def levels(scene: Mapping[str, Any]) -> list[tuple[str, float, bool]]:
    """What gives way in the plane of rocking, from weak to strong: words, push as a share of the weight, whether the pedestal."""
    statue, h = scene["statue"], float(scene["statue"]["centroid_height_m"])
    found = [
        ("the statue tips to the left", float(statue["corner_left_m"]) / h, False),
        ("the statue tips to the right", float(statue["corner_right_m"]) / h, False),
    ]
    if scene["pedestal"] is not None:
        found.append(("the pedestal slides on the floor", float(scene["contact"]["floor_static"]), True))
    return sorted(found, key=lambda item: item[1])


def order_picture(source: RunSource) -> Picture:
    """What gives way first, and so what the pedestal does for the statue."""
    scene, motion = source.scene, source.record["motion"]
    peak = float(motion["x_peak_m_s2"]) / float(scene["gravity_m_s2"]) if "x_peak_m_s2" in motion else None
    heading = "What does the pedestal change?" if scene["pedestal"] is not None else "What gives way first?"
    words = order_words(scene, peak)
    return Picture(heading, order_svg(levels(scene), peak, f"{heading} {' '.join(words)}"), words)


def order_words(scene: Mapping[str, Any], peak: float | None) -> list[str]:
    """What the order of giving way means."""
    found = levels(scene)
    words = []
    if scene["pedestal"] is None:
        words.append("The statue stands on the floor: nothing slides under it that could soften the shaking.")
    elif found[0][2]:
        words.append(
            "The pedestal slides before the statue tips. Sliding limits the push that reaches the statue, as a fuse does; the "
            "price is that the pedestal wanders."
        )
    elif found[1][2]:
        words.append(
            "Towards its weak side the statue tips before its pedestal slides, towards its strong side after. The pedestal "
            "softens strong shaking only in part."
        )
    else:
        words.append("The statue tips before its pedestal slides: a pedestal that holds fast gives no protection.")
    if peak is not None:
        first, level, _ = found[0]
        times = f"{short(peak / level, 2)} times" if peak >= level else f"{percent(peak / level)} of"
        words.append(
            f"This shaking pushes with up to {percent(peak)} of the weight: {times} what it takes until {first}."
        )
    if scene["pedestal"] is not None:
        words.append("Whether it prevents falls on the whole is shown by a study of the statue with and without it.")
    return words
