"""The conservator's page of a run: what happens to the statue, in plain words and pictures; no model is named here."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.model.history import Outcome
from harness.model.run import Run, number
from harness.model.scene import base_shift_m
from harness.questions.scene.answer import STILL_RAD
from harness.records.assess import MOSTLY, Assessment, worst
from harness.records.run import OWN_MOVES, RunRecord, has_answer, peak_slip_m, standing_m, tips_s
from harness.records.scene import MotionRecord, SceneRecord
from harness.records.study import SupportRecord
from reports.blocks import Block, Drawing, Section, Text, Verdict
from reports.drawing.conservator_pictures import order_svg, plan_svg, push_svg, reach_svg
from reports.drawing.display_mesh import silhouette_m
from reports.drawing.floor_plan import Plan, floor_plan
from reports.drawing.kinematics import Array, section
from reports.messages import ENGLISH, Language, probability_text
from reports.source import RunSource, source_of
from reports.text.giving_way import compass, levels, order_words, slips, support_of, weakest_words
from reports.text.wording import TIPS_RAD, horizon_s, prediction_s, tilt_rad, tone, unlike_motions

LIMITS: Final = ("hard", "steady", "friction", "next")
ENDS: Final = {
    Outcome.STANDS: "stands",
    Outcome.TOUCHES_WALL: "wall",
    Outcome.LEFT_PEDESTAL: "left",
    Outcome.LIFT_OFF: "lifted",
    Outcome.UNDECIDED: "undecided",
}
"""The key of each outcome's words; other ends are none that a model can follow."""


def plain_page(
    headline: str,
    tone: str,
    points: Sequence[str],
    todo: Sequence[str],
    pictures: Sequence[Drawing],
    basis: Sequence[str],
    say: Language,
) -> list[Block]:
    """The blocks of every conservator's page: answer with its picture and what to do, further pictures, what it rests on."""
    limits = Text([say(f"limit.{key}") for key in LIMITS], "points")
    return [
        Verdict(headline, tone, points, drawing=pictures[0], todo=todo),
        Section("pictures", "", pictures[1:], "pictures"),
        *([Section("basis", say("page.basis"), [Text(basis, "points")])] if basis else ()),
        Section("limits", say("page.limits"), [limits], "caveat"),
    ]


def end_words(outcome: str, say: Language) -> str:
    """An outcome in a museum's words."""
    kind = Outcome(outcome)
    return say("end.falls" if kind.overturned else f"end.{ENDS.get(kind, 'other')}")


def push_picture(
    scene: SceneRecord,
    support: SupportRecord,
    say: Language,
    motion: MotionRecord | None = None,
    borne: Mapping[float, float] | None = None,
) -> Drawing:
    """Which push the statue bears, by direction, seen from above; `borne` are shakings without a fall by azimuth in degrees."""
    heading = say("push.heading")
    words = [say("push.seen"), f"{weakest_words(scene, say)} {say('push.tipping')}"]
    if support.statue_keys:
        varied = say.listed(dict.fromkeys(say.key(key) or say("key.other") for key in support.statue_keys))
        words.append(say("push.varied", keys=varied))
    # A push of the statue's own weight is none of an earthquake's: no circle is drawn for it.
    sliding = [(push, what) for push, what in slips(support) if push < 1.0]
    circles = list(dict.fromkeys(push for push, _ in sliding))
    if circles:
        words.append(say("push.circle" if len(circles) == 1 else "push.circles", slides=_slides(sliding, say)))
    points = None
    if borne:
        azimuths = sorted(borne)
        turned = np.radians(azimuths)
        points = np.array([borne[key] for key in azimuths])[:, None] * np.column_stack([np.cos(turned), np.sin(turned)])
        worst = min(borne, key=lambda key: borne[key])
        least = say("push.borne_least", side=compass(worst, say), push=say.percent(borne[worst]))
        words.append(f"{say('push.borne')} {least}")
    axes = motion.accel_m_s2.keys() if motion is not None else set()
    if axes & {"x", "y"}:
        words.append(say("push.moment_level" if "z" in axes else "push.moment"))
    drawn = push_svg(scene, motion, circles, f"{heading} {' '.join(words)}", say, points)
    return Drawing(drawn, words, heading=heading)


def _slides(sliding: Sequence[tuple[float, str]], say: Language) -> str:
    """From which pushes what slides."""
    by_body: dict[str, list[float]] = {}
    for push, what in sliding:
        by_body.setdefault(what, []).append(push)
    to = f" {say('push.to')} "
    return say.listed(
        say(f"push.{what}_slides", pushes=to.join(map(say.percent, dict.fromkeys((pushes[0], pushes[-1])))))
        for what, pushes in by_body.items()
    )


