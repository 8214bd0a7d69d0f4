"""What a record file holds, whatever its format: channels on their own clocks and with their directions, in m/s²; what a user
says of a text, how Fortran's numbers and headers are read, and what makes a record doubtful.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import SampledAcceleration
from harness.input.files import FOREIGN, UTF16_MARKS, decoded, fortran
from harness.model import Finding, InputError, Mistake, caution, info, require, required

# Directions of recorded channels, from the many ways in which networks write them.

_QUADRANT = re.compile(r"([NS])\s*(\d{1,2}(?:\.\d+)?)\s*([EW])", re.IGNORECASE)
_AZIMUTH = re.compile(r"[0-9]{1,3}(?:\.[0-9]+)?")
_SEED_CODE = re.compile(r"[HBECSMDL][NLHG]([NEZ])", re.IGNORECASE)
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


_NAMED: Final = {
    name: orientation
    for names, orientation in (
        ("N NORTH", ChannelOrientation(0.0)),
        ("E EAST", ChannelOrientation(90.0)),
        ("S SOUTH", ChannelOrientation(180.0)),
        ("W WEST", ChannelOrientation(270.0)),
        ("UP U Z V VER VERT VERTICAL UPDO", ChannelOrientation(vertical=True)),
        ("DN DWN DOWN", ChannelOrientation(vertical=True, sign=-1)),
        ("NS SN", ChannelOrientation(0.0, sense_assumed=True)),
        ("EW WE", ChannelOrientation(90.0, sense_assumed=True)),
        ("UD DU", ChannelOrientation(vertical=True, sense_assumed=True)),
    )
    for name in names.split()
}
"""The last three name a line rather than a direction. Networks that use them count towards north, east and up, whichever letter
comes first: K-NET's manual says so of N-S and E-W, ITACA's WE is the channel that ESM calls HNE."""


def parse_orientation(text: str) -> ChannelOrientation:
    """Direction named by `text`: "N28W", "067", "UP", "HNE", "EW", "E-W" …; unknown where it names none."""
    token = re.sub(r"\s*DEG(REES?)?$", "", text.strip().strip("°.").upper())
    token = re.sub(r"(?<=^[A-Z])\s*[-/]\s*(?=[A-Z]$)", "", token)
    if token in _NAMED:
        return _NAMED[token]
    if match := _QUADRANT.fullmatch(token):
        north, angle, east = match.group(1), float(match.group(2)), match.group(3)
        azimuth = angle if north == "N" else 180.0 - angle
        return ChannelOrientation((azimuth if east == "E" else -azimuth) % 360.0)
    if match := _SEED_CODE.fullmatch(token):
        return _NAMED[match.group(1)]
    if _AZIMUTH.fullmatch(token) and not _PLACE.fullmatch(token) and float(token) <= 360.0:
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

    def options(self) -> str:
        """The same as options of `rockcheck motion inspect`."""
        said = (("skip-lines", self.skip_lines), ("time-column", self.time_column), ("columns", self.columns))
        words = [f"--{name} {value}" for name, value in said if value]
        return " ".join([*words, *([f"--dt {self.dt_s:g}"] if self.dt_s is not None else [])])


# Reading the text of record files: Fortran's numbers, which may touch each other, and headers.

WIDEST: Final = 64
"""Characters of a number: no format of a network is wider, and a damaged one would ask for lines without end."""
NOT_NUMBERS: Final = "the file is damaged, not of this format, or has notes after its numbers: take these out"
CUT_OFF: Final = "the file is cut off: download it again"
DOS_END: Final = b"\x1a"
"""Programs of DOS ended a text with this byte, and files of the 1980s and 1990s still do."""
_PADDING = re.compile(rb"\x00+(?=[\r\n])|(?<=\n)\x00+")
_NUMBER = r"[+-]?(?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eEdD]))(?:[eEdD][+-]?[0-9]+|[+-][0-9]{1,3}(?![0-9.]))?"
_NUMBERS = re.compile(_NUMBER)
NUMERIC: Final = re.compile(r"[\s0-9.+\-eEdD]*[0-9][\s0-9.+\-eEdD]*")
"""A line of numbers, whatever their form."""
_WHOLE = re.compile(r"[+-]?[0-9]+")


def mistake(where: str, key: str, wanted: str, got: str, advice: str = "") -> InputError:
    """The InputError of this one mistake, to be raised."""
    return InputError(Mistake(where, key, wanted, got, advice))


def text_of(raw: bytes, where: str) -> str:
    """The text of a file's bytes (UTF-8, UTF-16 by its mark, else Latin-1), without what fills it up; InputError for none.

    Programs of tapes and disks filled lines, or the file's last block, with NULs, and ended a text with DOS's mark.
    """
    plain = raw
    if not raw.startswith(UTF16_MARKS):
        ended = raw.rstrip(DOS_END + b"\x00")
        plain = _PADDING.sub(b"", ended) if b"\x00" in ended else ended
    return decoded(plain.rstrip(DOS_END), where, "an accelerogram", latin=True)


def header_number(text: str, where: str, place: str, what: str) -> float:
    """The finite positive number that a header gives for `what`; InputError naming its `place` where it gives none."""
    value = _number(text) or 0.0
    require(
        0.0 < value < np.inf,
        where,
        f"{what}, a positive number",
        repr(text.strip()),
        "the header is damaged",
        key=place,
    )
    return value


def header_count(text: str, where: str, place: str, what: str) -> int:
    """The whole number of two or more that a header gives for `what`; InputError naming its `place` where it gives none."""
    value = header_number(text, where, place, what)
    require(
        value >= 2.0 and value == int(value),
        where,
        f"{what}, a whole number of 2 or more",
        repr(text.strip()),
        "the header is damaged",
        key=place,
    )
    return int(value)


def block(
    lines: Sequence[str], first: int, count: int, form: tuple[int, int], where: str, what: str = "accelerations"
) -> NDArray[np.float64]:
    """The `count` numbers from lines[first] on, so many in a line and so wide as `form` says (`fortran_format`)."""
    per_line, width = form
    rows = lines[first : first - (-count // per_line)]
    return fixed_width(rows, width, count, where=where, first_line=first + 1, what=what)


def fixed_width(
    lines: Sequence[str], width: int, count: int, *, where: str, first_line: int, what: str = "accelerations"
) -> NDArray[np.float64]:
    """The first `count` numbers of `lines`: so many words, of any width, or columns of `width` characters that may touch.

    `first_line` is the number of lines[0] in the file, for messages. Raises InputError where numbers are missing, none, or more.
    """
    padded = [_plain(line.rstrip()) for line in lines]
    padded = [line.ljust(-(-len(line) // width) * width) for line in padded]
    values = _words(padded, count)
    if values is None:
        # A last line may be filled up with noughts; other numbers are the next block's, or of a line that is there twice.
        require(
            not re.search("[1-9]", "".join(padded)[count * width :]),
            where,
            f"{count} numbers in {len(lines)} lines, as its header says",
            "more",
            "a line is missing, or there twice: download the file again",
            key=what,
        )
        places = [(i, start) for i, line in enumerate(padded) for start in range(0, len(line), width)][:count]
        values = np.array([_field(padded[i], start, width, where, first_line + i) for i, start in places])
    return finite(first_of(values, count, where, what), where, what)


def _words(lines: Sequence[str], count: int) -> NDArray[np.float64] | None:
    """The numbers of `lines` where blanks stand between them all and they are `count`; None else."""
    text = " ".join(lines)
    words = text.split()
    try:
        return _floats(text, words) if len(words) == count else None
    except ValueError:
        return None


def _plain(line: str) -> str:
    return line.replace("D", "E").replace("d", "E")


def _floats(text: str, fields: Sequence[str]) -> NDArray[np.float64]:
    """Words or columns of `text` as numbers; ValueError where it holds what no number of Fortran's does."""
    # numpy, too, would take 1_0 and infinity for numbers.
    if FOREIGN.search(text):
        raise ValueError("not a number")
    try:
        return np.array(fields, dtype=np.float64)
    except ValueError:
        return np.array([fortran(field) for field in fields])


