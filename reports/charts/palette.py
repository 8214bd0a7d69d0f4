"""Colours and dashes of all pages and figures: Okabe and Ito's palette, told apart by every form of colour vision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

INK: Final = "#1c2430"
MUTED: Final = "#566070"
HAIRLINE: Final = "#d5dbe3"

DARK: Final = {
    INK: "#e4e8ee", MUTED: "#a5b0bf", HAIRLINE: "#3a4553", "#0072b2": "#4ba6e0", "#d55e00": "#f58231", "#009e73": "#2fc79b",
    "#56616f": "#9fabba", "#3a8fc7": "#6fb8e6", "#b07c00": "#d9a520", "#aa4499": "#d77fca", "#c2185b": "#ff7aa8",
    "#0b6e4f": "#3fc18d", "#8c1d2f": "#ff8a96", "#8a6d00": "#d0aa2a", "#59636f": "#8793a3", "#6d6353": "#b3a78f",
    "#dfd8cb": "#5d574b", "#e3e6ea": "#4a5563", "#fff": "#1a2028",
}  # fmt: skip
"""What stands for a colour of lines and texts where the reader's screen is dark: each at least as far from its ground."""


def dark_css() -> str:
    """Rules that turn the colours of pictures and keys on a dark screen; print stays light."""
    rules = []
    for light, dark in DARK.items():
        rules += [f'svg [{part}="{light}" i]{{{part}:{dark}}}' for part in ("fill", "stroke")]
        if len(light) == len(INK):  # shorter ones begin others
            rules.append(f'[style*="--c: {light}" i]{{--c:{dark}!important}}')
    return f"@media screen and (prefers-color-scheme:dark){{{''.join(rules)}}}"


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
    "spatial": Look("#56616F", "6px,2px,1px,2px", 2.0),
    "pymunk:plain": Look("#3A8FC7", "3px,3px", 1.4),
    "pybullet:plain": Look("#B07C00", "9px,3px,2px,3px", 1.4),
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


def model_looks(models: Sequence[str]) -> dict[str, Look]:
    """The looks of a study's models, `engine (variant)`: an engine's own, a spare one for each where it stands for several."""
    engines = [model.partition(" (")[0] for model in models]
    own = [engine if engines.count(engine) == 1 else model for model, engine in zip(models, engines, strict=True)]
    return {model: look(name, list(models)) for model, name in zip(models, own, strict=True)}


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
