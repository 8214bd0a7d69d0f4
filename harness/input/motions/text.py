"""Reading the text of record files: Fortran's numbers, which may touch each other, and headers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.input.motions.recordfile import unit_named
from harness.input.text_file import FOREIGN, UTF16_MARKS, decoded, fortran
from harness.model.errors import InputError, Mistake

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
    try:
        value = fortran(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < np.inf:
        raise mistake(where, place, f"{what}, a positive number", repr(text.strip()), "the header is damaged")
    return value


def header_count(text: str, where: str, place: str, what: str) -> int:
    """The whole number of two or more that a header gives for `what`; InputError naming its `place` where it gives none."""
    value = header_number(text, where, place, what)
    if value < 2.0 or value != int(value):
        raise mistake(where, place, f"{what}, a whole number of 2 or more", repr(text.strip()), "the header is damaged")
    return int(value)


def fixed_width(
    lines: Sequence[str], width: int, count: int, *, where: str, first_line: int, what: str = "accelerations"
) -> NDArray[np.float64]:
    """The first `count` numbers of `lines`: so many words, of any width, or columns of `width` characters that may touch.

    `first_line` is the number of lines[0] in the file, for messages. Raises InputError where numbers are missing, none, or more.
    """
    if not 1 <= width <= WIDEST:
        raise mistake(
            where, what, f"columns of 1 to {WIDEST} characters", f"a format of {width}", "the file is damaged"
        )
    padded = [_plain(line.rstrip()) for line in lines]
    padded = [line.ljust(-(-len(line) // width) * width) for line in padded]
    joined = "".join(padded)
    text = joined[: count * width]
    values = _words(padded, count)
    if values is None:
        # A last line may be filled up with noughts; other numbers are the next block's, or of a line that is there twice.
        if re.search("[1-9]", joined[count * width :]):
            advice = "a line is missing, or there twice: download the file again"
            raise mistake(where, what, f"{count} numbers in {len(lines)} lines, as its header says", "more", advice)
        try:
            values = _floats(text, [text[i : i + width] for i in range(0, len(text), width)])
        except ValueError:
            raise _bad_field(padded, width, where, first_line) from None
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


def _bad_field(lines: Sequence[str], width: int, where: str, first_line: int) -> InputError:
    for offset, line in enumerate(lines):
        for start in range(0, len(line), width):
            part = line[start : start + width]
            try:
                fortran(part)
            except ValueError:
                place = f"line {first_line + offset}, column {start + 1}"
                advice = "the file is damaged, or has lost blanks: take it as it was downloaded"
                if "\t" in line:
                    advice = "tabs stand where the network writes blanks: take the file as it was downloaded"
                return mistake(where, place, f"a number {width} characters wide", repr(part.strip()), advice)
    return mistake(
        where, f"line {first_line}", f"numbers {width} characters wide", "something else", "the file is damaged"
    )


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
    if values.size < count:
        raise mistake(where, place, f"{count} numbers, as its header says", str(values.size), CUT_OFF)
    return values[:count]


def check_rows(lines: Sequence[str], first: int, rows: int, where: str) -> None:
    """Raise InputError unless `rows` lines follow from lines[first] on."""
    if len(lines) < first + rows:
        got = f"{max(len(lines) - first, 0)} to the file's end"
        raise mistake(where, f"line {first + 1}", f"{rows} lines of numbers", got, CUT_OFF)


def columns(lines: Sequence[str], count: int, *, where: str, first_line: int) -> NDArray[np.float64]:
    """The numbers of `lines` in rows of `count` (n, count), blank lines left out; InputError naming a line with fewer or more."""
    whole = [(first_line + i, line) for i, line in enumerate(lines) if line.strip()]
    values = free_format([line for _, line in whole], where=where, first_line=first_line)
    if values.size != count * len(whole):
        for place, line in whole:
            had = free_format([line], where=where, first_line=place).size
            if had != count:
                raise mistake(where, f"line {place}", f"{count} numbers", str(had), "the file is damaged, or cut off")
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
        if not text:
            raise mistake(self.where, place, what, "none", "the header is damaged, or of another format")
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
        unit = unit_named(text)
        if unit is None:
            raise mistake(self.where, place, what, repr(text))
        return unit

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