def _field(line: str, start: int, width: int, where: str, number: int) -> float:
    """The number in `width` characters of a line; InputError where they hold none."""
    part = line[start : start + width]
    if (value := _number(part)) is not None:
        return value
    advice = "the file is damaged, or has lost blanks: take it as it was downloaded"
    if "\t" in line:
        advice = "tabs stand where the network writes blanks: take the file as it was downloaded"
    place = f"line {number}, column {start + 1}"
    raise mistake(where, place, f"a number {width} characters wide", repr(part.strip()), advice)


def finite(values: NDArray[np.float64], where: str, what: str) -> NDArray[np.float64]:
    """`values` themselves; InputError where one is not finite."""
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        advice = "cut the record or fill the gap in the program that made it"
        raise mistake(
            where, f"{what}, number {bad[0] + 1}", "finite numbers", f"{values[bad[0]]} ({bad.size} such)", advice
        )
    return values


def free_format(lines: Sequence[str], *, where: str, first_line: int) -> NDArray[np.float64]:
    """All numbers of `lines`, also where they touch ("1.234-5.678", "1E-3-2E-3"); InputError at anything else."""
    plain = _plain(" ".join(lines))
    try:
        values = _floats(plain, plain.split())
    except ValueError:
        values = np.array([number for i, line in enumerate(lines) for number in _touching(line, where, first_line + i)])
    return finite(values, where, "accelerations")


