"""The conservator's page of a run: what happens to the statue, in plain words and pictures; no model is named here."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.model.history import Outcome
from harness.model.in_space import support_m
from harness.records.assess import Assessment, worst
from harness.records.run import EngineRunRecord, RunRecord, has_answer, tips_s
from reports.drawing.conservator_pictures import plan_svg, reach_svg
from reports.drawing.display_mesh import silhouette_m
from reports.drawing.floor_plan import floor_plan
from reports.drawing.kinematics import Array, section
from reports.messages import ENGLISH, Language, probability_text
from reports.pages.conservator_parts import Picture, end_words, order_picture, page, push_picture
from reports.source import RunSource, source_of
from reports.text.chance import worse_tone
from reports.text.giving_way import support_of
from reports.text.limits import TIPS_RAD, tilt_rad
from reports.text.wording import AT_REST_RAD, horizon_s, prediction_s, unlike_motions

VISIBLE_M: Final = 1e-4
"""Less than a tenth of a millimetre is no movement to the eye."""
NEXT_TO_NONE: Final = 0.01
"""Shares whose intervals stay within this of none, or of all, are told as fewer than 1, or more than 99, of 100."""


def context(folder: Path, record: RunRecord, say: Language = ENGLISH) -> dict[str, object]:
    """Everything that the conservator's template shows of a run."""
    return page(record.title, record.versions, of_run(source_of(folder, record), say), say)


def of_run(source: RunSource, say: Language = ENGLISH) -> dict[str, object]:
    """Headline, points and pictures of one run."""
    answered = {name: run for name, run in source.runs.items() if has_answer(run)}
    headline, tone, points = _answer(source, *_nominal(source, answered, say), say)
    scene, motion = source.scene, source.record.motion
    support = support_of(scene)
    said = [*_who(source.runs, answered, say), *_lean(source, say), *_pedestal_slip(source, answered, say)]
    pictures = [reach_picture(source, say), plan_picture(source, say), push_picture(scene, support, say, motion)]
    return {
        "headline": headline,
        "tone": tone,
        "points": [*points, *said, *_trust(source, say)],
        "pictures": [*pictures, order_picture(scene, support, say, motion)],
    }


def _answer(source: RunSource, nominal: str, colour: str, say: Language) -> tuple[str, str, list[str]]:
    """Headline, colour and first points: how probable a fall is where the record says so, then the run as given."""
    if not source.record.assessment:
        # One run is one draw: a shaking that it stands is no reason for green.
        unknown = colour == "agree" and bool(source.record.motion.accel_m_s2)
        return nominal, "differ" if unknown else colour, [say("chance.unknown")] if unknown else []
    item, tone = source.record.assessment[worst(source.record.assessment)], worse_tone(source.record.assessment, colour)
    given = say("chance.given", what=nominal[0].lower() + nominal[1:])
    if item.undecided >= 1.0:
        return say("chance.open"), tone, [given]
    open_ = [say("chance.undecided", share=_share(item.undecided, say))] if item.undecided else []
    known = any(not each.plane_only for each in source.record.assessment.values())
    plane = [say("chance.plane"), *([] if known else [say("chance.plane_open")])] if item.plane_only else []
    points = [say("chance.cases"), *open_, *([" ".join(plane)] if plane else []), given]
    if not item.tells:
        share = _share(item.low, say)
        least = [say("chance.mostly_open", share=share)] if item.low > 0.0 else []
        return say("chance.open"), tone, [*least, *points]
    return _falls(item, say), tone, points


def _falls(item: Assessment, say: Language) -> str:
    """How probable a fall is; next to none and next to all have no digits."""
    if item.high < NEXT_TO_NONE:
        return say("chance.rarely")
    if item.low > 1.0 - NEXT_TO_NONE:
        return say("chance.mostly")
    share, low, high = (_share(value, say) for value in (item.probability_overturned, item.low, item.high))
    return say("chance.falls", share=share, low=low, high=high)


def _share(value: float, say: Language) -> str:
    return probability_text(value).replace(".", say.strings["decimal"])


