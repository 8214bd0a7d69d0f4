"""The conservator's page of a run: what happens to the statue, in plain words and pictures; no model is named here."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.model.history import Outcome
from harness.model.in_space import support_m
from harness.model.run import EngineRunRecord
from harness.records.assess import Assessment, worst
from harness.records.run import RunRecord, has_answer, tips_s
from harness.scene_run.answer import STILL_RAD
from reports.blocks import Block, Drawing
from reports.drawing.conservator_pictures import plan_svg, reach_svg
from reports.drawing.display_mesh import silhouette_m
from reports.drawing.floor_plan import Plan, floor_plan
from reports.drawing.kinematics import Array, section
from reports.messages import ENGLISH, Language, probability_text
from reports.pages.conservator_parts import end_words, order_picture, plain_page, push_picture
from reports.source import RunSource, source_of
from reports.text.giving_way import support_of
from reports.text.limits import TIPS_RAD, tilt_rad
from reports.text.wording import horizon_s, prediction_s, tone, unlike_motions

VISIBLE_M: Final = 1e-3
"""Less than a millimetre is no movement that anyone keeps room for."""
NEXT_TO_NONE: Final = 0.01
"""Shares whose intervals stay within this of none, or of all, are told as fewer than 1, or more than 99, of 100."""
SLOW_HZ: Final = 1.05
"""Swings that are not faster are told by how long one takes."""
SIDEWAYS: Final = (Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT)
WIDE: Final = 0.05
"""A wider interval is told beside the share, which is rounded to whole cases of 100."""
STRONG: Final = 0.05
"""From the first to the last instant at which it has this share of its strongest push the shaking lasts."""


def blocks(folder: Path, record: RunRecord, say: Language = ENGLISH) -> list[Block]:
    """The blocks of the conservator's page of a run."""
    return of_run(source_of(folder, record), say)


def of_run(source: RunSource, say: Language = ENGLISH) -> list[Block]:
    """Headline, first points, what to do, pictures, and what the answer rests on, of one run."""
    answered = {name: run for name, run in source.runs.items() if has_answer(run)}
    nominal = _nominal(source, answered, say)
    headline, basis = _answer(source, nominal, say)
    given = [] if headline == nominal else [say("chance.given", what=nominal[0].lower() + nominal[1:])]
    support, motion = support_of(source.scene), source.record.motion
    plan = floor_plan(source, _standing(source))
    points = [*_shaking(source, say), *given, *_lean(source, say)]
    pictures = [
        reach_picture(source, say),
        plan_picture(source, plan, _pedestal_slip(source, answered, say), say),
        push_picture(source.scene, support, say, motion),
        order_picture(source.scene, support, say, motion),
    ]
    rests = [*basis, *_who(source.runs, answered, say), *_trust(source, say)]
    return plain_page(headline, tone(source), points, _todo(source, answered, plan, say), pictures, rests, say)


def _shaking(source: RunSource, say: Language) -> list[str]:
    """How strong the shaking is, along what, how fast it swings where its scene says so, and how long it is strong."""
    motion, asked = source.record.motion, source.scene.toml.get("motion")
    axes = motion.accel_m_s2
    if not axes:
        return []
    push, g_m_s2 = motion.push, source.scene.gravity_m_s2
    peak = max(map(motion.peak_m_s2, axes)) / g_m_s2 if push is None else push.peak
    where = "_".join(["level"] if {"x", "y"} <= axes.keys() else [axis for axis in ("x", "y") if axis in axes])
    ways = [say(f"shaking.{name}") for name in (where, "z" if "z" in axes else "") if name]
    specs = [asked.get(axis) for axis in axes] if isinstance(asked, dict) else []
    kinds = {spec.get("kind") if isinstance(spec, dict) else None for spec in specs}
    rates = {spec["frequency_hz"] for spec in specs if isinstance(spec, dict) and kinds == {"harmonic"}}
    pace = say("shaking.record") if kinds == {"record"} else ""
    if len(rates) == 1 and isinstance(rate := rates.pop(), int | float):
        fast = rate > SLOW_HZ
        pace = say("shaking.fast" if fast else "shaking.slow", count=say.short(rate if fast else 1.0 / rate, 2))
    strong = np.zeros(len(motion.t_s), dtype=bool)
    for values in axes.values():
        size = np.abs(values)
        strong |= size >= STRONG * size.max()
    at = np.asarray(motion.t_s)[strong]
    lasts = say.short(float(at[-1] - at[0]), 2)
    return [say("shaking.of", push=say.percent(peak), ways=say.listed(ways), pace=pace, time=lasts)]


