"""What gives way first under a growing push: what the statue stands on, the pushes that move it, what their order means, and
what the pedestal does.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.model import Array, Finding, grouped, info
from harness.records.run import falls
from harness.records.scene import PushRecord, SceneRecord
from harness.records.study import CaseRun, StudyRecord, SupportRecord
from harness.records.trust import Saved, knows_most
from harness.statics.standstill import tipping_of_pedestal
from meshes.footprint import reach_m
from reports.blocks import Chart
from reports.charts import Json
from reports.charts.figure import (
    FLOOR_COLOUR,
    PEDESTAL_COLOUR,
    Look,
    across,
    figure,
    kinds,
    level,
    marks,
    names,
    points,
    upwards,
)
from reports.drawing.kinematics import poses, top_shift_m
from reports.messages import ENGLISH, Language
from reports.text.answers import Answers, Condition

# What the pedestal changes over a study: how often it prevents a fall, and how far the top moves with and without it.

WALL_COLOUR: Final = "#8c1d2f"


def pedestal_effect(
    record: StudyRecord,
    answers: Answers,
    say: Language = ENGLISH,
    words: str = "chart",
) -> tuple[Finding, list[Chart]] | None:
    """What the pedestal saves in a study with and without it, by the model that tells it of most conditions; None for other
    studies.

    Where the study varies a frequency, charts of the share of falls (`saved`) and of the reach (`moved`). `words` is the table of
    the catalogue that names what the charts show.
    """
    # "keep" is no number.
    pace = next((key for key in answers.keys if key.endswith("frequency_hz") and answers.numbers(key)), None)
    if "pedestal" not in answers.varying:
        return None
    counted = {name: _saved(answers.runs(name)) for name in answers.models}
    model = knows_most(counted, answers.models[0]) or answers.models[0]
    told = info("pedestal_saves", model=model, **vars(counted[model]))
    if pace is None:
        return told, []
    runs = sorted(answers.runs(model), key=lambda each: each[0].number(pace))
    by_setting = {
        say(f"{words}.on_{setting}"): [
            (item.number(pace), run)
            for item, run in runs
            if (item.varied["pedestal"] == "none") == (setting == "floor")
        ]
        for setting in SETTINGS
    }
    named = {each: say(f"{words}.{each}") for each in ("frequency", "share_falls", "top", "wall")}
    drawn = {
        "saved": _falls_by_setting(by_setting, named, say),
        "moved": _reach_by_setting(by_setting, named, record.scene),
    }
    return told, [Chart(name, say(f"text.pedestal_{name}", model=model), figure) for name, figure in drawn.items()]


def _top_m(scene: SceneRecord, run: CaseRun) -> float:
    """How far the top moves at most while its statue leans and its pedestal slides, m."""
    leans = poses(scene, {"theta_rad": run.peak_theta_rad * np.array([-1.0, 1.0])})
    return float(np.abs(top_shift_m(scene, leans)).max()) + run.peak_slip_m


def _saved(runs: Sequence[tuple[Condition, CaseRun]]) -> Saved:
    """How often the pedestal prevents and causes an overturning under the same condition, where both runs tell it."""
    known = [(item.varied, fallen) for item, run in runs if (fallen := falls(run)) is not None]
    by_rest = grouped(
        (tuple(value for key, value in varied.items() if key != "pedestal"), (varied["pedestal"] == "none", fallen))
        for varied, fallen in known
    )
    pairs = [dict(pair) for pair in by_rest.values()]
    return Saved.of([(pair[True], pair[False]) for pair in pairs if len(pair) == 2])


SETTINGS: Final = {"floor": FLOOR_COLOUR, "pedestal": PEDESTAL_COLOUR}
Runs = Mapping[str, Sequence[tuple[float, CaseRun]]]
"""The runs of a setting, each with its frequency, by the setting's words."""


