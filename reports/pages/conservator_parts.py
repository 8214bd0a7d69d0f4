"""What the conservator's pages of every record share: an outcome in a museum's words, the pictures of pushes, the limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from markupsafe import Markup

from harness.model.history import Outcome
from harness.records.scene import MotionRecord, SceneRecord
from reports.drawing.conservator_pictures import order_svg, push_svg
from reports.text.giving_way import Support, compass, levels, order_words, weakest_words
from reports.text.numbers import heading as label_of
from reports.text.numbers import listed, percent

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