def _todo(source: RunSource, answered: Mapping[str, EngineRunRecord], plan: Plan, say: Language) -> list[str]:
    """What the record gives reason to do: room to keep free, a fall to reckon with, remedies to have compared."""
    rooms = _rooms(plan, say)
    said = [say("todo.free", rooms=rooms)] if rooms else []
    if any(run.outcome is Outcome.TOUCHES_WALL for run in answered.values()):
        said.append(say("todo.wall"))
    slip_m = max((run.peak_slip_m for run in answered.values()), default=0.0)
    if source.scene.pedestal is not None and slip_m > VISIBLE_M:
        said.append(say("todo.slide", length=say.length(slip_m)))
    if tone(source) != "agree":
        if _may_fall(source, answered):
            said.append(say("todo.fall", height=say.length(source.scene.statue.height_m)))
        said.append(say("todo.ask"))
    return said or [say("todo.nothing")]


def _may_fall(source: RunSource, answered: Mapping[str, EngineRunRecord]) -> bool:
    """Whether a fall is to be reckoned with: in a run, among the draws, or because neither tells."""
    chances = (source.record.assessment or {}).values()
    falls = any(run.outcome.overturned for run in answered.values())
    return falls or not (answered and chances) or any(item.high >= NEXT_TO_NONE for item in chances)


def _answer(source: RunSource, nominal: str, say: Language) -> tuple[str, list[str]]:
    """The headline, and what it rests on: how probable a fall is where the record says so, else the run as given."""
    if not source.record.assessment:
        # One run is one draw: what it stands says nothing of how probable a fall is.
        shaken = bool(source.record.motion.accel_m_s2)
        return nominal, [say("chance.unknown")] if shaken else []
    item = source.record.assessment[worst(source.record.assessment)]
    if item.undecided >= 1.0:
        return say("chance.open"), []
    open_ = [say("chance.undecided", share=_share(item.undecided, say))] if item.undecided else []
    known = any(not each.plane_only for each in source.record.assessment.values())
    plane = [say("chance.plane"), *([] if known else [say("chance.plane_open")])] if item.plane_only else []
    basis = [say("chance.cases"), *open_, *([" ".join(plane)] if plane else [])]
    return _falls(item, say) if item.tells else say("chance.open"), basis


def _falls(item: Assessment, say: Language) -> str:
    """How probable a fall is; next to none and next to all have no digits."""
    if item.high < NEXT_TO_NONE:
        return say("chance.rarely")
    if item.low > 1.0 - NEXT_TO_NONE:
        return say("chance.mostly")
    share, low, high = (f"{100.0 * value:.0f}" for value in (item.probability_overturned, item.low, item.high))
    wide = item.high - item.low > WIDE or item.probability_overturned < NEXT_TO_NONE
    return say("chance.between", share=share, low=low, high=high) if wide else say("chance.falls", share=share)


def _share(value: float, say: Language) -> str:
    return probability_text(value).replace(".", say.strings["decimal"])


def _nominal(source: RunSource, answered: Mapping[str, EngineRunRecord], say: Language) -> str:
    """What happens with the values as given."""
    ends = {end_words(run.outcome, say) for run in answered.values()}
    begins = _begins(source, say)
    if not ends:
        return say("run.none")
    if len(ends) == 1:
        return say("run.one_end", begins=begins, end=ends.pop())
    if say("end.falls") in ends:
        return say("run.may_fall", begins=begins)
    return say("run.disagree")


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


def _answering(source: RunSource) -> list[str]:
    """The models that answered and left a history."""
    return [name for name in source.histories if has_answer(source.runs[name])]


def _standing(source: RunSource) -> list[str]:
    return [name for name in _answering(source) if source.runs[name].outcome == Outcome.STANDS]


def _worst_lean(source: RunSource) -> tuple[float, float, int]:
    """The largest lean of the models in which it stands as a share of its side's balance angle, in rad, and the side."""
    leans = [(0.0, 0.0, 1)]
    for name in _standing(source):
        for side in (1, -1):
            peak = float((side * source.histories[name].theta_rad).max())
            leans.append((peak / source.scene.statue.slenderness_rad(side), peak, side))
    return max(leans)


