"""What gives way first under a growing push: what the statue stands on, the pushes that move it, and what their order means."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.records.scene import PushRecord, SceneRecord
from harness.records.study import StudyRecord
from harness.statics.push import CAUSES, tipping_of_pedestal
from reports.drawing.kinematics import Array
from reports.text.numbers import listed, percent, short

Span = tuple[float, float]

DIRECTIONS: Final = ("right", "back right", "back", "back left", "left", "front left", "front", "front right")
EQUAL: Final = 0.01
"""Sides whose pushes differ by a smaller share are told as equally weak: pushes are told to two digits."""
EVERY_SIDE: Final = 6
"""A base that is equally weak towards so many of the eight directions is round."""


@dataclass(frozen=True)
class Support:
    """What the statue stands on, over all cases of a record: on a pedestal or not, least and greatest static frictions.

    `statue_keys` are the keys of the statue itself that vary.
    """

    pedestal: tuple[bool, ...]
    floor: Span | None
    statue: Span
    statue_keys: tuple[str, ...] = ()

    def situations(self) -> list[tuple[str, float | None, float]]:
        """Words for what varies, friction on the floor (None without a pedestal) and under the statue, at the ends of both."""
        listed = []
        for stone in self.pedestal:
            for floor in dict.fromkeys(self.floor or ()) if stone else (None,):
                for statue in dict.fromkeys(self.statue):
                    said = ["with the pedestal" if stone else "without the pedestal"] if len(self.pedestal) > 1 else []
                    if floor is not None and self.floor is not None and self.floor[0] < self.floor[1]:
                        said.append(f"where the floor's friction is {percent(floor)}")
                    if self.statue[0] < self.statue[1]:
                        said.append(f"where the friction under the statue is {percent(statue)}")
                    listed.append((" and ".join(said), floor, statue))
        return listed

    def slips(self) -> list[tuple[float, str]]:
        """The pushes from which something slides, and what, from weak to strong."""
        frictions = {
            (statue, "the statue") if floor is None or statue < floor else (floor, "the pedestal")
            for _, floor, statue in self.situations()
        }
        return sorted(frictions)


def support_of(scene: SceneRecord) -> Support:
    """What the statue stands on in one scene."""
    friction = scene.contact
    floor = None if scene.pedestal is None else (friction.floor_static, friction.floor_static)
    return Support((scene.pedestal is not None,), floor, (friction.statue, friction.statue))


def study_support(record: StudyRecord) -> Support:
    """What the statue stands on over all cases of a study."""
    known = record.supports
    if known is None:
        return support_of(record.scene)
    return Support(tuple(known.pedestal), known.floor_static, known.statue, tuple(known.statue_keys))


@dataclass(frozen=True)
class Level:
    """One thing that gives way: words, the push as a share of the weight, and its name among the causes of `statics.push`."""

    words: str
    push: float
    cause: str


def compass(azimuth_deg: float) -> str:
    """A direction, counter-clockwise from the right as seen from above, in words."""
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
    near = np.flatnonzero(distances <= (1.0 + EQUAL) * distances.min())
    order = near[np.argsort(distances[near], kind="stable")]
    return float(distances.min()), [math.degrees(math.atan2(*outward[k][::-1])) for k in order]


def weakest_words(scene: SceneRecord) -> str:
    """Towards which sides the statue tips first, and from which push on; told in the scan's own axes too where it was turned."""
    least, azimuths = weakest_pushes(bearing(scene))
    names = list(dict.fromkeys(map(compass, azimuths)))
    if len(names) >= EVERY_SIDE:
        return f"It is about as weak towards every side: it tips from a push of {percent(least)} of its weight on."
    text = f"It is weakest towards the {listed(names)}: there it tips from a push of {percent(least)} of its weight on."
    turn = scan_turn_deg(scene)
    if turn == 0.0:
        return text
    own = listed(dict.fromkeys(f"{short((azimuth - turn) % 360.0, 3)}°" for azimuth in azimuths))
    return (
        f"{text} The scene has turned the scan by {short(turn, 3)}° to stand so: in the scan's own file this is towards {own}, "
        "counted counter-clockwise from its first level axis as seen from above."
    )


def scan_turn_deg(scene: SceneRecord) -> float:
    """By how much the scene turns the scan about the vertical, counter-clockwise from above; 0 for a statue by numbers."""
    statue = scene.toml.get("statue")
    mesh = statue.get("mesh") if isinstance(statue, dict) else None
    turn = mesh.get("azimuth_deg") if isinstance(mesh, dict) else None
    return float(turn) % 360.0 if isinstance(turn, int | float) else 0.0


