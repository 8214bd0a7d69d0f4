"""The conservator's page of a run or a study: what happens to the statue, in plain words and pictures; no model is named here."""

import itertools
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from harness.model import Array, Outcome, grouped, number
from harness.records.assess import CONTRADICTED, MOSTLY, Assessment, worst
from harness.records.effects3d import EffectsRecord
from harness.records.run import STILL_RAD, RunRecord, own_moves, tips_s, unconfirmed
from harness.records.scene import MotionRecord, SceneRecord
from harness.records.study import StudyRecord, StudyRow, SupportRecord
from reports.blocks import Block, Drawing, Section, Text, Verdict
from reports.charts.figure import localised, still
from reports.drawing.kinematics import poses, room_m, sampled, top_shift_m
from reports.drawing.pictures import (
    Picture,
    Plan,
    compass,
    floor_plan,
    levels,
    order_sketch,
    order_words,
    plan_sketch,
    push_sketch,
    reach_sketch,
    scan_turn_deg,
    slips,
    support_of,
    weakest_words,
)
from reports.messages import ENGLISH, Language, probability_text, split_unit
from reports.source import (
    TIPS_RAD,
    Answers,
    Condition,
    RunSource,
    doubted,
    end_key,
    horizon_s,
    pedestal_moves,
    prediction_s,
    run_source,
    source_of,
    told_family,
    tone,
    tone_of_study,
)

LIMITS: Final = ("hard", "steady", "friction", "next")


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
    return [
        Verdict(headline, tone, points, drawing=pictures[0], todo=todo),
        Section("pictures", "", pictures[1:], "pictures"),
        *([Section("basis", say("page.basis"), [Text(basis, "points")])] if basis else ()),
        Section("limits", say("page.limits"), [Text([say(f"limit.{key}") for key in LIMITS], "points")], "caveat"),
    ]


def told(say: Language, sentences: Mapping[str, object], **values: object) -> list[str]:
    """Of sentences of the catalogue those that hold, in their order."""
    return [say(key, **values) for key, holds in sentences.items() if holds]


def pictured(heading: str, words: Sequence[str], sketch: Picture) -> Drawing:
    """A picture, described by what stands over and below it."""
    return Drawing(sketch.svg(f"{heading} {' '.join(words)}", "plain"), words, heading=heading)


def begun(text: str) -> str:
    """A text as a sentence begins."""
    return text[0].upper() + text[1:]


def push_picture(
    scene: SceneRecord,
    support: SupportRecord,
    say: Language,
    motion: MotionRecord | None = None,
    borne: Mapping[float, float] | None = None,
) -> Drawing:
    """Which push the statue bears, by direction, seen from above; `borne` are shakings without a fall by azimuth in degrees."""
    # Of a statue that was turned the line of what it bore, by direction, is drawn.
    keys = [key for key in support.statue_keys if not (borne and key.endswith("azimuth_deg"))]
    varied = say.listed(dict.fromkeys(say.key(key) or say("key.other") for key in keys))
    # A push of the statue's own weight is none of an earthquake's: no circle is drawn for it.
    sliding = [(push, what) for push, what in slips(support) if push < 1.0]
    circles = list(dict.fromkeys(push for push, _ in sliding))
    axes = motion.accel_m_s2.keys() if motion is not None else set()
    stood = borne or {}
    worst = min(stood, key=lambda azimuth: stood[azimuth], default=0.0)
    said = {
        "push.seen": True, "push.tipping": True, "push.varied": keys, "push.circle": len(circles) == 1,
        "push.circles": len(circles) > 1, "push.borne": borne, "push.moment_level": axes & {"x", "y"} and "z" in axes,
        "push.moment": axes & {"x", "y"} and "z" not in axes,
    }  # fmt: skip
    words = told(
        say, said, weakest=weakest_words(scene, say), keys=varied, slides=_slides(sliding, say), side=compass(worst, say),
        push=say.percent(stood.get(worst, 0.0)),
    )  # fmt: skip
    return pictured(say("push.heading"), words, push_sketch(scene, motion, circles, stood, say))


def _slides(sliding: Sequence[tuple[float, str]], say: Language) -> str:
    """From which pushes what slides."""
    by_body, to = grouped((what, push) for push, what in sliding), f" {say('push.to')} "
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
    peak, across = None if push is None else push.peak, motion is not None and "y" in motion.accel_m_s2
    return pictured(heading, words, order_sketch(levels(scene, support, say, across=across), peak, say))


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
TIE: Final = "outcome_not_predictable"
"""The finding of a run that ends otherwise by small changes."""
STRONG: Final = 0.05
"""From the first to the last instant at which it has this share of its strongest push the shaking lasts."""