def _nominal(source: RunSource, answered: Mapping[str, EngineRunRecord], say: Language) -> tuple[str, str]:
    """What happens with the values as given, and its colour."""
    ends = {end_words(run.outcome, say) for run in answered.values()}
    begins = _begins(source, say)
    if not ends:
        return say("run.none"), "failed"
    if len(ends) == 1:
        end = ends.pop()
        return say("run.one_end", begins=begins, end=end), "agree" if end == say("end.stands") else "failed"
    if say("end.falls") in ends:
        return say("run.may_fall", begins=begins), "differ"
    return say("run.disagree"), "differ"


def _begins(source: RunSource, say: Language) -> str:
    """What the statue is put through: shaking, a start off its rest, both or neither."""
    start, shaking = source.scene.initial, bool(source.record.motion.accel_m_s2)
    if start.pose is not None:
        return say("begin.shaking_pose" if shaking else "begin.pose")
    if start.theta_rad:
        lean = say.digits(math.degrees(abs(start.theta_rad)), 2)
        return say("begin.shaking_lean" if shaking else "begin.lean", lean=lean)
    if start.theta_rate_rad_s:
        return say("begin.shaking_turn" if shaking else "begin.turn")
    return say("begin.shaking" if shaking else "begin.alone")


def _who(runs: Mapping[str, EngineRunRecord], answered: Mapping[str, EngineRunRecord], say: Language) -> list[str]:
    """How many models say what; which they are stands in the engineer's report."""
    silent = len(runs) - len(answered)
    none = (
        [say("run.silent_one") if silent == 1 else say("run.silent", count=_begun(say.count(silent)))] if silent else []
    )
    groups: dict[str, int] = {}
    for run in answered.values():
        end = end_words(run.outcome, say)
        groups[end] = groups.get(end, 0) + 1
    if len(answered) == 1:
        return [say("run.answered_one" if silent else "run.asked_one"), *none]
    unlike = [say("run.motion")] if unlike_motions(answered.values()) else []
    if len(groups) == 1:
        sides = {run.outcome for run in answered.values()}
        side = [say("run.only_side")] if len(sides) > 1 and all(Outcome(end).overturned for end in sides) else []
        return [" ".join([say("run.all_agree", count=_begun(say.count(len(answered)))), *side]), *unlike, *none]
    total = say.count(len(answered))
    ends = [
        say("run.some_one" if count == 1 else "run.some", end=end, count=say.count(count), total=total)
        for end, count in groups.items()
    ]
    return [*ends, *unlike, *none]


def _begun(word: str) -> str:
    return word[0].upper() + word[1:]


def _standing(source: RunSource) -> list[str]:
    known = (name for name in source.histories if has_answer(source.runs[name]))
    return [name for name in known if source.runs[name].outcome == Outcome.STANDS]


def _lean(source: RunSource, say: Language) -> list[str]:
    """The greatest lean of the models in which it stands, as a share of the lean from which it does not come back."""
    statue, standing = source.scene.statue, _standing(source)
    worst_share, degrees = 0.0, 0.0
    for name in standing:
        theta = source.histories[name].theta_rad
        for side in (1, -1):
            peak = float((side * theta).max())
            if peak / statue.slenderness_rad(side) > worst_share:
                worst_share, degrees = peak / statue.slenderness_rad(side), math.degrees(peak)
    if not standing:
        return []
    where = [] if len(standing) == len(source.runs) else [say("run.of_standing")]
    if degrees < math.degrees(AT_REST_RAD):
        return [" ".join([*where, say("run.no_rocking")])]
    key = "run.leans" if worst_share < 1.0 else "run.leans_past"
    leans = say(key, degrees=say.digits(degrees, 2), share=f"{100.0 * worst_share:.0f}")
    return [" ".join([*where, leans])]


