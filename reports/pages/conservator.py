"""The conservator's page of a run or a study: what happens to the statue, in plain words and three pictures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from markupsafe import Markup

from harness.model.history import Outcome
from harness.records.run import EngineRunRecord, RunRecord
from harness.records.scene import MotionRecord, SceneRecord
from reports.drawing.conservator_pictures import order_svg, push_svg, reach_svg
from reports.drawing.kinematics import Array, section
from reports.drawing.silhouette import silhouette_m
from reports.source import RunSource, source_of
from reports.text.chance import first_line
from reports.text.giving_way import Support, compass, levels, order_words, support_of, weakest_words
from reports.text.numbers import count_word, digits, length, listed, percent, short
from reports.text.numbers import heading as label_of
from reports.text.wording import AT_REST_RAD, horizon_s, motion_given, prediction_s

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


def context(folder: Path, record: RunRecord | Mapping[str, Any]) -> dict[str, object]:
    """Everything that the conservator's template shows."""
    if isinstance(record, RunRecord):
        page = of_run(source_of(folder, record))
        return page | {"title": record.title, "limits": LIMITS, "versions": record.versions}
    from reports.pages.conservator_study import of_effects, of_study

    page = of_study(record) if record["kind"] == "study" else of_effects(folder, record)
    return page | {"title": record["title"], "limits": LIMITS, "versions": record["versions"]}


def of_run(source: RunSource) -> dict[str, object]:
    """Headline, points and pictures of one run."""
    answered = {name: run for name, run in source.runs.items() if not run.outcome.failed}
    headline, tone = first_line(source.record.assessment, *_headline(source, answered))
    scene, motion = source.scene, source.record.motion
    support = support_of(scene)
    return {
        "headline": headline,
        "tone": tone,
        "points": [*_who(source.runs, answered), *_lean(source), *_pedestal_slip(source, answered), *_trust(source)],
        "pictures": [
            reach_picture(source),
            push_picture(scene, support, motion),
            order_picture(scene, support, motion),
        ],
    }


def _headline(source: RunSource, answered: Mapping[str, EngineRunRecord]) -> tuple[str, str]:
    ends = {end_words(run.outcome) for run in answered.values()}
    begins = _begins(source)
    if not ends:
        return "No model could compute what happens to the statue", "failed"
    if len(ends) == 1:
        end = ends.pop()
        return f"{begins} the statue {end}", "agree" if end == "stays upright" else "failed"
    if "falls" in ends:
        return f"{begins} the statue may fall: the models disagree", "differ"
    return "The models disagree about what happens to the statue", "differ"


def _begins(source: RunSource) -> str:
    """What the statue is put through: shaking, a start off its rest, both or neither."""
    start, shaking = source.scene.initial, bool(source.record.motion.accel_m_s2)
    if start.pose is not None:
        return "Let go from its pose in space," if not shaking else "In this shaking, begun from a pose in space,"
    lean, rate = start.theta_rad, start.theta_rate_rad_s
    begun = f"at a lean of {digits(math.degrees(abs(lean)), 2)}°" if lean else "with a turn given to it" if rate else ""
    if shaking:
        return f"In this shaking, begun {begun}," if begun else "In this shaking"
    return f"Let go {begun}, without any shaking," if begun else "Left alone"


def end_words(outcome: str) -> str:
    """An outcome in a museum's words."""
    kind = Outcome(outcome)
    if kind.overturned:
        return "falls"
    return {
        Outcome.STANDS: "stays upright",
        Outcome.TOUCHES_WALL: "strikes the wall",
        Outcome.LEFT_PEDESTAL: "slides off its pedestal",
        Outcome.LIFT_OFF: "is lifted off its support",
        Outcome.UNDECIDED: "still leans past its balance point at the end",
    }.get(kind, "does something the model cannot follow")


def _who(runs: Mapping[str, EngineRunRecord], answered: Mapping[str, EngineRunRecord]) -> list[str]:
    silent = [name for name in runs if name not in answered]
    none = [f"No answer came from {listed(silent)}."] if silent else []
    groups: dict[str, list[str]] = {}
    for name, run in answered.items():
        groups.setdefault(end_words(run.outcome), []).append(name)
    if len(answered) == 1:
        return [f"Only one computer model {'answered' if silent else 'was asked'} ({next(iter(answered))}).", *none]
    if len(groups) == 1:
        said = f"{count_word(len(answered)).capitalize()} computer models answered, and all say so"
        return [f"{said}{_sides(answered)}.", *motion_given(answered), *none]
    ends = [f"It {listed(f'{end} in {listed(names)}' for end, names in groups.items())}."] if groups else []
    return [*ends, *motion_given(answered), *none]