def blocks(folder: Path, record: RunRecord | StudyRecord | EffectsRecord, say: Language = ENGLISH) -> list[Block]:
    """The blocks of the conservator's page of a run, a study or an effects study."""
    if isinstance(record, RunRecord):
        return of_run(source_of(folder, record), say)
    return of_study(record, say) if isinstance(record, StudyRecord) else of_effects(folder, record, say)


def of_run(source: RunSource, say: Language = ENGLISH) -> list[Block]:
    """Headline, first points, what to do, pictures, and what the answer rests on, of one run."""
    source = source.within_domain
    nominal = _nominal(source, say)
    headline, open_, basis = _answer(source, nominal, say)
    given = [] if headline == nominal else [say("chance.given", what=nominal[0].lower() + nominal[1:])]
    support, motion = support_of(source.scene), source.record.motion
    plan = floor_plan(source, source.standing)
    said = [] if source.record.answer is None else source.record.answer.findings
    tie = any(each.code == TIE and "overturned" in each.values["outcomes"] for each in said)
    points = [*open_, *_shaking(source, say), *given, *told(say, {"run.tie": tie}), *_lean(source, say)]
    pictures = [
        reach_picture(source, say),
        plan_picture(source, plan, _pedestal_slip(source, say), say),
        push_picture(source.scene, support, say, motion),
        order_picture(source.scene, support, say, motion),
    ]
    rests = [*basis, *_who(source, say), *_trust(source, say)]
    return plain_page(headline, tone(source), points, _todo(source, plan, say), pictures, rests, say)


ALTERED: Final = frozenset({"pga_g", "pgv_m_s", "floor"})
"""Beside a factor, keys of a record's component by which the floor does not move as it was recorded."""


def _shaking(source: RunSource, say: Language) -> list[str]:
    """How strong the shaking is, along what, how fast it swings where its scene says so, and how long it is strong."""
    motion, asked = source.record.motion, source.scene.toml.get("motion")
    axes = motion.accel_m_s2
    if not axes:
        return []
    peaks: dict[str, float] = {axis: motion.peak_m_s2(axis) / source.scene.gravity_m_s2 for axis in axes}
    if motion.push is not None and {"x", "y"} <= axes.keys():
        peaks = {"level": motion.push.peak} | {axis: peak for axis, peak in peaks.items() if axis == "z"}
    ways = [say(f"shaking.{name}", push=say.percent(peak)) for name, peak in peaks.items()]
    specs = [asked.get(axis) for axis in axes] if isinstance(asked, dict) else []
    kinds = {spec.get("kind") if isinstance(spec, dict) else None for spec in specs}
    rates = {spec["frequency_hz"] for spec in specs if isinstance(spec, dict) and kinds == {"harmonic"}}
    given = [each for each in (asked, *specs) if isinstance(each, dict)]
    altered = any(each.get("scale", 1.0) not in (1.0, -1.0) or each.keys() & ALTERED for each in given)
    pace = say("shaking.altered" if altered else "shaking.record") if kinds == {"record"} else ""
    if len(rates) == 1 and isinstance(rate := rates.pop(), int | float):
        fast = rate > SLOW_HZ
        pace = say("shaking.fast" if fast else "shaking.slow", count=say.short(rate if fast else 1.0 / rate, 2))
    sizes = [np.abs(values) for values in axes.values()]
    strong = np.any([size >= STRONG * size.max() for size in sizes], axis=0)
    at = np.asarray(motion.t_s)[strong]
    return [say("shaking.of", ways=say.listed(ways), pace=pace, time=say.short(float(at[-1] - at[0]), 2))]


def _todo(source: RunSource, plan: Plan, say: Language) -> list[str]:
    """What the record gives reason to do: room to keep free, a fall to reckon with, remedies to have compared."""
    rooms, unsafe, answered = _rooms(plan, say), tone(source) != "agree", source.answered
    under_m = 0.0 if source.scene.pedestal is None else source.scene.pedestal.height_m
    slips, tilts = pedestal_moves(source)
    # Where it tips, its top goes farther than its slip.
    stone_m = max((slips[name] + under_m * math.sin(tilt) for name, tilt in tilts.items()), default=0.0)
    reasons = {
        "todo.free": rooms,
        "todo.wall": any(run.outcome is Outcome.TOUCHES_WALL for run in answered.values())
        or any(item.touches_wall >= NEXT_TO_NONE for item in (source.record.assessment or {}).values()),
        "todo.slide": stone_m > VISIBLE_M,
        "todo.fall": unsafe and _may_fall(source),
        "todo.ask": unsafe,
    }
    height = say.length(under_m + source.scene.statue.height_m)
    return told(say, reasons, rooms=rooms, length=say.length(stone_m), height=height) or [say("todo.nothing")]


def _may_fall(source: RunSource) -> bool:
    """Whether a fall is to be reckoned with: in a run, among the draws of which the headline tells, or because neither tells."""
    chances = source.record.assessment
    return (
        any(run.outcome.overturned for run in source.answered.values())
        or bool(_leaning(source))
        or not (source.answered and chances)
        or chances[worst(chances)].high >= NEXT_TO_NONE
    )


