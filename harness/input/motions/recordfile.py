"""What a record file holds, whatever its format: channels on their own clocks and with their directions, in m/s²; and what a
user says of a text.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import SampledAcceleration
from harness.model.finding import Finding

# Directions of recorded channels, from the many ways in which networks write them.

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
class ChannelOrientation:
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


def parse_orientation(text: str) -> ChannelOrientation:
    """Direction named by `text`: "N28W", "067", "UP", "HNE", "EW" …; unknown where it names none."""
    token = re.sub(r"\s*DEG(REES?)?$", "", text.strip().strip("°.").upper())
    letters = re.sub(r"(?<=^[A-Z])\s*[-/]\s*(?=[A-Z]$)", "", token)
    if letters in _LINE:
        return ChannelOrientation(_LINE[letters], sense_assumed=True)
    if token in _UP or letters in _UPRIGHT_LINE:
        return ChannelOrientation(vertical=True, sense_assumed=letters in _UPRIGHT_LINE)
    if token in _DOWN:
        return ChannelOrientation(vertical=True, sign=-1)
    if token in _CARDINAL:
        return ChannelOrientation(_CARDINAL[token])
    if match := _QUADRANT.fullmatch(token):
        north, angle, east = match.group(1), float(match.group(2)), match.group(3)
        azimuth = angle if north == "N" else 180.0 - angle
        return ChannelOrientation((azimuth if east == "E" else -azimuth) % 360.0)
    if match := _SEED_CODE.fullmatch(token):
        return (
            ChannelOrientation(vertical=True)
            if match.group(1) == "Z"
            else ChannelOrientation(_CARDINAL[match.group(1)])
        )
    if _NUMBER.fullmatch(token) and not _PLACE.fullmatch(token) and float(token) <= 360.0:
        return ChannelOrientation(float(token) % 360.0)
    return ChannelOrientation()


# A uniform acceleration history on its way from a file to an excitation, with the list of what was done to it.

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Series:
    """Samples accel_m_s2 (n,) every dt_s, the first at t = 0, joined by straight lines; `done` says how they came about."""

    dt_s: float
    accel_m_s2: Floats
    done: tuple[Finding, ...] = ()

    @property
    def t_s(self) -> Floats:
        """Times of the samples (n,), s."""
        return np.asarray(self.dt_s * np.arange(self.accel_m_s2.size))

    @property
    def duration_s(self) -> float:
        """Time of the last sample, s."""
        return self.dt_s * (self.accel_m_s2.size - 1)

    def changed(self, accel_m_s2: Floats, step: Finding, *, dt_s: float | None = None) -> Series:
        """Other samples, with what was done to get them."""
        return replace(self, accel_m_s2=accel_m_s2, dt_s=self.dt_s if dt_s is None else dt_s, done=(*self.done, step))

    def excitation(self) -> SampledAcceleration:
        """The same motion for a solver."""
        return SampledAcceleration(self.t_s, self.accel_m_s2)


def velocity_m_s(series: Series) -> Floats:
    """Velocity at the samples (n,), m/s: the exact integral of the straight lines from rest."""
    accel = series.accel_m_s2
    return np.concatenate([[0.0], np.cumsum(0.5 * (accel[1:] + accel[:-1]) * series.dt_s)])


def displacement_m(series: Series) -> Floats:
    """Displacement at the samples (n,), m: the exact double integral of the straight lines from rest."""
    accel, dt = series.accel_m_s2, series.dt_s
    gained = velocity_m_s(series)[:-1] * dt + (accel[:-1] / 3.0 + accel[1:] / 6.0) * dt**2
    return np.concatenate([[0.0], np.cumsum(gained)])


def at_rest(accel_m_s2: Floats, dt_s: float, window: Floats | None = None) -> Floats:
    """Samples changed smoothly so that velocity and displacement are zero at the end (to rounding).

    Subtracts the combination of w(t) and t·w(t), w = sin²(πt/T) (or `window` (n,)), that carries both residuals.
    """
    n = accel_m_s2.size
    share = np.linspace(0.0, 1.0, n)
    shape = np.sin(np.pi * share) ** 2 if window is None else window
    basis = (shape, shape * (share - 0.5))
    result = np.array(accel_m_s2, dtype=np.float64)
    for _ in range(2):  # the second pass removes the first one's rounding
        gained = np.array([ends(Series(dt_s, part)) for part in basis]).T
        result -= np.tensordot(np.linalg.solve(gained, ends(Series(dt_s, result))), basis, axes=1)
    return result


def ends(series: Series) -> tuple[float, float]:
    """Velocity, m/s, and displacement, m, at the last sample."""
    return float(velocity_m_s(series)[-1]), float(displacement_m(series)[-1])


STANDARD_GRAVITY_M_S2: Final = 9.80665
UNITS_M_S2: Final[Mapping[str, float]] = MappingProxyType(
    {"m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 0.001, "g": STANDARD_GRAVITY_M_S2,
     "mg": STANDARD_GRAVITY_M_S2 / 1000.0, "%g": STANDARD_GRAVITY_M_S2 / 100.0}
)  # fmt: skip
UNIT_NAMES: Final = " or ".join(UNITS_M_S2)
_SPELLINGS: Final = {"ms2": "m/s2", "mps2": "m/s2", "cms2": "cm/s2", "cmps2": "cm/s2", "mms2": "mm/s2", "mmps2": "mm/s2",
                     "gal": "cm/s2", "gals": "cm/s2"}  # fmt: skip


FORMATS: Final[Mapping[str, bool]] = {
    "GeoNet V2A": True, "GeoNet V1A": False, "K-NET": True, "KiK-net": False, "USGS SMC": True,
    "USGS SMC, uncorrected": False, "CSMIP V1": False, "USC V1": False, "RENADIC V1": False, "BHRC V1": False,
    "CSMIP V2": True, "USC V2": False, "COSMOS": True, "COSMOS V0": False, "ITACA/ESM ASCII": True, "PEER AT2": True,
    "NSMN (AFAD)": False, "UNAM": False, "CWB": False, "CSV": True, "miniSEED/SAC": False,
}  # fmt: skip
"""Every format's name, and whether its reader was tried on files as the network publishes them."""