def _sides(answered: Mapping[str, EngineRunRecord]) -> str:
    """To which sides it falls, where the models differ in that alone."""
    sides: dict[str, list[str]] = {}
    for name, run in answered.items():
        sides.setdefault(run.outcome.removeprefix("overturned_"), []).append(name)
    if len(sides) == 1 or not all(run.outcome.overturned for run in answered.values()):
        return ""
    return "; only the side differs: " + "; ".join(f"{side} in {listed(names)}" for side, names in sides.items())


def _standing(source: RunSource) -> list[str]:
    return [name for name in source.histories if source.runs[name].outcome == Outcome.STANDS]


def _lean(source: RunSource) -> list[str]:
    """The greatest lean of the models in which it stands, as a share of the lean from which it does not come back."""
    statue, worst = source.scene.statue, 0.0
    degrees = 0.0
    for name in _standing(source):
        theta = source.histories[name].theta_rad
        for side in (1, -1):
            peak = float((side * theta).max())
            if peak / statue.slenderness_rad(side) > worst:
                worst, degrees = peak / statue.slenderness_rad(side), math.degrees(peak)
    if not _standing(source):
        return []
    where = "" if len(_standing(source)) == len(source.runs) else f"In {listed(_standing(source))}: "
    if degrees < math.degrees(AT_REST_RAD):
        return [f"{where}It does not rock: its base stays flat on its support."]
    return [
        f"{where}It rocks. At its worst it leans {digits(degrees, 2)}°, which is "
        + (f"{100.0 * worst:.0f} % of the way to" if worst < 1.0 else "past")
        + " the lean from which it would not come back by itself."
    ]


def _pedestal_slip(source: RunSource, answered: Mapping[str, EngineRunRecord]) -> list[str]:
    if source.scene.pedestal is None or not answered:
        return []
    most = max(run.peak_slip_m for run in answered.values())
    return (
        [f"Its pedestal slides on the floor by up to {length(most)}."] if most > 1e-4 else ["Its pedestal stays put."]
    )


def _trust(source: RunSource) -> list[str]:
    end_s = source.scene.duration_s
    until, predictable_s = horizon_s(source), prediction_s(source)
    typical = "Read the distances on this page as typical, not as exact."
    if predictable_s is not None and predictable_s < end_s:
        return [
            f"Rocking is sensitive: from second {short(predictable_s, 2)} on no model can follow it swing by swing. {typical}"
        ]
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
        words.append("The dashed lines show its farthest positions to either side; the numbers, how far its top moves.")
        clear = [(side, _beyond(outline, shape, extremes, sign)) for side, sign in (("left", -1.0), ("right", 1.0))]
        each = listed(f"{length(reach)} on the {side}" for side, reach in clear)
        words.append(f"Beyond its outline at rest it needs {each}: keep that space free.")
    elif _standing(source):
        words.append(f"In {listed(_standing(source))} it does not move visibly.")
    wall = source.scene.wall
    if wall is not None and _standing(source):
        sign = 1.0 if wall.side == "right" else -1.0
        rest = _farthest(outline, shape, (0.0, 0.0), sign)
        edge = shape.corner_right_m if sign > 0 else shape.corner_left_m
        gap = wall.distance_m + edge - rest
        left = gap - _beyond(outline, shape, extremes, sign)
        words.append(
            f"At rest {length(gap)} are free between it and the wall; at its farthest lean "
            + (f"{length(left)} remain." if left > 0 else "nothing remains: it would strike the wall.")
        )
    fell = [name for name, run in source.runs.items() if run.outcome.overturned]
    if fell:
        words.append(f"In {listed(fell)} it falls. No distance to a wall protects it then.")
    others = [name for name, run in source.runs.items() if name not in (*fell, *_standing(source))]
    for name in others:
        failed = source.runs[name].outcome.failed
        words.append(f"{name} gave no answer." if failed else f"In {name} it {end_words(source.runs[name].outcome)}.")
    last = _no_return(source, fell) if not extremes else []
    if last:
        words.append(
            "The dashed line shows the lean from which it does not come back; the number, how far its top is then."
        )
    return Picture(heading, reach_svg(source, extremes or last, f"{heading} {' '.join(words)}"), words)