def _answer(source: RunSource, nominal: str, say: Language) -> tuple[str, list[str], list[str]]:
    """The headline: how probable a fall is where the record says so, else the run as given; which cases it leaves open, and what
    it rests on."""
    if not source.record.assessment:
        # One run is one draw: what it stands says nothing of how probable a fall is.
        return nominal, [], [say("chance.unknown")] if source.record.motion.accel_m_s2 else []
    item = source.record.assessment[worst(source.record.assessment)]
    # What follows a touch of the wall no model knows: such a draw is undecided, and yet it is known what happens.
    undecided, wall = max(item.undecided - item.touches_wall, 0.0), item.touches_wall
    # Where draws leave it open, an end other than standing of the values as given is more than no answer.
    ends = [run.outcome for run in source.answered.values()]
    unknown = nominal if any(end is not Outcome.STANDS for end in ends) else say("chance.open")
    if undecided >= 1.0:
        return unknown, [], []
    left = {"wall": wall, "undecided": undecided}
    open_ = {key: say(f"chance.{key}", share=_share(share, say)) for key, share in left.items() if share}
    known = any(not each.plane_only for each in source.record.assessment.values())
    plane = [" ".join(told(say, {"chance.plane": True, "chance.plane_open": not known}))] if item.plane_only else []
    said = [] if source.record.answer is None else source.record.answer.findings
    if any(CONTRADICTED in each.values.get("planar", ()) for each in said):
        # What makes it end otherwise as given is in none of the draws.
        return nominal, [], [f"{_falls(item, say)}.", say("chance.cases"), *open_.values(), *plane]
    # Beside a share of falls stand the cases of which it does not tell, unless they are next to none.
    beside = [text for key, text in open_.items() if item.tells and wall < MOSTLY and left[key] >= NEXT_TO_NONE]
    rest = [text for text in open_.values() if text not in beside]
    basis = [say("chance.cases"), *rest, *plane]
    if wall >= MOSTLY:
        often = "wall_always" if wall > 1.0 - NEXT_TO_NONE else "wall_mostly"
        return say(f"chance.{often}", share=f"{100.0 * wall:.0f}"), beside, basis
    return _falls(item, say) if item.tells else unknown, beside, basis


def _falls(item: Assessment, say: Language) -> str:
    """How probable a fall is; next to none and next to all have no digits."""
    share, low, high = (f"{100.0 * value:.0f}" for value in (item.probability_overturned, item.low, item.high))
    told = NEXT_TO_NONE <= item.probability_overturned <= 1.0 - NEXT_TO_NONE
    wide = item.high - item.low > WIDE or not told
    sure = "rarely" if item.high < NEXT_TO_NONE else "mostly" if item.low > 1.0 - NEXT_TO_NONE else ""
    sure = "rarely_in_plane" if sure == "rarely" and item.plane_only else sure
    return say(
        f"chance.{sure or ('up_to' if share == '0' else 'between' if wide else 'falls')}",
        share=share,
        low=low,
        high=high,
    )


def _share(value: float, say: Language) -> str:
    return probability_text(value).replace(".", say.strings["decimal"])


def _nominal(source: RunSource, say: Language) -> str:
    """What happens with the values as given; one that leans past its balance when its run ends is not taken to stay upright."""
    leaning = [source.runs[name].outcome for name in _leaning(source)]
    answered = [run.outcome for run in source.answered.values()]
    ends = list(dict.fromkeys(map(end_key, [*answered, *leaning])))
    if not ends:
        return say("run.none")
    key = "one_end" if len(ends) == 1 else "may_fall" if "overturns" in ends else "disagree"
    return say(f"run.{key}", begins=_begins(source, say), end=say(f"end.{ends[0]}"))


def _begins(source: RunSource, say: Language) -> str:
    """What the statue is put through: shaking, a start off its rest, both or neither."""
    start, shaken = source.scene.initial, "shaking_" if source.record.motion.accel_m_s2 else ""
    lean, turn = start.theta_rad, start.theta_rate_rad_s
    kinds = {"pose": start.pose is not None, "lean_turn": lean and turn, "lean": lean, "turn": turn, "alone": True}
    kind = next(name for name, there in kinds.items() if there)
    return say(f"begin.{shaken}{kind}", lean=say.digits(math.degrees(abs(lean)), 2))


