"""Directions of recorded channels, from the many ways in which networks write them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

_QUADRANT = re.compile(r"([NS])\s*(\d{1,2}(?:\.\d+)?)\s*([EW])", re.IGNORECASE)
_NUMBER = re.compile(r"[0-9]{1,3}(?:\.[0-9]+)?")
_SEED_CODE = re.compile(r"[HBECSMDL][NLHG]([NEZ])", re.IGNORECASE)
_CARDINAL: Final = {
    "N": 0.0,
    "NORTH": 0.0,
    "E": 90.0,
    "EAST": 90.0,
    "S": 180.0,
    "SOUTH": 180.0,
    "W": 270.0,
    "WEST": 270.0,
}
_LINE: Final = {"NS": 0.0, "SN": 0.0, "EW": 90.0, "WE": 90.0}
"""Names of a line rather than of a direction. Networks that use them count towards north and east, whichever letter comes
first: K-NET's manual says so of N-S and E-W, ITACA's WE is the channel that ESM calls HNE."""
_UP: Final = frozenset({"UP", "U", "Z", "V", "VER", "VERT", "VERTICAL", "UPDO"})
_UPRIGHT_LINE: Final = frozenset({"UD", "DU"})
_DOWN: Final = frozenset({"DN", "DWN", "DOWN"})
_PLACE = re.compile(r"[1-9]")
"""A channel's number in its file; an azimuth is written with two digits or three."""


@dataclass(frozen=True)
class Orientation:
    """A channel's direction: its azimuth clockwise from north in [0, 360), or vertical, or neither known.

    `sign` is −1 where the file counts downwards as positive; `sense_assumed` where its name says a line,
    but not which way along it.
    """

    azimuth_deg: float | None = None
    vertical: bool = False
    sign: int = 1
    sense_assumed: bool = False

    def __str__(self) -> str:
        if self.vertical:
            return "up"
        return "direction unknown" if self.azimuth_deg is None else f"azimuth {self.azimuth_deg:g}°"


def parse_orientation(text: str) -> Orientation:
    """Direction named by `text`: "N28W", "067", "UP", "HNE", "EW" …; unknown where it names none."""
    token = re.sub(r"\s*DEG(REES?)?$", "", text.strip().strip("°.").upper())
    letters = re.sub(r"(?<=^[A-Z])\s*[-/]\s*(?=[A-Z]$)", "", token)
    if letters in _LINE:
        return Orientation(_LINE[letters], sense_assumed=True)
    if token in _UP or letters in _UPRIGHT_LINE:
        return Orientation(vertical=True, sense_assumed=letters in _UPRIGHT_LINE)
    if token in _DOWN:
        return Orientation(vertical=True, sign=-1)
    if token in _CARDINAL:
        return Orientation(_CARDINAL[token])
    if match := _QUADRANT.fullmatch(token):
        north, angle, east = match.group(1), float(match.group(2)), match.group(3)
        azimuth = angle if north == "N" else 180.0 - angle
        return Orientation((azimuth if east == "E" else -azimuth) % 360.0)
    if match := _SEED_CODE.fullmatch(token):
        return Orientation(vertical=True) if match.group(1) == "Z" else Orientation(_CARDINAL[match.group(1)])
    if _NUMBER.fullmatch(token) and not _PLACE.fullmatch(token) and float(token) <= 360.0:
        return Orientation(float(token) % 360.0)
    return Orientation()