def levels(scene: SceneRecord, support: Support) -> list[Level]:
    """What gives way, from weak to strong: tipping to either side, slips that come before the last of these."""
    statue, h = scene.statue, scene.statue.centroid_height_m
    left, right = statue.corner_left_m / h, statue.corner_right_m / h
    pushes = [
        Level("the statue tips to the left", left, "statue_tips"),
        Level("the statue tips to the right", right, "statue_tips"),
    ]
    least, azimuths = weakest_pushes(bearing(scene))
    if least < (1.0 - EQUAL) * min(left, right):
        pushes.append(Level(f"the statue tips to the {compass(azimuths[0])}", least, "statue_tips"))
    for friction in dict.fromkeys(support.floor or ()):
        pushes.append(Level(CAUSES["pedestal_slides"] + _end(friction, support.floor), friction, "pedestal_slides"))
    most = max(level.push for level in pushes)
    for side, push in pedestal_tips(scene, support).items():
        if push < most:
            pushes.append(Level(f"the pedestal tips to the {side}", push, "pedestal_tips"))
    for friction in dict.fromkeys(support.statue):
        if friction < most:
            words = CAUSES["statue_slides"] + _end(friction, support.statue)
            pushes.append(Level(words, friction, "statue_slides"))
    return sorted(pushes, key=lambda level: level.push)


def pedestal_tips(scene: SceneRecord, support: Support) -> dict[str, float]:
    """The pushes from which the pedestal tips with the statue on it, by side; none without a pedestal."""
    statue, stone = scene.statue, scene.pedestal
    if stone is None or True not in support.pedestal:
        return {}
    centre = 0.5 * (statue.corner_right_m - statue.corner_left_m)
    pushes = tipping_of_pedestal(statue.mass_kg, statue.centroid_height_m, centre, stone)
    names = {(0, 1): "right", (0, -1): "left", (1, 1): "back", (1, -1): "front"}
    return {names[side]: push for side, push in pushes.items()}


def _end(friction: float, span: Span | None) -> str:
    if span is None or span[0] == span[1]:
        return ""
    return " (least tried)" if friction == span[0] else " (greatest tried)"


def order_words(scene: SceneRecord, support: Support, push: PushRecord | None, *, rising: bool = False) -> list[str]:
    """What the order of giving way means, by situation where it differs; `push` is what a motion asks (`harness.statics.push`).

    `rising`: the shaking has an up-and-down part.
    """
    tips = [level.push for level in levels(scene, support) if level.cause == "statue_tips"]
    stone = min(pedestal_tips(scene, support).values(), default=math.inf)
    meanings = {said: _meaning(tips, stone, floor, statue) for said, floor, statue in support.situations()}
    if len(set(meanings.values())) == 1:
        words = [next(iter(meanings.values()))]
    else:
        words = [f"{said[0].upper()}{said[1:]}: {text[0].lower()}{text[1:]}" for said, text in meanings.items()]
    if push is not None:
        words.append(_push_words(push, support, rising))
    if support.pedestal == (True,):
        words.append("Whether it prevents falls on the whole is shown by a study of the statue with and without it.")
    return words


def _meaning(tips: Sequence[float], stone: float, floor: float | None, statue: float) -> str:
    """The order of giving way at one pair of frictions in a sentence or two; `stone` tips the pedestal itself."""
    if floor is not None and stone < min(*tips, floor, statue):
        return "The pedestal itself tips, with the statue on it, before anything else gives way: it is too slender to protect it."
    if statue < min(*tips, math.inf if floor is None else floor):
        return (
            f"The statue slides on its {'support' if floor is None else 'pedestal'} before anything else gives way. Sliding "
            "limits the push that reaches it; the price is that the statue wanders."
        )
    if floor is None:
        if statue < max(tips):
            return "Towards its weak side the statue tips before it slides, towards its strong side after."
        return "The statue stands on the floor: nothing slides before it tips that could soften the shaking."
    if floor < min(tips):
        return (
            "The pedestal slides before the statue tips. Sliding limits the push that reaches the statue, as a fuse does; the "
            "price is that the pedestal wanders."
        )
    if floor < max(tips):
        return (
            "Towards its weak side the statue tips before its pedestal slides, towards its strong side after. The pedestal "
            "softens strong shaking only in part."
        )
    return "The statue tips before its pedestal slides: a pedestal that holds fast gives no protection."


def _push_words(push: PushRecord, support: Support, rising: bool) -> str:
    """How strong the shaking is beside what gives way first under it."""
    said = f"This shaking pushes with up to {percent(push.peak, 3)} of the weight"
    share, words = push.shares[push.first], CAUSES[push.first]
    counted = " (its up-and-down part counted in)" if rising else ""
    if share is None:
        without = push.first == "pedestal_slides" and support.floor is not None and support.floor[0] == 0.0
        why = "which has no friction there" if without else "for at moments the floor drops as fast as things fall"
        return f"{said}; under any push {words}, {why}."
    times = f"{short(share, 3)} times" if share >= 1.0 else f"{percent(share, 3)} of"
    return f"{said}: {times} what it takes until {words}{counted}."