def _who(source: RunSource, say: Language) -> list[str]:
    """How many models say what; which they are stands in the engineer's report."""
    answered = source.answered
    silent, total = len(source.runs) - len(answered) - len(_leaning(source)), say.count(len(answered))
    # Not all models were given the same axes of the floor's motion.
    axes = {tuple(run.motion_axes) for run in answered.values() if run.motion_axes is not None}
    ends, alone = Counter(end_key(run.outcome) for run in answered.values()), len(answered) == 1
    sides = {run.outcome for run in answered.values() if run.outcome.overturned}
    agree = {"run.all_agree": not alone and len(ends) == 1, "run.only_side": len(ends) == 1 and len(sides) > 1}
    some = {end: count for end, count in ends.items() if len(ends) > 1}
    beside = {
        "run.answered_one": alone and silent, "run.asked_one": alone and not silent, "run.motion": not alone and len(axes) > 1,
        "run.silent_one": silent == 1, "run.silent": silent > 1,
    }  # fmt: skip
    outside = dict.fromkeys(end_key(answered[name].outcome) for name in unconfirmed(answered))
    return [
        *filter(None, [" ".join(told(say, agree, count=begun(total)))]),
        *(
            say(
                "run.some_one" if count == 1 else "run.some", end=say(f"end.{end}"), count=say.count(count), total=total
            )
            for end, count in some.items()
        ),
        *told(say, beside, count=begun(say.count(silent))),
        *(say("run.outside", end=say(f"end.{end}")) for end in outside),
    ]


def _leaning(source: RunSource) -> list[str]:
    """The models whose statue leans past the angle at which it balances when their run ends."""
    ends = {name: float(each.theta_rad[-1]) for name, each in source.histories.items()}
    statue, undecided = source.scene.statue, [name for name in ends if source.runs[name].outcome is Outcome.UNDECIDED]
    return [name for name in undecided if abs(ends[name]) > statue.slenderness_rad(1 if ends[name] > 0.0 else -1)]


def _worst_lean(source: RunSource) -> tuple[float, float, float, int]:
    """The largest lean of the models in which it stands as a share of the angle at which it balances there, alone or as one body
    with a pedestal that tips, both in rad, and the side; 0 for the side of one out of the plane of the pictures."""
    statue = source.scene.statue
    leans = [(0.0, 0.0, statue.slenderness_rad(1), 1)]
    for name in source.standing:
        run, theta_rad = source.runs[name], source.histories[name].theta_rad
        peaks = ((float((side * theta_rad).max()), statue.slenderness_rad(side), side) for side in (1, -1))
        share, _, balance, side = max((peak / balance, peak, balance, side) for peak, balance, side in peaks)
        share = max(share, number(run.validity, "peak_over_slenderness", 0.0))
        leans.append((share, share * balance, balance, side))
        for what in ("pedestal_tilt", "peak_lean"):
            share, lean = (number(run.validity, f"{what}_{of}", 0.0) for of in ("share", "rad"))
            if share and lean >= STILL_RAD:
                # In space another lean than the largest may be the nearest to its balance.
                balance = number(run.validity, f"{what}_balance_rad", lean / share)
                leans.append((share, share * balance, balance, 0 if lean > ASIDE * run.peak_theta_rad else side))
    return max(leans)


def _lean(source: RunSource, say: Language) -> list[str]:
    """The largest lean against the one at which it balances, of the models in which it stands; past it, what brought it back."""
    standing = source.standing
    if not standing:
        return []
    share, lean_rad, balance_rad, _ = _worst_lean(source)
    degrees, balance = (say.digits(math.degrees(value), 2) for value in (lean_rad, balance_rad))
    rocks, past, shaken = lean_rad >= STILL_RAD, share >= 1.0, bool(source.record.motion.accel_m_s2)
    followed = [name for name in source.histories if name in source.answered]
    said = {
        "run.of_standing": standing != followed or _leaning(source), "run.no_rocking": not rocks,
        "run.leans": rocks and not past, "run.leans_past": rocks and past, "run.floor_back": rocks and past and shaken,
        "run.swing_back": rocks and past and not shaken,
    }  # fmt: skip
    moves = [
        say(f"run.{code}", length=say.length(most), degrees=say.digits(math.degrees(most), 2))
        for code, most in _own_moves(source).items()
    ]
    leans = told(say, said, degrees=degrees, balance=balance, share=_share(share, say))
    return [" ".join([*leans, *moves, *told(say, {"run.slides_unknown": _slides_unknown(source)})])]


def _slides_unknown(source: RunSource) -> bool:
    """Whether it stands only in models that say that it slides on its support, and do not compute how far."""
    ends = [source.runs[name].validity.get("left_domain_by") for name in source.standing]
    return bool(ends) and all(each == "statue_slides" for each in ends)


def _own_moves(source: RunSource) -> dict[str, float]:
    """How the statue moves on its support where it stands, and how far at most."""
    found = own_moves({name: source.runs[name] for name in source.standing})
    return {code: max(models.values()) for code, models in found.items()}