def order_picture(
    scene: SceneRecord, support: SupportRecord, say: Language, motion: MotionRecord | None = None
) -> Drawing:
    """What gives way first, and so what the pedestal does for the statue."""
    push = None if motion is None else motion.push
    heading = say("order.heading_pedestal" if list(support.pedestal) == [True] and push else "order.heading")
    words = order_words(scene, support, push, rising=motion is not None and motion.z_m_s2 is not None, say=say)
    peak, title = None if push is None else push.peak, f"{heading} {' '.join(words)}"
    return Drawing(order_svg(levels(scene, support, say), peak, title, say), words, heading=heading)


ASIDE: Final = 1.05
"""A lean that is so much larger than the one in the rocking plane is to the front or back."""
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


def _todo(source: RunSource, answered: Mapping[str, Run], plan: Plan, say: Language) -> list[str]:
    """What the record gives reason to do: room to keep free, a fall to reckon with, remedies to have compared."""
    rooms, unsafe = _rooms(plan, say), tone(source) != "agree"
    slip_m = max(map(peak_slip_m, answered.values()), default=0.0)
    reasons = {
        "free": rooms,
        "wall": any(run.outcome is Outcome.TOUCHES_WALL for run in answered.values()),
        "slide": source.scene.pedestal is not None and slip_m > VISIBLE_M,
        "fall": unsafe and _may_fall(source, answered),
        "ask": unsafe,
    }
    lengths = {"length": say.length(slip_m), "height": say.length(source.scene.statue.height_m)}
    said = [say(f"todo.{key}", rooms=rooms, **lengths) for key, there in reasons.items() if there]
    return said or [say("todo.nothing")]


def _may_fall(source: RunSource, answered: Mapping[str, Run]) -> bool:
    """Whether a fall is to be reckoned with: in a run, among the draws, or because neither tells."""
    chances = (source.record.assessment or {}).values()
    falls = any(run.outcome.overturned for run in answered.values())
    return (
        falls
        or bool(_leaning(source))
        or not (answered and chances)
        or any(item.high >= NEXT_TO_NONE for item in chances)
    )


def _answer(source: RunSource, nominal: str, say: Language) -> tuple[str, list[str]]:
    """The headline, and what it rests on: how probable a fall is where the record says so, else the run as given."""
    if not source.record.assessment:
        # One run is one draw: what it stands says nothing of how probable a fall is.
        shaken = bool(source.record.motion.accel_m_s2)
        return nominal, [say("chance.unknown")] if shaken else []
    item = source.record.assessment[worst(source.record.assessment)]
    # What follows a touch of the wall no model knows: such a draw is undecided, and yet it is known what happens.
    undecided, wall = max(item.undecided - item.touches_wall, 0.0), item.touches_wall
    if undecided >= 1.0:
        return say("chance.open"), []
    open_ = [
        *([say("chance.wall", share=_share(wall, say))] if wall else []),
        *([say("chance.undecided", share=_share(undecided, say))] if undecided else []),
    ]
    known = any(not each.plane_only for each in source.record.assessment.values())
    plane = [say("chance.plane"), *([] if known else [say("chance.plane_open")])] if item.plane_only else []
    basis = [say("chance.cases"), *open_, *([" ".join(plane)] if plane else [])]
    if wall >= MOSTLY:
        often = "wall_always" if wall > 1.0 - NEXT_TO_NONE else "wall_mostly"
        return say(f"chance.{often}", share=f"{100.0 * wall:.0f}"), basis
    return _falls(item, say) if item.tells else say("chance.open"), basis


def _falls(item: Assessment, say: Language) -> str:
    """How probable a fall is; next to none and next to all have no digits."""
    share, low, high = (f"{100.0 * value:.0f}" for value in (item.probability_overturned, item.low, item.high))
    wide = item.high - item.low > WIDE or item.probability_overturned < NEXT_TO_NONE
    sure = "rarely" if item.high < NEXT_TO_NONE else "mostly" if item.low > 1.0 - NEXT_TO_NONE else ""
    sure = "rarely_in_plane" if sure == "rarely" and item.plane_only else sure
    return say(f"chance.{sure or ('between' if wide else 'falls')}", share=share, low=low, high=high)


def _share(value: float, say: Language) -> str:
    return probability_text(value).replace(".", say.strings["decimal"])


