"""What the conservator's pages of every record share: an outcome in a museum's words, the pictures of pushes, the limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from harness.model.history import Outcome
from harness.records.scene import MotionRecord, SceneRecord
from harness.records.study import SupportRecord
from reports.blocks import Block, Drawing, Section, Text, Verdict
from reports.drawing.conservator_pictures import order_svg, push_svg
from reports.messages import Language
from reports.text.giving_way import compass, levels, order_words, slips, weakest_words

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
