"""Reading the text of record files: gzip transparently, and Fortran's numbers, which may touch each other."""

from __future__ import annotations

import gzip
import re
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError, Mistake

_GZIP_MAGIC = b"\x1f\x8b"
_NUMBER = r"[+-]?(?:\d+\.\d*|\.\d+|\d+(?=[eEdD]))(?:[eEdD][+-]?\d+|[+-]\d{3}(?![\d.]))?"
_NUMBERS = re.compile(_NUMBER)
_BARE_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d{3})$")
_WHOLE = re.compile(r"[+-]?\d+")


def mistake(where: str, key: str, wanted: str, got: str, advice: str = "") -> InputError:
    """The InputError of this one mistake, to be raised."""
    return InputError(Mistake(where, key, wanted, got, advice))


def read_text(path: Path) -> str:
    """The file's text, unzipped where it begins with gzip's mark (ASCII, else Latin-1); InputError where that fails."""
    where = str(path)
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise mistake(where, "", "a readable file", str(error.strerror)) from error
    if raw[:2] == _GZIP_MAGIC:
        try:
            raw = gzip.decompress(raw)
        except (OSError, EOFError, zlib.error) as error:
            raise mistake(
                where, "", "a whole gzip file", f"one that does not unpack ({error})", "download it again"
            ) from error
    if not raw.strip():
        raise mistake(where, "", "an accelerogram", "an empty file")
    if b"\x00" in raw[:4096]:
        raise mistake(where, "", "a text file", "binary data", "export the record as text (AT2, V2, SMC, CSV …)")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def fixed_width(
    lines: Sequence[str], width: int, count: int, *, where: str, first_line: int, what: str = "accelerations"
) -> NDArray[np.float64]:
    """The first `count` numbers of `lines` in columns of `width` characters, blanks or none between them.

    `first_line` is the number of lines[0] in the file, for messages. Raises InputError where numbers are missing or none.
    """
    if width < 1:
        raise mistake(where, what, "columns of one character or more", f"a format of {width}", "the file is damaged")
    padded = [line.rstrip() for line in lines]
    padded = [line.ljust(-(-len(line) // width) * width) for line in padded]
    try:
        fields = np.frombuffer("".join(padded).encode("ascii"), dtype=f"S{width}")[:count]
        values = fields.astype(np.float64)
    except (ValueError, UnicodeEncodeError):
        raise _bad_field(padded, width, where, first_line) from None
    if values.size < count:
        raise mistake(where, what, f"{count} numbers, as its header says", f"{values.size}", "the file is cut off")
    return finite(values, where, what)


def _bad_field(lines: Sequence[str], width: int, where: str, first_line: int) -> InputError:
    for offset, line in enumerate(lines):
        for start in range(0, len(line), width):
            part = line[start : start + width]
            try:
                float(part)
            except ValueError:
                place = f"line {first_line + offset}, column {start + 1}"
                return mistake(
                    where, place, f"a number {width} characters wide", repr(part.strip()), "the file is damaged"
                )
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
    try:
        values = np.array(" ".join(lines).split(), dtype=np.float64)
    except ValueError:
        values = np.array([number for i, line in enumerate(lines) for number in _touching(line, where, first_line + i)])
    return finite(values, where, "accelerations")


def _touching(line: str, where: str, number: int) -> list[float]:
    values: list[float] = []
    for word in line.split():
        found = _NUMBERS.findall(word)
        if "".join(found) != word or any(part[0] not in "+-" for part in found[1:]):
            if not _WHOLE.fullmatch(word):
                raise mistake(
                    where, f"line {number}", "numbers", repr(word), "the file is damaged, or not of this format"
                )
            found = [word]
        values += [float(_BARE_EXPONENT.sub(r"e\1", part.replace("D", "e").replace("d", "e"))) for part in found]
    return values
