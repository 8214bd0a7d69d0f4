"""Headers of record files: values beside their names, numbers of points and steps, Fortran formats."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from harness.input.motions.text import WIDEST, header_count, header_number, mistake
from harness.input.text_file import fortran

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

    def peak(self, pattern: str) -> tuple[float | None, float | None]:
        """The peak that `pattern` catches and, by its second group, its time; None for what is no number, or before the start."""
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
    if match is None or not 1 <= int(match.group(2)) <= WIDEST:
        raise mistake(where, place, "a Fortran format such as (8F10.3)", repr(text.strip()), "the header is damaged")
    return max(int(match.group(1) or 1), 1), int(match.group(2))
