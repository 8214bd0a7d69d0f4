"""What may be laid under a pedestal: published coefficients of friction of pairs of materials."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Pair:
    """Two materials: the static and kinetic coefficients used, the published range, and who published it."""

    name: str
    static: float
    kinetic: float
    published: str
    source: str


PAIRS: Final = (
    Pair(
        "PTFE on steel",
        0.04,
        0.04,
        "0.04 on steel, 0.04 to 0.20 on itself; changes with pressure and speed",
        "Engineering ToolBox, Friction and friction coefficients",
    ),
    Pair(
        "smooth stone on stone",
        0.40,
        0.30,
        "0.40 static and 0.30 kinetic, assumed there for a statue's pedestal",
        "Monaco et al., Procedia Structural Integrity 29 (2020) 134-141",
    ),
    Pair(
        "rough granite or limestone, dry",
        0.75,
        0.75,
        "0.67 to 0.84, one value for both; wet it is much less",
        "Statics of drystone walls, stonewalls.ch",
    ),
    Pair(
        "rubber on dry concrete",
        1.0,
        0.8,
        "static 1.0, kinetic 0.60 to 0.85; wet 0.30 and 0.25",
        "Serway and Beichner, Physics for Scientists and Engineers, 5th ed., Table 5.2; ranges: hypertextbook.com/facts/2006",
    ),
)
"""A pair's coefficients differ from one surface to the next by a third and more: measure before building."""