def first_of(values: NDArray[np.float64], count: int, where: str, place: str) -> NDArray[np.float64]:
    """The first `count` of `values` (n,); InputError naming `place` where there are fewer."""
    require(values.size >= count, where, f"{count} numbers, as its header says", str(values.size), CUT_OFF, key=place)
    return values[:count]


def check_rows(lines: Sequence[str], first: int, rows: int, where: str) -> None:
    """Raise InputError unless `rows` lines follow from lines[first] on."""
    require(
        len(lines) >= first + rows,
        where,
        f"{rows} lines of numbers",
        f"{max(len(lines) - first, 0)} to the file's end",
        CUT_OFF,
        key=f"line {first + 1}",
    )


def columns(lines: Sequence[str], count: int, *, where: str, first_line: int) -> NDArray[np.float64]:
    """The numbers of `lines` in rows of `count` (n, count), blank lines left out; InputError naming a line with fewer or more."""
    whole = [(first_line + i, line) for i, line in enumerate(lines) if line.strip()]
    values = free_format([line for _, line in whole], where=where, first_line=first_line)
    if values.size != count * len(whole):
        for place, line in whole:
            had = free_format([line], where=where, first_line=place).size
            require(
                had == count,
                where,
                f"{count} numbers",
                str(had),
                "the file is damaged, or cut off",
                key=f"line {place}",
            )
    return values.reshape(-1, count)


def _touching(line: str, where: str, number: int) -> list[float]:
    values: list[float] = []
    for word in line.split():
        numbers = _NUMBERS.findall(word)
        if "".join(numbers) != word or any(part[0] not in "+-" for part in numbers[1:]):
            if not _WHOLE.fullmatch(word):
                raise mistake(where, f"line {number}", "numbers", repr(word), NOT_NUMBERS)
            numbers = [word]
        values += [fortran(part) for part in numbers]
    return values


_FORMAT = re.compile(r"\(?\s*(\d*)\s*\(?\s*[IFEGD](\d+)", re.IGNORECASE)


@dataclass(frozen=True)
class Header:
    """The lines of a header, the first of them line `first` + 1 of the file `where`."""

    lines: Sequence[str]
    where: str
    first: int = 0

    def find(self, pattern: str) -> tuple[str, str]:
        """What the first group of `pattern` catches, blanks around it cut, and its line; "" and "header" where nothing."""
        seek = re.compile(pattern, re.IGNORECASE)
        for i, line in enumerate(self.lines):
            if match := seek.search(line):
                return match.group(1).strip(), f"line {self.first + i + 1}"
        return "", "header"

    def words(self, pattern: str) -> str:
        """What `pattern` catches, "" where nothing."""
        return self.find(pattern)[0]

    def needed(self, pattern: str, what: str) -> tuple[str, str]:
        """As `find`; InputError, wanting `what`, where it catches nothing."""
        text, place = self.find(pattern)
        require(text, self.where, what, "none", "the header is damaged, or of another format", key=place)
        return text, place

    def number(self, pattern: str, what: str) -> float:
        """The positive number that `pattern` catches; InputError."""
        text, place = self.needed(pattern, what)
        return header_number(text, self.where, place, what)

    def count(self, pattern: str, what: str = "number of points") -> int:
        """The whole number of 2 or more that `pattern` catches; InputError."""
        text, place = self.needed(pattern, what)
        return header_count(text, self.where, place, what)

    def unit(self, pattern: str, what: str) -> str:
        """The unit of acceleration that `pattern` catches; InputError."""
        text, place = self.needed(pattern, what)
        return required(unit_named(text), self.where, what, repr(text), key=place)

    def peak(self, pattern: str) -> tuple[float | None, float | None]:
        """The peak that `pattern` catches and, by its second group, its time; None where not a number, or before the start."""
        seek = re.compile(pattern, re.IGNORECASE)
        match = next((hit for line in self.lines if (hit := seek.search(line))), None)
        peak, at_s = (_number(text) for text in (*(match.groups() if match else ()), None, None)[:2])
        return peak, None if at_s is None or at_s < 0.0 else at_s