def _nominal(source: RunSource, answered: Mapping[str, Run], say: Language) -> str:
    """What happens with the values as given; one that leans past its balance when its run ends is not taken to stay upright."""
    leaning = [source.runs[name].outcome for name in _leaning(source)]
    ends = dict.fromkeys(end_words(outcome, say) for outcome in [*(run.outcome for run in answered.values()), *leaning])
    if not ends:
        return say("run.none")
    key = "one_end" if len(ends) == 1 else "may_fall" if say("end.falls") in ends else "disagree"
    return say(f"run.{key}", begins=_begins(source, say), end=next(iter(ends)))


def _begins(source: RunSource, say: Language) -> str:
    """What the statue is put through: shaking, a start off its rest, both or neither."""
    start, shaken = source.scene.initial, "shaking_" if source.record.motion.accel_m_s2 else ""
    kinds = {"pose": start.pose is not None, "lean": start.theta_rad, "turn": start.theta_rate_rad_s, "alone": True}
    kind = next(name for name, there in kinds.items() if there)
    return say(f"begin.{shaken}{kind}", lean=say.digits(math.degrees(abs(start.theta_rad)), 2))


def _who(runs: Mapping[str, Run], answered: Mapping[str, Run], say: Language) -> list[str]:
    """How many models say what; which they are stands in the engineer's report."""
    silent, total = len(runs) - len(answered), say.count(len(answered))
    none = [say("run.silent_one" if silent == 1 else "run.silent", count=_begun(say.count(silent)))] if silent else []
    if len(answered) == 1:
        return [say("run.answered_one" if silent else "run.asked_one"), *none]
    unlike = [say("run.motion")] if unlike_motions(answered.values()) else []
    ends = Counter(end_words(run.outcome, say) for run in answered.values())
    if len(ends) == 1:
        sides = {run.outcome for run in answered.values()}
        side = [say("run.only_side")] if len(sides) > 1 and all(end.overturned for end in sides) else []
        return [" ".join([say("run.all_agree", count=_begun(total)), *side]), *unlike, *none]
    each = [
        say("run.some_one" if count == 1 else "run.some", end=end, count=say.count(count), total=total)
        for end, count in ends.items()
    ]
    return [*each, *unlike, *none]


def _begun(word: str) -> str:
    return word[0].upper() + word[1:]


def _answering(source: RunSource) -> list[str]:
    """The models that answered and left a history."""
    return [name for name in source.histories if has_answer(source.runs[name])]


def _standing(source: RunSource) -> list[str]:
    return [name for name in _answering(source) if source.runs[name].outcome == Outcome.STANDS]


def _leaning(source: RunSource) -> list[str]:
    """The models whose statue leans past the angle at which it balances when their run ends."""
    found = []
    for name, history in source.histories.items():
        last_rad = float(history.theta_rad[-1])
        past = abs(last_rad) > source.scene.statue.slenderness_rad(1 if last_rad > 0.0 else -1)
        found += [name] if past and source.runs[name].outcome is Outcome.UNDECIDED else []
    return found


def _worst_lean(source: RunSource) -> tuple[float, float, float, int]:
    """The largest lean of the models in which it stands as a share of the angle at which it balances there, both in rad, and the
    side; 0 for the side of one out of the plane of the pictures."""
    leans = [(0.0, 0.0, source.scene.statue.slenderness_rad(1), 1)]
    for name in _standing(source):
        run = source.runs[name]
        for side in (1, -1):
            peak, balance = (
                float((side * source.histories[name].theta_rad).max()),
                source.scene.statue.slenderness_rad(side),
            )
            leans.append((peak / balance, peak, balance, side))
        share, lean = (number(run.validity, f"peak_lean_{what}", 0.0) for what in ("share", "rad"))
        leans += [(share, lean, lean / share, 0)] if lean > ASIDE * run.peak_theta_rad and lean >= STILL_RAD else []
    return max(leans)


def _lean(source: RunSource, say: Language) -> list[str]:
    """The largest lean against the one at which it balances, of the models in which it stands; past it, what brought it back."""
    standing = _standing(source)
    if not standing:
        return []
    share, lean_rad, balance_rad, _ = _worst_lean(source)
    degrees, balance = (say.digits(math.degrees(value), 2) for value in (lean_rad, balance_rad))
    back = "floor_back" if source.record.motion.accel_m_s2 else "swing_back"
    keys = ["no_rocking"] if lean_rad < STILL_RAD else ["leans"] if share < 1.0 else ["leans_past", back]
    keys = keys if standing == _answering(source) and not _leaning(source) else ["of_standing", *keys]
    values = {"degrees": degrees, "balance": balance, "share": f"{100.0 * share:.0f}"}
    moves = [say(f"run.{code}", length=say.length(most_m)) for code, most_m in _own_moves_m(source).items()]
    return [" ".join([*(say(f"run.{key}", **values) for key in keys), *moves])]