def _lean(source: RunSource, say: Language) -> list[str]:
    """The largest lean against the one at which it balances, of the models in which it stands; past it, what brought it back."""
    standing = _standing(source)
    if not standing:
        return []
    share, lean_rad, side = _worst_lean(source)
    where = (
        []
        if all(source.runs[name].outcome == Outcome.STANDS for name in _answering(source))
        else [say("run.of_standing")]
    )
    if lean_rad < STILL_RAD:
        return [" ".join([*where, say("run.no_rocking")])]
    degrees, balance = (
        say.digits(math.degrees(value), 2) for value in (lean_rad, source.scene.statue.slenderness_rad(side))
    )
    if share < 1.0:
        leans = say("run.leans", degrees=degrees, share=f"{100.0 * share:.0f}", balance=balance)
    else:
        back = "run.floor_back" if source.record.motion.accel_m_s2 else "run.swing_back"
        leans = f"{say('run.leans_past', degrees=degrees, balance=balance)} {say(back)}"
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


def reach_picture(source: RunSource, say: Language, heading: str = "reach.heading") -> Drawing:
    """Its farthest positions against the lean at which it balances, and its wall; of a statue that falls, the latter alone."""
    extremes, title, standing = _extremes(source), say(heading), _standing(source)
    outline, shape = silhouette_m(source.scene, source.mesh), section(source.scene)
    words = [say("reach.dashed") if extremes else say("reach.still")] if standing else []
    wall = source.scene.wall
    if wall is not None and standing:
        sign = 1.0 if wall.side == "right" else -1.0
        rest = _farthest(outline, shape, (0.0, 0.0), sign)
        edge = shape.corner_right_m if sign > 0 else shape.corner_left_m
        gap = wall.distance_m + edge - rest
        left = gap - _beyond(outline, shape, extremes, sign)
        remains = say("reach.remain", left=say.length(left)) if left > 0 else say("reach.strikes")
        words.append(f"{say('reach.free', gap=say.length(gap))} {remains}")
    ends = [run.outcome for run in source.runs.values() if has_answer(run)]
    fell = [end for end in ends if end.overturned]
    if fell:
        key = "reach.fell_all" if len(fell) == len(ends) else "reach.fell_one" if len(fell) == 1 else "reach.fell"
        words.append(say(key, count=say.count(len(fell)), total=say.count(len(ends))))
    statue, (_, lean_rad, side) = source.scene.statue, _worst_lean(source)
    sides = {1 if end is Outcome.OVERTURNED_RIGHT else -1 for end in fell if end in SIDEWAYS and not standing}
    if not sides:
        sides = {side if lean_rad >= STILL_RAD else min((1, -1), key=statue.slenderness_rad)}
    balance = [side * statue.slenderness_rad(side) for side in sorted(sides)]
    words.append(say("reach.balance"))
    lean = lean_rad if lean_rad >= STILL_RAD else 0.0
    gauge = (lean, statue.slenderness_rad(max(sides))) if standing else None
    drawn = reach_svg(source, extremes, balance, gauge, f"{title} {' '.join(words)}", say)
    return Drawing(drawn, words, heading=title)


def _rooms(plan: Plan, say: Language) -> str:
    """The room needed beyond the outline at rest, by side; what nobody sees is not told."""
    return say.listed(
        say(f"plan.{side}", length=say.length(room)) for side, room in plan.room_m.items() if room > VISIBLE_M
    )


def plan_picture(source: RunSource, plan: Plan, slip: Sequence[str], say: Language) -> Drawing:
    """The space that the statue needs while it rocks, all round where a model follows it in space, and its pedestal's slip."""
    heading, standing = say("plan.heading"), _standing(source)
    rooms = _rooms(plan, say)
    words = [say("plan.seen"), *([say("plan.stone")] if source.scene.pedestal is not None else [])]
    words.append(say("plan.room", rooms=rooms) if rooms else say("plan.still"))
    if not standing:
        words = [say("plan.none")]
    elif "front" not in plan.room_m:
        words.append(say("plan.planar"))
    words += slip
    shown = Plan(plan.rest_m, plan.moved_m, {side: room for side, room in plan.room_m.items() if room > VISIBLE_M})
    drawn = plan_svg(source.scene, shown, f"{heading} {' '.join(words)}", say)
    return Drawing(drawn, words, heading=heading)


def _farthest(outline: Array, shape: Any, pose: tuple[float, float], sign: float) -> float:
    return float((sign * shape.posed_m(outline, *pose)[0][:, 0]).max())


def _beyond(outline: Array, shape: Any, poses: Sequence[tuple[float, float]], sign: float) -> float:
    """How far the outline at these poses stands out beyond its own outline at rest, on one side."""
    rest = _farthest(outline, shape, (0.0, 0.0), sign)
    return max([0.0, *(_farthest(outline, shape, pose, sign) - rest for pose in poses)])