def _pedestal_slip(source: RunSource, say: Language) -> list[str]:
    """How far its pedestal slides and tips; that it stays put only where no model says that it tips."""
    slips, tilts = pedestal_moves(source)
    if not slips:
        return []
    most, tilt = max(slips.values()), max(tilts.values())
    moves = {"run.slides": most > VISIBLE_M, "run.tips": tilt > TIPS_RAD}
    said = told(say, moves, length=say.length(most), degrees=say.digits(math.degrees(tilt), 2))
    return said or told(say, {"run.put": all(tips_s(run) is None for run in source.runs.values())})


def _trust(source: RunSource, say: Language) -> list[str]:
    """Until when the motion can be followed: as far as anybody can, else as far as numbers are exact."""
    falls = [run.no_return_time_s for run in source.answered.values()]
    for key, until_s in (("unpredictable", prediction_s(source)), ("inexact", horizon_s(source))):
        if until_s is not None and all(fall_s is not None and fall_s <= until_s for fall_s in falls):
            return []  # what follows is the fall
        if until_s is not None and until_s < source.scene.duration_s:
            return [f"{say(f'run.{key}', time=say.short(until_s, 2))} {say('run.typical')}"]
    return []


def _extremes(scene: SceneRecord, moves: Sequence[Mapping[str, Array]]) -> list[dict[str, Array]]:
    """Of all poses those of the top's farthest shifts to each side."""
    extremes = []
    for side in (-1.0, 1.0):
        tops = [(side * top_shift_m(scene, pose)[:, 0], pose) for pose in moves]
        top_m, pose = max(tops, key=lambda each: each[0].max(), default=(np.zeros(1), {}))
        farthest = [int(np.argmax(top_m))]
        extremes += [{name: values[farthest] for name, values in pose.items()}] if top_m.max() > VISIBLE_M else []
    return extremes


def reach_picture(source: RunSource, say: Language, before: Sequence[str] = ()) -> Drawing:
    """Its farthest positions against the lean at which it balances, and its wall; of a statue that falls, the latter alone."""
    scene, standing = source.scene, source.standing
    moved = [poses(scene, sampled(source.histories[name])) for name in standing]
    extremes = _extremes(scene, moved)
    (_, lean_rad, balance_rad, side), statue = _worst_lean(source), scene.statue
    across = max((number(source.runs[name].validity, "slip_across_m", 0.0) for name in standing), default=0.0)
    aside = side == 0 or (across > VISIBLE_M and not extremes)
    ends = [run.outcome for run in source.answered.values()]
    fell = [end for end in ends if end.overturned]
    gap, left = room_m(scene, poses(scene, {})), min((room_m(scene, pose) for pose in moved), default=math.inf)
    said = {
        "reach.fell_all": fell == ends != [], "reach.fell_one": len(fell) == 1 < len(ends),
        "reach.fell": 1 < len(fell) < len(ends),
        # What follows is not of all models: beside a fall it stood that the statue does not move.
        "run.of_standing": fell and standing, "reach.dashed": extremes, "reach.aside": aside and standing,
        "reach.still": standing and not (extremes or aside or _own_moves(source) or _slides_unknown(source)),
        "reach.free": left < math.inf, "reach.remain": 0.0 < left < math.inf, "reach.strikes": left <= 0.0,
        "reach.balance": True,
    }  # fmt: skip
    counts = {"count": say.count(len(fell)), "total": say.count(len(ends))}
    words = [*before, *told(say, said, **counts, gap=say.length(gap), left=say.length(left))]
    sides = {1 if end is Outcome.OVERTURNED_RIGHT else -1 for end in fell if end in SIDEWAYS and not standing}
    if not sides:
        sides = {side if side and lean_rad >= STILL_RAD else min((1, -1), key=statue.slenderness_rad)}
    balance = [side * statue.slenderness_rad(side) for side in sorted(sides)]
    lean = lean_rad if lean_rad >= STILL_RAD else 0.0
    shown = standing and (lean or not fell)
    gauge = (lean, balance_rad if lean else statue.slenderness_rad(max(sides))) if shown else None
    return pictured(say("reach.heading"), words, reach_sketch(source, extremes, balance, gauge, say))


def _rooms(plan: Plan, say: Language) -> str:
    """The room needed beyond the outline at rest, by side; what nobody sees is not told."""
    told = {
        side: say("plan.more", length=say.length(room)) if side == plan.struck else say.length(room)
        for side, room in plan.room_m.items()
        if room > VISIBLE_M
    }
    return say.listed(say(f"plan.{side}", length=length) for side, length in told.items())