def _number(text: str | None) -> float | None:
    try:
        return fortran(text or "")
    except ValueError:
        return None


def fortran_format(text: str, where: str, place: str) -> tuple[int, int]:
    """Numbers in a line and characters in a number by a format such as (8F10.5), (5E15.6) or (1E15.6); InputError."""
    match = _FORMAT.search(text)
    if match is None or len(match.group()) > WIDEST or not 1 <= int(match.group(2)) <= WIDEST:
        raise mistake(where, place, "a Fortran format such as (8F10.3)", repr(text.strip()), "the header is damaged")
    return max(int(match.group(1) or 1), 1), int(match.group(2))


# Integrity of a record: what makes it unusable is refused, what only makes it doubtful is said.


LARGEST_PEAK_G: Final = 10.0
"""No free-field accelerogram has exceeded about 4 g (Iwate 2008): above 10 g the unit is wrong."""
STEPS_S: Final = (1e-6, 1.0)
"""Shorter and longer steps than any accelerograph's: a longer one says nothing of the periods that rock a statue."""
USUAL_STEPS_S: Final = (2e-4, 0.05)
"""Accelerographs sample 50 to 1000 times a second, digitised film at 0.005 to 0.04 s: beyond, a step was misread or mistyped."""
PLAUSIBLE_G: Final = (0.005, 5.0)
SMALLEST_PEAK_G: Final = 5e-4
STATED_PEAK_TOLERANCE: Final = 0.01
"""Headers round a peak to three digits or more."""
ABRUPT: Final = 0.1
"""Share of the peak that a record cut within its shaking still has at an end."""
DRIFT_VELOCITY: Final = 0.25
"""Share of the peak velocity that remains at the end; corrected records keep less than 0.1, an offset of any size 1."""
DRIFT_PATH: Final = (0.9, 0.01)
"""Shares of the peak displacement, and of the way at peak velocity, that lie between start and end. Corrected records keep less
than 0.008 of the way; a fling's lasting displacement is reached in a second or two of strong velocity, not over a minute."""
FILLERS: Final = np.array(
    [float("9" * whole + "." + "9" * part) for whole in range(3, 10) for part in range(5)]
    + [2.0**bits - less for bits in (15, 23, 31) for less in (0, 1)]
)
"""Numbers that programs write where they have none: nines, and the ends of a recorder's whole numbers."""
FILLER_STEP: Final = (0.5, 0.1)
"""Of a filler: how far it is from its neighbours, where it is whole, and where it has decimals (none is a sample by chance)."""
FILLER_TIMES: Final = 3
FILL: Final = "cut the record, or fill its gap in the program that made it"
SPIKE: Final = 3.0
"""Times all other samples: no floor moves so for one sample."""
SPIKES: Final = 0.01
FEWEST: Final = 100
_END_SHARE, _FLAT_SAMPLES, _STRONG = 0.01, 10, (0.05, 0.95)


def check(record: RecordFile) -> tuple[Finding, ...]:
    """What is doubtful of every channel; InputError for a record that cannot be one in the unit it is said to have."""
    doubts = [
        replace(found, values={"channel": channel.name, **found.values})
        for channel in record.channels
        for found in _channel(channel, record)
    ]
    if not FORMATS.get(record.format, True):
        doubts.append(caution("record_reader_untested", format=record.format))
    return tuple(doubts)