def _falls_by_setting(by_setting: Runs, named: Mapping[str, str], say: Language) -> Json:
    """The share of falls by setting and frequency: a bar for each."""
    fell = {
        setting: grouped((rate, fallen) for rate, run in runs if (fallen := falls(run)) is not None)
        for setting, runs in by_setting.items()
    }
    parts = [
        {
            "kind": setting, "x": [*map(say.short, ends)], "y": [100.0 * sum(each) / len(each) for each in ends.values()],
            "count": [f"{sum(each)}/{len(each)}" for each in ends.values()],
        }
        for setting, ends in fell.items()
    ]  # fmt: skip
    beside = {"xOffset": {"field": "kind", "sort": list(fell)}}
    bars = marks("bar", "falls", beside | {"color": kinds(dict(zip(fell, SETTINGS.values(), strict=True)))})
    words = marks("text", "falls", beside | {"text": {"field": "count"}}, dy=-7, clip=False)
    rates = sorted({rate for ends in fell.values() for rate in ends})
    x = names("x", [*map(say.short, rates)], named["frequency"], labelAngle=0, grid=False)
    y = upwards("y", named["share_falls"], {"domain": [0, 112]}, values=[*range(0, 101, 20)])
    return figure([bars, words], 340, {"falls": parts}, x, y)


def _reach_by_setting(by_setting: Runs, named: Mapping[str, str], scene: SceneRecord) -> Json:
    """How far the top moves by setting and frequency, and the wall."""
    moved = {
        setting: grouped((rate, _top_m(scene, run)) for rate, run in runs if falls(run) is False)
        for setting, runs in by_setting.items()
    }
    parts = [{"name": setting, "x": [*by], "y": [*map(max, by.values())]} for setting, by in moved.items() if by]
    y, wall = upwards("y", named["top"], {"zero": True}), scene.wall
    lines = [] if wall is None else level(wall.distance_m, named["wall"], line=Look(WALL_COLOUR, "6 4", 1.5))
    looks = {setting: Look(colour) for setting, colour in zip(moved, SETTINGS.values(), strict=True) if moved[setting]}
    return figure(
        [*points("reach", looks, y, first=True), *lines], 340, {"reach": parts}, across("x", named["frequency"]), y
    )


Span = tuple[float, float]

DIRECTIONS: Final = ("right", "back_right", "back", "back_left", "left", "front_left", "front", "front_right")
EQUAL: Final = 0.01
"""Sides whose pushes differ by a smaller share are told as equally weak: pushes are told to two digits."""
EVERY_SIDE: Final = 6
"""A base that is equally weak towards so many of the eight directions is round."""


def situations(support: SupportRecord, say: Language = ENGLISH) -> list[tuple[str, float | None, float]]:
    """Words for what varies, friction on the floor (None without a pedestal) and under the statue, at the ends of both."""
    listed = []
    for stone in support.pedestal:
        for floor in dict.fromkeys(support.floor_static or ()) if stone else (None,):
            for statue in dict.fromkeys(support.statue):
                said = [say("order.with" if stone else "order.without")] if len(support.pedestal) > 1 else []
                if floor is not None and _spans(support.floor_static):
                    said.append(say("order.floor_friction", push=say.percent(floor)))
                if _spans(support.statue):
                    said.append(say("order.statue_friction", push=say.percent(statue)))
                listed.append((say.listed(said) if said else "", floor, statue))
    return listed


def slips(support: SupportRecord) -> list[tuple[float, str]]:
    """The pushes from which something slides, and what, from weak to strong."""
    frictions = {
        (statue, "statue") if floor is None or statue < floor else (floor, "pedestal")
        for _, floor, statue in situations(support)
    }
    return sorted(frictions)


def support_of(scene: SceneRecord) -> SupportRecord:
    """What the statue stands on in one scene."""
    friction = scene.contact
    floor = None if scene.pedestal is None else (friction.floor_static, friction.floor_static)
    return SupportRecord([scene.pedestal is not None], floor, (friction.statue, friction.statue), [])


def _spans(span: Span | None) -> bool:
    return span is not None and span[0] < span[1]


