"""Colours and dashes of all pages and figures: Okabe and Ito's palette, told apart by every form of colour vision."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

INK: Final = "#1c2430"
MUTED: Final = "#566070"
HAIRLINE: Final = "#d5dbe3"


@dataclass(frozen=True)
class Look:
    """How one model is drawn everywhere: colour, plotly dash, line width in pixels."""

    colour: str
    dash: str
    width: float


LOOKS: Final = {
    "analytic": Look(INK, "solid", 2.4),
    "pymunk": Look("#0072B2", "solid", 1.6),
    "pybullet": Look("#D55E00", "7px,2px", 1.6),
    "mujoco": Look("#009E73", "2px,2px", 1.6),
    "spatial": Look("#56616F", "6px,2px,1px,2px", 2.0),
    "pymunk:plain": Look("#3A8FC7", "3px,3px", 1.4),
    "pybullet:plain": Look("#B07C00", "9px,3px,2px,3px", 1.4),
    "mujoco:plain": Look("#AA4499", "2px,4px", 1.4),
}
SPARE: Final = (Look("#AA4499", "9px,3px,2px,3px", 1.6), Look("#B07C00", "4px,3px", 1.6), Look("#3A8FC7", "solid", 1.2))

PATTERN_LOOKS: Final = {
    "rest": ("#e3e6ea", ""),
    "rocking": ("#56B4E9", ""),
    "sliding": ("#E69F00", "/"),
    "both": ("#AA4499", "x"),
}
"""Colour and hatching of each motion pattern (docs/model.md, section 6)."""


def look(name: str, names: list[str] | tuple[str, ...]) -> Look:
    """The look of a model; models without one of their own take spare looks in their order among `names`."""
    if name in LOOKS:
        return LOOKS[name]
    others = [item for item in names if item not in LOOKS]
    return SPARE[others.index(name) % len(SPARE)]


def faint(colour: str, opacity: float) -> str:
    """A `#rrggbb` colour with an opacity, as CSS and plotly write it."""
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},{opacity})"


def solid(colour: str) -> tuple[str, float]:
    """A colour of a figure as `#rrggbb` and its opacity: what `faint` wrote, taken apart again."""
    if not colour.startswith("rgba("):
        return colour, 1.0
    red, green, blue, opacity = colour.removeprefix("rgba(").removesuffix(")").split(",")
    return f"#{int(red):02x}{int(green):02x}{int(blue):02x}", float(opacity)
