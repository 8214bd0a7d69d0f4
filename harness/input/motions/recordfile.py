"""What a record file holds, whatever its format: channels on their own clocks, in m/s²; and what a user says of a text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.input.motions.orientation import Orientation, parse_orientation
from harness.model.finding import Finding

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
    orientation: Orientation
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
        cls, name: str, orientation: Orientation | None, dt_s: float, values: NDArray[np.float64], unit: str,
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