def plan_picture(source: RunSource, plan: Plan, slip: Sequence[str], say: Language) -> Drawing:
    """The space that the statue needs while it moves, all round where a model follows it in space, and its pedestal's slip."""
    rooms, unknown = _rooms(plan, say), _slides_unknown(source)
    said = {
        "run.of_standing": any(run.outcome.overturned for run in source.answered.values()), "plan.seen": rooms,
        "run.slides_unknown": unknown and not rooms, "plan.still": not (rooms or unknown),
        "plan.stone": source.scene.pedestal is not None, "plan.room": rooms, "plan.planar": "front" not in plan.room_m,
    }  # fmt: skip
    words = [*told(say, said if source.standing else {"plan.none": True}, rooms=rooms), *slip]
    shown = replace(plan, room_m={side: room for side, room in plan.room_m.items() if room > VISIBLE_M})
    return pictured(say("plan.heading"), words, plan_sketch(source.scene, shown, say))


# Of a study: how often the statue falls, how strong a shaking it bore, what the pedestal changed.

WIDTH: Final = 480
"""Width of the charts among the page's pictures."""
AXES: Final = {"frequency_hz": "plain.frequency", "amplitude_g": "plain.strength", "pga_g": "plain.strength"}
"""The words of a map's axis with their unit, by the last part of its key; others have the key's own."""
OUTSIDE: Final = "outside"
"""How a run ends for the statue that left its model's domain before: not known."""
MORE: Final = {"failed": "study.more_silent", OUTSIDE: "study.more_outside"}
"""What is told of situations without an end."""
SEVERE: Final = ("stands", "failed", "other", "wall", "overturns")
"""Families of outcomes, the worst for the statue last."""
STRENGTHS: Final = (
    "motion.scale",
    *(f"motion.{axis}.{name}" for axis in "xy" for name in ("amplitude_g", "scale", "pga_g")),
)
"""Keys that vary the strength of a level shaking."""


def of_study(record: StudyRecord, say: Language = ENGLISH) -> list[Block]:
    """Headline, points and pictures of a study."""
    answers = Answers.of(record.rows, record.vary)
    runs = {model: of for model in answers.models if (of := [run for _, run in answers.runs(model)])}
    ends = _most_known({
        model: Counter(OUTSIDE if doubted(run) else end_key(run.outcome) for run in of) for model, of in runs.items()
    })  # fmt: skip
    said = [
        *_asked(answers, say),
        *_by_variant(ends, say),
        *_outside(record, say),
        *_bore(record, answers, say),
    ]
    tone = tone_of_study(told_family(run) for of in runs.values() for run in of)
    basis = [*_agree(record, say), say("chance.unknown")]
    pictures = [*_map(record, answers, say), *_pictures(record, answers, say)]
    return plain_page(_headline(ends, say), tone, said, [say("todo.ask")], pictures, basis, say)


def _outside(record: StudyRecord, say: Language) -> list[str]:
    """In how many of their runs models left what they compute before anything was decided."""
    left = [each.values for each in record.findings if each.code == "left_domain_in_runs"]
    runs = {key: sum(each[key] for each in left) for key in ("left", "cases")}
    return [say("study.outside", **runs)] if left else []


Ends = Mapping[str, Mapping[str, Counter[str]]]
"""How often the runs of a study end how: by variant, and by model."""


def _most_known(ends: Mapping[str, Counter[str]]) -> Ends:
    """Of each variant the models that tell the most situations, of several that leave the fewest open: of fewer a count says
    less."""
    left = {model: sum(counts[key] for key in MORE) for model, counts in ends.items()}
    rank = {model: (counts.total() - left[model], -left[model]) for model, counts in ends.items()}
    variants = grouped((model.partition(" (")[2][:-1], model) for model in ends)
    most = {variant: max(rank[model] for model in models) for variant, models in variants.items()}
    return {
        variant: {model: ends[model] for model in models if rank[model] == most[variant]}
        for variant, models in variants.items()
    }


def _headline(variants: Ends, say: Language) -> str:
    """In how many situations it falls, of each variant by the models that know the most, and how many they leave open."""
    if not variants:
        return say("study.nothing")
    known = {model: counts for asked in variants.values() for model, counts in asked.items()}
    total = max(counts.total() for counts in known.values())
    whole = {model: counts for model, counts in known.items() if counts.total() == total}
    falls = {counts["overturns"] for counts in whole.values()}
    left = _between([counts[OUTSIDE] for counts in whole.values()], say)
    more = "" if left == "0" else say("study.more", ends=say("study.more_outside", count=left))
    if len(falls) == 1:
        return f"{say('study.falls', falls=falls.pop(), total=total)}{more}"
    parts = [{model.partition(" (")[0] for model in whole}, {model.partition(" (")[2] for model in whole}]
    named = zip(("study.model", "study.variant"), parts, strict=True)
    by = say.listed(say(key) for key, names in named if len(names) > 1)
    return f"{say('study.falls_between', least=min(falls), most=max(falls), total=total, by=by)}{more}"


