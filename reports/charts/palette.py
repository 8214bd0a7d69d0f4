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

SURFACES: Final = {
    "#e3e6eb": "#4a5563", "#56a8e0": "#0a4a8a", "#bfdef2": "#3a6f92", "#f0b03d": "#8a5f00", "#cc79a8": "#7d3270",
    "#f3e96b": "#6f681a", "#e0566b": "#9c2236", "#8f949b": "#000000",
}  # fmt: skip
"""Colours of the classes of a map and, where the reader's screen is dark, of each: lines run over them, and none is a line's."""


def dark_css() -> str:
    """Rules that turn the colours of pictures and keys on a dark screen; print stays light."""
    rules = []
    for light, dark in (DARK | SURFACES).items():
        rules += [f'svg [{part}="{light}" i]{{{part}:{dark}}}' for part in ("fill", "stroke")]
        if len(light) == len(INK):  # shorter ones begin others
            rules.append(f'[style*="--c: {light}" i]{{--c:{dark}!important}}')
    return f"@media screen and (prefers-color-scheme:dark){{{''.join(rules)}}}"


@dataclass(frozen=True)
class Look:
    """How a line is drawn everywhere: colour, lengths of dashes and gaps in pixels (empty: unbroken), width in pixels."""

    colour: str
    dash: str = ""
    width: float = 1.6


LOOKS: Final = {
    "analytic": Look(INK, "", 2.4),
    "pymunk": Look("#0072B2", "", 1.6),
    "pybullet": Look("#D55E00", "7 2", 1.6),
    "spatial": Look("#56616F", "6 2 1 2", 2.0),
    "pymunk:plain": Look("#3A8FC7", "3 3", 1.4),
    "pybullet:plain": Look("#B07C00", "9 3 2 3", 1.4),
}
SPARE: Final = (Look("#AA4499", "9 3 2 3", 1.6), Look("#B07C00", "4 3", 1.6), Look("#3A8FC7", "", 1.2))

PATTERN_COLOURS: Final = {"rest": "#e3e6ea", "rocking": "#56B4E9", "sliding": "#E69F00", "both": "#AA4499"}
"""Colour of each motion pattern (docs/model.md, section 6); sliding is hatched, both crosswise."""
PATTERN_FILLS: Final = {**PATTERN_COLOURS, "sliding": "url(#hatch-sliding)", "both": "url(#hatch-both)"}
HATCHES: Final = "".join(
    f'<pattern id="hatch-{name}" width="6" height="6" patternUnits="userSpaceOnUse"><rect width="6" height="6" '
    f'fill="{PATTERN_COLOURS[name]}"/><path d="{lines}" stroke="#ffffff" stroke-width="1"/></pattern>'
    for name, lines in {"sliding": "M-1 1L1-1M0 6L6 0M5 7L7 5", "both": "M0 6L6 0M0 0L6 6"}.items()
)
"""What those fills call: lines in white, which tell patterns apart where colours do not."""


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