def unit_named(text: str) -> str | None:
    """The key of UNITS_M_S2 that `text` means (cm/sec/sec, cm/s^2, m/s², gal, g. …), or None."""
    plain = re.sub(
        r"met(?:er|re)s?", "m", re.sub(r"sec(?:ond)?s?", "s", text.lower().replace("⁻²", "2").replace("²", "2"))
    )
    bare = re.sub(r"[\s^*.·()\[\]_]|-(?=2)", "", plain.replace("s/s", "s2"))
    return bare if bare in UNITS_M_S2 else _SPELLINGS.get(bare)


@dataclass(frozen=True, eq=False)
class Channel:
    """One direction of a record: uniform samples accel_m_s2 (n,), read-only, the first at start_s on the file's clock.

    `stated_peak_m_s2` and `stated_peak_s` (after the first sample) are what the file's own header claims, for the checks.
    """

    name: str
    orientation: ChannelOrientation
    dt_s: float
    accel_m_s2: NDArray[np.float64]
    start_s: float = 0.0
    stated_peak_m_s2: float | None = None
    stated_peak_s: float | None = None

    def __post_init__(self) -> None:
        """Keep a read-only copy of the samples."""
        samples = np.array(self.accel_m_s2, dtype=np.float64)
        samples.setflags(write=False)
        object.__setattr__(self, "accel_m_s2", samples)

    @classmethod
    def read(
        cls, name: str, orientation: ChannelOrientation | None, dt_s: float, values: NDArray[np.float64], unit: str,
        peak: tuple[float | None, float | None] = (None, None), start_s: float = 0.0,
    ) -> Channel:  # fmt: skip
        """The channel of `values` in `unit` as a file holds them, turned so that up is positive; `peak` likewise.

        Without an orientation it points as its name says.
        """
        orientation = orientation or parse_orientation(name)
        factor = UNITS_M_S2[unit] * orientation.sign
        stated, at_s = peak
        return cls(name, orientation, dt_s, values * factor, start_s, None if stated is None else stated * factor, at_s)

    @property
    def t_s(self) -> NDArray[np.float64]:
        """Times of the samples on the file's clock (n,), s."""
        return np.asarray(self.start_s + self.dt_s * np.arange(self.accel_m_s2.size))


@dataclass(frozen=True, eq=False)
class RecordFile:
    """The channels of one record and where they came from.

    `group` is equal for files that hold other channels of the same record ("" where a file holds them all).
    """

    path: str
    format: str
    unit: str
    channels: tuple[Channel, ...]
    facts: Mapping[str, str] = field(default_factory=dict)
    group: str = ""
    findings: tuple[Finding, ...] = ()

    @property
    def tested(self) -> bool:
        """Whether this format's reader has been tried on files as its network publishes them."""
        return FORMATS.get(self.format, True)

    @property
    def horizontals(self) -> tuple[Channel, ...]:
        """Channels known to be horizontal, with their azimuths."""
        return tuple(channel for channel in self.channels if channel.orientation.azimuth_deg is not None)

    @property
    def verticals(self) -> tuple[Channel, ...]:
        """Channels known to be vertical, positive upwards."""
        return tuple(channel for channel in self.channels if channel.orientation.vertical)


WHOLE: Final = "all"
"""`columns` of one channel whose numbers run on from line to line."""


@dataclass(frozen=True)
class Layout:
    """`--dt`, `--skip-lines`, `--columns` ("2,3" or "2:N,3:E", or "all") and `--time-column` (columns count from 1)."""

    dt_s: float | None = None
    skip_lines: int | None = None
    columns: str | None = None
    time_column: int | None = None

    @property
    def given(self) -> bool:
        """Whether anything is said."""
        return self != Layout()

    def options(self) -> str:
        """The same as options of `rockcheck motion inspect`."""
        said = (("skip-lines", self.skip_lines), ("time-column", self.time_column), ("columns", self.columns))
        words = [f"--{name} {value}" for name, value in said if value]
        return " ".join([*words, *([f"--dt {self.dt_s:g}"] if self.dt_s is not None else [])])