def _no_return(source: RunSource, fell: Sequence[str]) -> list[tuple[float, float]]:
    """The leans from which the statue does not come back, to the sides to which it falls in these models."""
    statue, ends = source.scene.statue, {source.runs[name].outcome for name in fell}
    right = [statue.slenderness_right_rad] if Outcome.OVERTURNED_RIGHT in ends else []
    left = [-statue.slenderness_left_rad] if Outcome.OVERTURNED_LEFT in ends else []
    return [(lean, 0.0) for lean in right + left]


def _farthest(outline: Array, shape: Any, pose: tuple[float, float], sign: float) -> float:
    return float((sign * shape.posed_m(outline, *pose)[0][:, 0]).max())


def _beyond(outline: Array, shape: Any, poses: Sequence[tuple[float, float]], sign: float) -> float:
    """How far the outline at these poses stands out beyond its own outline at rest, on one side."""
    rest = _farthest(outline, shape, (0.0, 0.0), sign)
    return max([0.0, *(_farthest(outline, shape, pose, sign) - rest for pose in poses)])


def push_picture(
    scene: SceneRecord,
    support: Support,
    motion: MotionRecord | None = None,
    borne: Mapping[float, float] | None = None,
) -> Picture:
    """Which push the statue bears, by direction, seen from above; `borne` are shakings without a fall by azimuth in degrees."""
    heading = "Which push does it bear, by direction?"
    words = [
        "Seen from above, the statue in the middle. Inside the green area a steady sideways push does not make it tip.",
        f"{weakest_words(scene)} Tipping is not yet falling: it may rock and come to rest again.",
    ]
    if support.statue_keys:
        varied = listed(dict.fromkeys(label_of(key).partition(" [")[0] for key in support.statue_keys))
        words.append(
            f"The statue is drawn as the study's scene has it; what was varied of it ({varied}) is not in this picture."
        )
    # A push of the statue's own weight is none of an earthquake's: no circle is drawn for it.
    slips = [(push, stone) for push, stone in support.slips() if push < 1.0]
    circles = list(dict.fromkeys(push for push, _ in slips))
    by_stone = {stone: [push for push, what in slips if what == stone] for _, stone in slips}
    each = [
        f"{stone} slides from {' to '.join(map(percent, dict.fromkeys((pushes[0], pushes[-1]))))} of the weight on"
        for stone, pushes in by_stone.items()
    ]
    if len(circles) == 1:
        words.append(f"Outside the dashed circle {each[0]}.")
    elif circles:
        words.append(f"Outside the dashed circles, by situation, {listed(each)}.")
    points = None
    if borne:
        azimuths = sorted(borne)
        turned = np.radians(azimuths)
        points = np.array([borne[key] for key in azimuths])[:, None] * np.column_stack([np.cos(turned), np.sin(turned)])
        worst = min(borne, key=lambda key: borne[key])
        words.append(
            "The blue line is the strongest shaking, by direction, up to which it stood in every case tried; least "
            f"towards the {compass(worst)}, {percent(borne[worst])} of the weight."
        )
    axes = motion.accel_m_s2.keys() if motion is not None else set()
    if axes & {"x", "y"}:
        rising = " (its up-and-down part left out)" if "z" in axes else ""
        words.append(f"The pink line is the push of this shaking from moment to moment{rising}.")
    return Picture(heading, push_svg(scene, motion, circles, f"{heading} {' '.join(words)}", points), words)


def order_picture(scene: SceneRecord, support: Support, motion: MotionRecord | None = None) -> Picture:
    """What gives way first, and so what the pedestal does for the statue."""
    push = None if motion is None else motion.push
    heading = "What does the pedestal change?" if support.pedestal == (True,) and push else "What gives way first?"
    words = order_words(scene, support, push, rising=motion is not None and motion.z_m_s2 is not None)
    drawn = order_svg(levels(scene, support), None if push is None else push.peak, f"{heading} {' '.join(words)}")
    return Picture(heading, drawn, words)