def _own_moves_m(source: RunSource) -> dict[str, float]:
    """How far at most the statue slides on its support, and hops, where it stands and that is seen."""
    runs = [source.runs[name] for name in _standing(source)]
    most_m = {
        code: max((standing_m(run, name) or 0.0 for run in runs), default=0.0) for code, name in OWN_MOVES.items()
    }
    return {code: value for code, value in most_m.items() if value > VISIBLE_M}


def _pedestal_slip(source: RunSource, answered: Mapping[str, Run], say: Language) -> list[str]:
    """How far its pedestal slides and tips; that it stays put only where no model says that it tips."""
    if source.scene.pedestal is None or not answered:
        return []
    most = max(map(peak_slip_m, answered.values()))
    tilt = max(tilt_rad(run, source.histories.get(name)) for name, run in answered.items())
    said = [say("run.slides", length=say.length(most))] if most > VISIBLE_M else []
    said += [say("run.tips", degrees=say.digits(math.degrees(tilt), 2))] if tilt > TIPS_RAD else []
    still = all(tips_s(run) is None for run in source.runs.values())
    return said or ([say("run.put")] if still else [])


def _trust(source: RunSource, say: Language) -> list[str]:
    """Until when the motion can be followed: as far as anybody can, else as far as numbers are exact."""
    for key, until_s in (("unpredictable", prediction_s(source)), ("inexact", horizon_s(source))):
        if until_s is not None and until_s < source.scene.duration_s:
            return [f"{say(f'run.{key}', time=say.short(until_s, 2))} {say('run.typical')}"]
    return []


def _extremes(source: RunSource) -> list[tuple[float, float]]:
    """Rotation and the support's displacement at the top's farthest shifts to each side, over the models in which it stands."""
    shape, stone = section(source.scene), source.scene.pedestal
    standing = [source.histories[name] for name in _standing(source)]
    poses = [(item.theta_rad, base_shift_m(stone, item.slip_m, item.extra)) for item in standing]
    extremes = []
    for side in (-1.0, 1.0):
        tops = [(side * shape.top_displacement_m(*pose), *pose) for pose in poses]
        farthest = [(top[k], theta[k], moved[k]) for top, theta, moved in tops for k in [int(np.argmax(top))]]
        top_m, theta_rad, moved_m = map(float, max(farthest, default=(0.0, 0.0, 0.0)))
        extremes += [(theta_rad, moved_m)] if top_m > VISIBLE_M else []
    return extremes


def reach_picture(source: RunSource, say: Language, heading: str = "reach.heading") -> Drawing:
    """Its farthest positions against the lean at which it balances, and its wall; of a statue that falls, the latter alone."""
    extremes, title, standing = _extremes(source), say(heading), _standing(source)
    outline, shape = silhouette_m(source.scene, source.mesh), section(source.scene)
    statue, (_, lean_rad, balance_rad, side) = source.scene.statue, _worst_lean(source)
    own = _own_moves_m(source)
    across = max((number(source.runs[name].validity, "slip_across_m", 0.0) for name in standing), default=0.0)
    aside = side == 0 or (across > VISIBLE_M and not extremes)
    moves = {"dashed": bool(extremes), "aside": aside, "still": not (extremes or aside or own)}
    words = [say(f"reach.{key}") for key, told in moves.items() if told] if standing else []
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
        many = "fell_all" if len(fell) == len(ends) else "fell_one" if len(fell) == 1 else "fell"
        words.append(say(f"reach.{many}", count=say.count(len(fell)), total=say.count(len(ends))))
    sides = {1 if end is Outcome.OVERTURNED_RIGHT else -1 for end in fell if end in SIDEWAYS and not standing}
    if not sides:
        sides = {side if side and lean_rad >= STILL_RAD else min((1, -1), key=statue.slenderness_rad)}
    balance = [side * statue.slenderness_rad(side) for side in sorted(sides)]
    words.append(say("reach.balance"))
    lean = lean_rad if lean_rad >= STILL_RAD else 0.0
    gauge = (lean, balance_rad if lean else statue.slenderness_rad(max(sides))) if standing else None
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