def _channel(channel: Channel, record: RecordFile) -> Iterator[Finding]:
    accel = channel.accel_m_s2
    require(
        accel.size >= 2,
        record.path,
        "two samples or more",
        str(accel.size),
        "the file holds no motion",
        key=channel.name,
    )
    least_s, most_s = STEPS_S
    require(
        least_s <= channel.dt_s <= most_s,
        record.path,
        f"a step between {least_s:g} and {most_s:g} s",
        f"{channel.dt_s:g} s",
        key=channel.name,
    )
    if record.unit in UNITS_M_S2:
        refuse_fillers(accel / UNITS_M_S2[record.unit], record.path, lambda row: f"{channel.name}, sample {row + 1}")
    peak_g = float(np.abs(accel).max()) / STANDARD_GRAVITY_M_S2
    require(peak_g != 0.0, record.path, "a motion", "nothing but zeros", key=channel.name)
    spikes = _spikes(channel, record)
    if peak_g > LARGEST_PEAK_G:
        likely = _likely_units(peak_g, record.unit)
        if spikes:
            likely = f"{spikes['alone']} of {spikes['samples']} samples stand alone above all others: spikes, or missing samples?"
        raise mistake(
            record.path, channel.name, f"a peak below {LARGEST_PEAK_G:g} g", f"{peak_g:.4g} g in {record.unit}", likely
        )
    yield from _of_clock_and_sense(channel)
    if spikes:
        yield caution("record_spikes", **spikes)
    against = [*_against_header(channel)]
    if peak_g < SMALLEST_PEAK_G:
        claimed = channel.stated_peak_m_s2 is not None and not against
        units = [*_fitting_units(peak_g, record.unit)]
        yield caution("record_small", peak_g=peak_g, stated=claimed, units=units)
    yield from against
    yield from _drift(channel)
    edge = max(1, int(_END_SHARE * accel.size))
    for name, part in (("begins", accel[:edge]), ("ends", accel[-edge:])):
        share = float(np.abs(part).max() / np.abs(accel).max())
        if share > ABRUPT:
            yield caution("record_abrupt", at=name, share=share)
    run = _longest_flat(accel)
    if run > _FLAT_SAMPLES:
        yield caution("record_flat", lasts_s=run * channel.dt_s)


def refuse_fillers(values: Floats, where: str, place: Callable[[int], str]) -> None:
    """InputError at a number that programs write where a sample is missing (999.99, -9999, …) and that leaves the others' course.

    `values` (n,) are as the file has them; `place` names the place of one by its row. A whole number, which a sample can be by
    chance, must also be the largest of all, come again, or bend the others' course as nothing else does.
    """
    size = np.abs(values)
    rows = np.flatnonzero(np.isin(np.round(size, 6), FILLERS))
    if not rows.size:
        return
    before, after = (np.flatnonzero(np.concatenate(ends)) for ends in (
        ([True], np.diff(values) != 0.0), (np.diff(values) != 0.0, [True])
    ))  # fmt: skip
    runs = np.isin(before, rows)
    first, last = before[runs], after[runs]
    step = FILLER_STEP[0] * size[first]
    step[size[first] % 1.0 > 0.0] *= FILLER_STEP[1] / FILLER_STEP[0]
    left = np.where(first > 0, np.abs(values[first] - values[first - 1]), np.inf)
    right = np.where(last < values.size - 1, np.abs(values[last] - values[(last + 1) % values.size]), np.inf)
    alone = (left > step) & (right > step)
    bends = np.abs(np.diff(values, 2))
    bends = np.pad(bends, (1, values.size - 1 - bends.size))
    near = np.concatenate([first - 1, first, last, last + 1]).clip(0, values.size - 1)
    usual = float(np.delete(bends, near).max(initial=0.0))
    for value in np.unique(values[first[alone]]):
        same = alone & (values[first] == value)
        row, times = int(first[same][0]), int((last - first + 1)[same].sum())
        sure = size[row] % 1.0 > 0.0 or size[row] >= size.max() or times >= FILLER_TIMES
        if sure or bends[row] > SPIKE * usual > 0.0:
            got = f"{value:.10g} ({times} such), which programs write where a sample is missing"
            raise mistake(where, place(row), "an acceleration", got, FILL)