@dataclass(frozen=True)
class PushLevel:
    """One thing that gives way: words, the push as a share of the weight, and its name among the causes of `statics.push`."""

    words: str
    push: float
    cause: str


def compass(azimuth_deg: float, say: Language = ENGLISH) -> str:
    """A direction, counter-clockwise from the right as seen from above, in words."""
    return say(f"side.{_direction(azimuth_deg)}")


def _direction(azimuth_deg: float) -> str:
    return DIRECTIONS[round(azimuth_deg / 45.0) % 8]


def bearing(scene: SceneRecord) -> Array:
    """The corners (k, 2) of the pushes borne without tipping, as shares of the weight."""
    statue = scene.statue
    foot = np.asarray(statue.footprint_m, dtype=np.float64)[:, :2]
    return np.asarray(foot / statue.centroid_height_m)


def weakest_pushes(safe: Array) -> tuple[float, list[float]]:
    """The least push that tips, and the azimuths in degrees of all sides that bear hardly more, of corners counter-clockwise."""
    edges = np.roll(safe, -1, axis=0) - safe
    lengths = np.linalg.norm(edges, axis=1)
    edges, starts = edges[lengths > 0.0], safe[lengths > 0.0]
    outward = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.linalg.norm(edges, axis=1, keepdims=True)
    distances = np.einsum("ij,ij->i", outward, starts)
    near = np.flatnonzero(distances <= distances.min() + EQUAL * abs(distances.min()))
    order = near[np.argsort(distances[near], kind="stable")]
    return float(distances.min()), [math.degrees(math.atan2(*outward[k][::-1])) for k in order]


def weakest_words(scene: SceneRecord, say: Language = ENGLISH) -> str:
    """Towards which sides the statue tips first, and from which push on; told in the scan's own axes too where it was turned."""
    least, azimuths = weakest_pushes(bearing(scene))
    names = dict[str, float]()
    for azimuth in azimuths:  # of two edges towards one side the weaker is told
        names.setdefault(compass(azimuth, say), azimuth)
    if len(names) >= EVERY_SIDE:
        return say("push.round", push=say.percent(least))
    text = say("push.weakest", sides=say.listed(names), push=say.percent(least))
    turn = scan_turn_deg(scene)
    if turn == 0.0:
        return text
    own = say.listed(f"{say.short((azimuth - turn) % 360.0, 3)}°" for azimuth in names.values())
    return f"{text} {say('push.turned', turn=say.short(turn, 3))} {say('push.own', angles=own)}"


def scan_turn_deg(scene: SceneRecord) -> float:
    """By how much the scene turns the scan about the vertical, counter-clockwise from above; 0 for a statue by numbers."""
    statue = scene.toml.get("statue")
    mesh = statue.get("mesh") if isinstance(statue, dict) else None
    turn = mesh.get("azimuth_deg") if isinstance(mesh, dict) else None
    return float(turn) % 360.0 if isinstance(turn, int | float) else 0.0


def levels(
    scene: SceneRecord, support: SupportRecord, say: Language = ENGLISH, *, across: bool = False
) -> list[PushLevel]:
    """What gives way, from weak to strong: tipping to either side, slips that come before the last of these.

    `across`: pushes come across the plane too, and tip the statue to the front and back.
    """
    statue, h, safe = scene.statue, scene.statue.centroid_height_m, bearing(scene)
    tips = {"left": statue.corner_left_m / h, "right": statue.corner_right_m / h}
    least, azimuths = weakest_pushes(safe)
    if least < (1.0 - EQUAL) * min(tips.values()):
        tips[_direction(azimuths[0])] = least
    if across:
        for side, push in zip(("back", "front"), reach_m(safe, [90.0, 270.0]).tolist(), strict=True):
            tips.setdefault(side, push)
    slides, stone = say("order.pedestal_slides"), pedestal_tips(scene, support)
    pushes = [
        *(PushLevel(say("order.tips", side=say(f"side.{side}")), push, "statue_tips") for side, push in tips.items()),
        *(
            PushLevel(_end(slides, friction, support.floor_static, say), friction, "pedestal_slides")
            for friction in dict.fromkeys(support.floor_static or ())
        ),
    ]
    most = max(level.push for level in pushes)
    others = [
        *(
            PushLevel(say("order.pedestal_tips", side=say(f"side.{side}")), push, "pedestal_tips")
            for side, push in stone.items()
        ),
        *(
            PushLevel(_end(say("order.statue_slides"), friction, support.statue, say), friction, "statue_slides")
            for friction in dict.fromkeys(support.statue)
        ),
    ]
    return sorted([*pushes, *(each for each in others if each.push < most)], key=lambda level: level.push)