def _pedestal_slip(source: RunSource, answered: Mapping[str, EngineRunRecord], say: Language) -> list[str]:
    if source.scene.pedestal is None or not answered:
        return []
    most = max(run.peak_slip_m for run in answered.values())
    tilt = max(tilt_rad(run, source.histories.get(name)) for name, run in answered.items())
    tips = [say("run.tips", degrees=say.digits(math.degrees(tilt), 2))] if tilt > TIPS_RAD else []
    if most > VISIBLE_M:
        return [say("run.slides", length=say.length(most)), *tips]
    # A model that says that its pedestal tips, and another whose pedestal hardly does: it is not said to stay put.
    return tips or ([say("run.put")] if all(tips_s(run) is None for run in source.runs.values()) else [])


def _trust(source: RunSource, say: Language) -> list[str]:
    end_s = source.scene.duration_s
    until, predictable_s = horizon_s(source), prediction_s(source)
    if predictable_s is not None and predictable_s < end_s:
        return [f"{say('run.unpredictable', time=say.short(predictable_s, 2))} {say('run.typical')}"]
    if until is not None and until < end_s:
        return [f"{say('run.inexact', time=say.short(until, 2))} {say('run.typical')}"]
    return []


def _extremes(source: RunSource) -> list[tuple[float, float]]:
    """Rotation and the support's displacement at the top's farthest shifts to each side, over the models in which it stands."""
    shape, extremes = section(source.scene), []
    for side in (-1.0, 1.0):
        best: tuple[float, float, float] | None = None
        for name in _standing(source):
            history = source.histories[name]
            moved_m = support_m(source.scene.pedestal, history.slip_m, history.extra)
            moved = side * shape.top_displacement_m(history.theta_rad, moved_m)
            k = int(np.argmax(moved))
            if best is None or moved[k] > best[0]:
                best = (float(moved[k]), float(history.theta_rad[k]), float(moved_m[k]))
        if best is not None and best[0] > VISIBLE_M:
            extremes.append(best[1:])
    return extremes


def reach_picture(source: RunSource, say: Language, heading: str = "reach.heading") -> Picture:
    """How far the statue moves, against its wall; where it moves in no model but falls, its lean of no return."""
    extremes, title = _extremes(source), say(heading)
    words = []
    outline, shape = silhouette_m(source.scene, source.mesh), section(source.scene)
    if extremes:
        words.append(say("reach.dashed"))
    elif _standing(source):
        words.append(say("reach.still"))
    wall = source.scene.wall
    if wall is not None and _standing(source):
        sign = 1.0 if wall.side == "right" else -1.0
        rest = _farthest(outline, shape, (0.0, 0.0), sign)
        edge = shape.corner_right_m if sign > 0 else shape.corner_left_m
        gap = wall.distance_m + edge - rest
        left = gap - _beyond(outline, shape, extremes, sign)
        remains = say("reach.remain", left=say.length(left)) if left > 0 else say("reach.strikes")
        words.append(f"{say('reach.free', gap=say.length(gap))} {remains}")
    fell = [name for name, run in source.runs.items() if run.outcome.overturned]
    if fell:
        total = len(source.runs)
        key = "reach.fell_all" if len(fell) == total else "reach.fell_one" if len(fell) == 1 else "reach.fell"
        words.append(say(key, count=say.count(len(fell)), total=say.count(total)))
    last = _no_return(source, fell) if not extremes else []
    if last:
        words.append(say("reach.no_return"))
    return Picture(title, reach_svg(source, extremes or last, f"{title} {' '.join(words)}", say), words)


def plan_picture(source: RunSource, say: Language) -> Picture:
    """The space that the statue needs while it rocks, all round where a model follows it in space."""
    heading, standing = say("plan.heading"), _standing(source)
    plan = floor_plan(source, standing)
    words = [say("plan.seen")]
    moves = {side: room for side, room in plan.room_m.items() if room > VISIBLE_M}
    if not standing:
        words = [say("plan.none")]
    elif moves:
        words.append(
            say("plan.room", rooms=say.listed(say(f"plan.{s}", length=say.length(r)) for s, r in moves.items()))
        )
    else:
        words.append(say("plan.still"))
    if standing and "front" not in plan.room_m:
        words.append(say("plan.planar"))
    words.append(say("plan.fall", height=say.length(source.scene.statue.height_m)))
    return Picture(heading, plan_svg(source.scene, plan, f"{heading} {' '.join(words)}", say), words)


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