def _by_variant(variants: Ends, say: Language) -> list[str]:
    """What the models say of each variant; whatever is neither a fall nor standing is named."""
    # Of one variant the headline says the rest.
    told = {"overturns", "stands"} | ({OUTSIDE} if len(variants) == 1 else set())
    sentences = []
    for variant, asked in variants.items():
        kinds = [*asked.values()]
        others = dict.fromkeys(key for counts in kinds for key in counts if key not in told)
        each = [
            say(
                MORE.get(key, "study.more_end"),
                end=say(f"end.{key}") if key not in MORE else "",
                count=_between([counts[key] for counts in kinds], say),
            )
            for key in others
        ]
        if len(variants) == 1 and not each:
            return []
        more = say("study.more", ends=say.listed(each)) if each else ""
        falls, total = _between([counts["overturns"] for counts in kinds], say), kinds[0].total()
        key = "study.by_one" if len(variants) == 1 else "study.by_variant"
        sentences.append(say(key, variant=variant, falls=falls, total=total, more=more))
    return sentences


def _between(counts: Sequence[int], say: Language) -> str:
    least, most = min(counts), max(counts)
    return str(least) if least == most else say("study.between", least=least, most=most)


def _asked(answers: Answers, say: Language) -> list[str]:
    varied = [say.key(key) or say("key.other") for key in dict.fromkeys([*answers.asked, *answers.keys])]
    variants = list(dict.fromkeys(model.partition(" (")[2][:-1] for model in answers.models))
    names = say.listed(say("study.quoted", name=name) for name in variants)
    sentences = {"study.varied": varied, "study.variants": len(variants) > 1}
    return told(say, sentences, keys=say.listed(dict.fromkeys(varied)), names=names)


def _strength(answers: Answers) -> str | None:
    """The key that varies the strength of the shaking."""
    return next((key for key in answers.keys if key in STRENGTHS), None)


def _borne(cases: Sequence[Condition], key: str) -> float | None:
    """The strongest level of the shaking up to which the statue stood in every situation and every model; None without one."""
    runs = [(abs(item.number(key)), row.run) for item in cases for row in item.answers.values()]
    ends = grouped((level, told_family(run)) for level, run in runs if run is not None)
    return max(itertools.takewhile(lambda level: {*ends[level]} == {"stands"}, sorted(ends)), default=None)


def _bore(record: StudyRecord, answers: Answers, say: Language) -> list[str]:
    """The strongest shaking that it bore; where there is none, the weakest that was tried."""
    key = _strength(answers)
    if key is None:
        return []
    safe, tried = _borne(answers.cases, key), [abs(item.number(key)) for item in answers.cases]
    level = min(tried) if safe is None else safe
    return [say("study.weakest" if safe is None else "study.borne", level=_level(record, key, level, say))]


def _level(record: StudyRecord, key: str, value: float, say: Language) -> str:
    """How strong a shaking is, by the key that varies it."""
    kind, unit = _strength_unit(record, key)
    words, value = say.key(key) or say("key.other"), value * unit if kind != "other" else value
    number = say.short(value)
    return say(f"study.level_{kind}", push=say.percent(value), factor=number, key=words, value=number)


def _strength_unit(record: StudyRecord, key: str) -> tuple[str, float]:
    """What a strength is told in, and how much of it one of the key is: the scene may multiply the shaking elsewhere too."""
    motion, whole = record.scene.toml.get("motion"), key == "motion.scale"
    motion = motion if isinstance(motion, Mapping) else {}
    own = motion.get("x" if whole else key.split(".")[1])
    own = own if isinstance(own, Mapping) else {}
    factors = [1.0 if whole else motion.get("scale", 1.0)]
    if whole:
        size = next((name for name in ("amplitude_g", "pga_g") if name in own and "y" not in motion), "scale")
        factors.append(own.get(size, 1.0))
    else:
        size = key.split(".")[2]
    kind = (
        "weight"
        if size.endswith("_g")
        else "record"
        if own.get("kind") == "record" and "pgv_m_s" not in own
        else "other"
    )
    return kind, abs(math.prod(float(each) for each in factors if isinstance(each, int | float)))


def _by_direction(record: StudyRecord, answers: Answers) -> dict[float, float]:
    """The strongest shaking borne by direction of the push, where the study turned the statue and varied the amplitude in g.

    A statue turned by an angle under a shaking along x is one shaken along minus that angle, to both sides.
    """
    turn, strength = next((key for key in answers.keys if key.endswith("azimuth_deg")), None), _strength(answers)
    if turn is None or strength is None or not strength.endswith("_g"):
        return {}
    own, (_, unit) = scan_turn_deg(record.scene), _strength_unit(record, strength)
    borne = {}
    for angle in {item.number(turn) for item in answers.cases}:
        safe = _borne([item for item in answers.cases if item.number(turn) == angle], strength)
        for side in (0.0, 180.0):
            borne[(own - angle + side) % 360.0] = (safe or 0.0) * unit
    return borne