def _spikes(channel: Channel, record: RecordFile) -> dict[str, object]:
    """Samples that stand alone above all others, in the file's unit; nothing where none does."""
    size = np.abs(channel.accel_m_s2)
    low = size[size < size.max() * (1.0 - FILLER_STEP[1])]
    highest = float(low.max()) if low.size else 0.0
    if size.size < FEWEST or highest <= 0.0 or size.max() < SPIKE * highest or low.size < (1.0 - SPIKES) * size.size:
        return {}
    row = int(np.argmax(size))
    unit = record.unit if record.unit in UNITS_M_S2 else "m/s2"
    peak, others = (value / UNITS_M_S2[unit] for value in (channel.accel_m_s2[row], highest))
    counts = {"alone": size.size - low.size, "samples": size.size}
    return counts | {"peak": peak, "others": others, "unit": unit, "at_s": float(channel.t_s[row])}


def _of_clock_and_sense(channel: Channel) -> Iterator[Finding]:
    """What is doubtful in the step, and what was taken for granted of the direction."""
    least_s, most_s = USUAL_STEPS_S
    if not least_s <= channel.dt_s <= most_s:
        lasts = channel.dt_s * (channel.accel_m_s2.size - 1)
        yield caution("record_step", dt_s=channel.dt_s, lasts_s=lasts)
    if channel.orientation.sense_assumed:
        yield caution("record_sense_assumed")
    if channel.orientation.sign < 0:
        yield info("record_downwards")


def _drift(channel: Channel) -> Iterator[Finding]:
    """Whether the record runs away when it is integrated, and what takes that off."""
    series = Series(channel.dt_s, channel.accel_m_s2)
    velocity, path_m = velocity_m_s(series), displacement_m(series)
    fastest, farthest = float(np.abs(velocity).max()), float(np.abs(path_m).max())
    of_peak, of_way = DRIFT_PATH
    last_m_s, last_m = float(velocity[-1]), float(path_m[-1])
    far = max(of_peak * farthest, of_way * fastest * series.duration_s)
    if abs(last_m_s) > DRIFT_VELOCITY * fastest or abs(last_m) > far:
        yield caution("record_drifts", velocity_m_s=last_m_s, displacement_m=last_m)


def _against_header(channel: Channel) -> Iterator[Finding]:
    """What of the header's peak the samples do not show."""
    accel, stated = channel.accel_m_s2, channel.stated_peak_m_s2
    if stated is None:
        return
    at = int(np.argmax(np.abs(accel)))
    if abs(abs(accel[at]) - abs(stated)) > STATED_PEAK_TOLERANCE * abs(stated):
        yield caution("record_peak_stated", peak_m_s2=float(accel[at]), stated_m_s2=stated)
    if channel.stated_peak_s is not None and abs(at * channel.dt_s - channel.stated_peak_s) > 2.0 * channel.dt_s:
        yield caution("record_peak_time", at_s=at * channel.dt_s, stated_s=channel.stated_peak_s)


def _likely_units(peak_g: float, unit: str) -> str:
    """Units in which these numbers would be an ordinary earthquake, as advice."""
    if unit not in UNITS_M_S2:
        return "look at the columns' units"
    said = [f"{name} ({value:.3g} g)" for name, value in _fitting_units(peak_g, unit).items()]
    return "the unit may be " + " or ".join(said) if said else "the unit or the file is wrong"


def _fitting_units(peak_g: float, unit: str) -> dict[str, float]:
    """Those units, with the peak in g; none where the file has several."""
    if unit not in UNITS_M_S2:
        return {}
    low, high = PLAUSIBLE_G
    peaks = {name: peak_g * factor / UNITS_M_S2[unit] for name, factor in UNITS_M_S2.items() if name != unit}
    return {name: value for name, value in peaks.items() if low <= value <= high}


def _longest_flat(accel: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> int:
    """Longest run of equal values (in steps) between 5 % and 95 % of the squared acceleration's integral."""
    build = np.cumsum(accel**2)
    first, last = (int(np.searchsorted(build, share * build[-1])) for share in _STRONG)
    equal = np.concatenate([[0], (np.diff(accel[first : last + 1]) == 0.0).astype(np.int8), [0]])
    edges = np.flatnonzero(np.diff(equal))
    return int((edges[1::2] - edges[::2]).max()) if edges.size else 0
