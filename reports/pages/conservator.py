"""The conservator's page of a run or a study: what happens to the statue, in plain words and three pictures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.model.history import Outcome
from harness.records.run import EngineRunRecord, RunRecord
from reports.drawing.conservator_pictures import reach_svg
from reports.drawing.kinematics import Array, section
from reports.drawing.silhouette import silhouette_m
from reports.pages.conservator_parts import LIMITS, Picture, end_words, order_picture, push_picture
from reports.source import RunSource, source_of
from reports.text.chance import first_line
from reports.text.giving_way import support_of
from reports.text.numbers import count_word, digits, length, listed, short
from reports.text.wording import AT_REST_RAD, horizon_s, motion_given, prediction_s


def context(folder: Path, record: RunRecord) -> dict[str, object]:
    """Everything that the conservator's template shows of a run."""
    source = source_of(folder, record)
    return of_run(source) | {"title": record.title, "limits": LIMITS, "versions": record.versions}


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
    shape, extremes = section(source.scene), []
    for side in (-1.0, 1.0):
        best: tuple[float, float, float] | None = None
        for name in _standing(source):
            history = source.histories[name]
            moved = side * shape.top_displacement_m(history.theta_rad, history.slip_m)
            k = int(np.argmax(moved))
            if best is None or moved[k] > best[0]:
                best = (float(moved[k]), float(history.theta_rad[k]), float(history.slip_m[k]))
        if best is not None and best[0] > 1e-4:
            extremes.append(best[1:])
    return extremes


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