def _agree(record: StudyRecord, say: Language) -> list[str]:
    """How often the other models end as the reference does: the record's own count."""
    scores = [each for each in (record.scores or {}).values() if each.cases]
    if not scores:
        return []
    same, total = sum(each.same for each in scores), sum(each.cases for each in scores)
    return [begun(say("study.agree", count=say.count(len(scores) + 1), same=same, total=total))]


def _pictures(record: StudyRecord, answers: Answers, say: Language) -> list[Drawing]:
    """Reach and effect of the pedestal where the study varied it; else what gives way first."""
    scene, support = record.scene, record.supports or support_of(record.scene)
    push = push_picture(scene, support, say, borne=_by_direction(record, answers))
    from reports.pages.study_page import pedestal_effect  # a run's page has no such chart, nor the rooms that one asks

    effect = pedestal_effect(record, answers, say, "plain")
    if effect is None:
        return [push, order_picture(scene, support, say)]
    finding, charts = effect
    saved_words = say("study.saved", **finding.values)
    if not charts:
        order = order_picture(scene, support, say)
        return [push, replace(order, caption=[*order.caption, saved_words])]
    saved, moved = (still(localised(each.figure, say), WIDTH, each.name) for each in charts)
    return [
        Drawing(moved, [say("study.far")], heading=say("study.top")),
        push,
        Drawing(saved, [saved_words], heading=say("order.heading_pedestal")),
    ]


def _map(record: StudyRecord, answers: Answers, say: Language) -> list[Drawing]:
    """Where it falls, over the two keys of the study's own map: at each place the worst that any answer there says."""
    from reports.pages.study_page import map_figures  # as above

    axes = answers.plane
    if axes is None or record.panels:
        return []
    places = [(tuple(item.varied[key] for key in axes), item.answers.values()) for item in answers.cases]
    said = grouped((place, row) for place, rows in places for row in rows)
    worst = {place: max(rows, key=_severity) for place, rows in said.items()}
    cases = [Condition(dict(zip(axes, place, strict=True)), {"": row}) for place, row in worst.items()]
    figures = map_figures(Answers([""], cases, axes), say, lambda key: _axis_title(record, key, say))
    if not figures:
        return []
    _, figure = figures[0]
    figure["layer"][0]["encoding"]["fill"]["legend"] = None
    seen = sorted({_severity(row) for row in worst.values()}, reverse=True)
    words = [say("map.seen"), " ".join(say(f"map.{SEVERE[k]}" if k >= 0 else "map.pale") for k in seen)]
    return [Drawing(still(localised(figure, say), WIDTH, "map"), words, heading=say("map.heading"))]


def _axis_title(record: StudyRecord, key: str, say: Language) -> str:
    """What a map's axis is called: a strength that the scene multiplies once more by its key."""
    last = key.rpartition(".")[2]
    if last in AXES and (key not in STRENGTHS or _strength_unit(record, key)[1] == 1.0):
        return say(AXES[last])
    unit = split_unit(last)[1]
    return (say.key(key) or say("key.other")) + (f" ({unit})" if unit else "")


def _severity(row: StudyRow) -> int:
    """Place of what a row says among `SEVERE`; nothing computed is the least."""
    return -1 if row.run is None else SEVERE.index(told_family(row.run))


def of_effects(folder: Path, record: EffectsRecord, say: Language = ENGLISH) -> list[Block]:
    """Headline, points and pictures of an effects study: the shaking borne by direction, over all its conditions and models."""
    borne: dict[float, float] = {}
    for row in record.rows:
        borne[row.azimuth_deg] = min(borne.get(row.azimuth_deg, math.inf), row.stands_at_g)
    weak, strong = (choose(borne, key=lambda key: borne[key]) for choose in (min, max))
    scene, support = record.scene, support_of(record.scene)
    pictures = [push_picture(scene, support, say, borne=borne), order_picture(scene, support, say)]
    if record.replay:
        pictures.insert(0, reach_picture(run_source(folder / record.replay.folder), say, [say("reach.replayed")]))
    groups = {item.condition: item.group for item in record.effects}.values()
    # As it is known, and as it may be: neither a shorter step nor further components of the shaking are another statue.
    variants = 1 + sum(group in ("base", "uncertainty") for group in groups)
    strongest = say.percent(borne[strong])
    points = [
        say("study.effects_least", weak=compass(weak, say), strong=compass(strong, say), push=strongest),
        say(f"study.effects_{'directions' if variants > 1 else 'alone'}", count=len(borne), variants=variants),
        say("study.effects_axes" if "components" in groups else "study.effects_form"),
    ]
    # What shaking is borne says nothing of how probable a fall is: never green.
    headline = say("study.effects", push=say.percent(borne[weak]))
    return plain_page(headline, "differ", points, [say("todo.ask")], pictures, [], say)