def pedestal_tips(scene: SceneRecord, support: SupportRecord) -> dict[str, float]:
    """The pushes from which the pedestal tips with the statue on it, by side; none without a pedestal."""
    statue, stone = scene.statue, scene.pedestal
    if stone is None or True not in support.pedestal:
        return {}
    centre = 0.5 * (statue.corner_right_m - statue.corner_left_m)
    pushes = tipping_of_pedestal(statue.mass_kg, statue.centroid_height_m, centre, stone)
    names = {(0, 1): "right", (0, -1): "left", (1, 1): "back", (1, -1): "front"}
    return {names[side]: push for side, push in pushes.items()}


def _end(words: str, friction: float, span: Span | None, say: Language) -> str:
    if span is None or not _spans(span):
        return words
    return say("order.least" if friction == span[0] else "order.greatest", words=words)


def order_words(
    scene: SceneRecord,
    support: SupportRecord,
    push: PushRecord | None,
    *,
    rising: bool = False,
    say: Language = ENGLISH,
) -> list[str]:
    """What the order of giving way means, by situation where it differs; `push` is what a motion asks
    (`harness.statics.standstill`).

    `rising`: the shaking has an up-and-down part.
    """
    tips = [level.push for level in levels(scene, support) if level.cause == "statue_tips"]
    stone = min(pedestal_tips(scene, support).values(), default=math.inf)
    meanings = {said: say(_meaning(tips, stone, floor, statue)) for said, floor, statue in situations(support, say)}
    by_case = [
        say("order.case", where=f"{said[0].upper()}{said[1:]}", meaning=f"{text[0].lower()}{text[1:]}")
        for said, text in meanings.items()
        if len(set(meanings.values())) > 1
    ]
    return [
        *(by_case or dict.fromkeys(meanings.values())),
        *([] if push is None else [_push_words(push, support, rising, say)]),
        *([say("order.study")] if list(support.pedestal) == [True] else []),
    ]


def _meaning(tips: Sequence[float], stone: float, floor: float | None, statue: float) -> str:
    """The key of what the order of giving way means at one pair of frictions; `stone` tips the pedestal itself."""
    if floor is not None and stone < min(*tips, floor, statue):
        return "order.stone_first"
    if statue < min(*tips, math.inf if floor is None else floor):
        return "order.slides_floor" if floor is None else "order.slides_stone"
    if floor is None:
        return "order.weak_floor" if statue < max(tips) else "order.nothing_slides"
    if floor < min(tips):
        return "order.fuse"
    return "order.part" if floor < max(tips) else "order.no_protection"


def _push_words(push: PushRecord, support: SupportRecord, rising: bool, say: Language) -> str:
    """How strong the shaking is beside what gives way first under it."""
    peak, share = say.percent(push.peak, 3), push.shares[push.first]
    words = say(f"order.cause_{push.first}" if push.first.endswith("tips") else f"order.{push.first}")
    if share is None:
        without = (
            push.first == "pedestal_slides" and support.floor_static is not None and support.floor_static[0] == 0.0
        )
        return say("order.any_push", peak=peak, words=words, why=say("order.no_friction" if without else "order.drops"))
    few = share < 1.0
    times = say("order.share", share=say.percent(share, 3)) if few else say("order.times", share=say.short(share, 3))
    return say("order.pushes_rising" if rising else "order.pushes", peak=peak, times=times, words=words)
