"""Small, reproducible damage to a file: what editors, networks, spreadsheets and hands do to it."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from typing import Final

import numpy as np

Stream = np.random.Generator
Mutation = Callable[[bytes, Stream], bytes]

NUMBER: Final = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
DIGIT: Final = re.compile(rb"\d")
FACTORS: Final = (-1.0, 0.0, 0.5, 2.0, 10.0, 1e-3, 1e3, 1e-12, 1e12, 1e150, 1e-150)
ODD_FLOATS: Final = (0.0, -1.0, 1e-30, 1e30, float("nan"), float("inf"), 0.5, 2.0)
ODD_VALUES: Final = (
    b"nan", b"inf", b"-inf", b"1e999", b"-1", b"0", b"1e-300", b"1e300", b"1e18", b"", b"x", b'"3"', b"3,5", b"0x10",
    b"true", b"[]", b"{}", b"9999999999999999999999", b"-0.0", b"1_000",
)  # fmt: skip
ODD_TEXT: Final = (
    b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", "é θ 😀".encode(), b"\r", b"\t", b'"', b"'''", b"#", b"[[", b"=", b",,,", b"\x1a",
)  # fmt: skip


def flip(data: bytes, rng: Stream) -> bytes:
    """One to eight bytes replaced."""
    out = bytearray(data)
    for place in rng.integers(0, max(len(out), 1), int(rng.integers(1, 9))):
        if out:
            out[int(place)] = int(rng.integers(256))
    return bytes(out)


def truncate(data: bytes, rng: Stream) -> bytes:
    """Cut short, sometimes to nothing."""
    return data[: int(rng.integers(0, len(data) + 1))]


def number(data: bytes, rng: Stream) -> bytes:
    """One number replaced by an odd value."""
    found = list(NUMBER.finditer(data))
    if not found:
        return data
    place = found[int(rng.integers(len(found)))]
    return data[: place.start()] + ODD_VALUES[int(rng.integers(len(ODD_VALUES)))] + data[place.end() :]


def nudge(data: bytes, rng: Stream) -> bytes:
    """One number scaled or turned in sign: still a number, perhaps one that nothing can be computed with."""
    found = list(NUMBER.finditer(data))
    if not found:
        return data
    place = found[int(rng.integers(len(found)))]
    value = float(place.group()) * FACTORS[int(rng.integers(len(FACTORS)))]
    return data[: place.start()] + f"{value:g}".encode() + data[place.end() :]


def digit(data: bytes, rng: Stream) -> bytes:
    """One digit replaced by another: nothing moves, not even in a binary file that holds text."""
    found = list(DIGIT.finditer(data))
    if not found:
        return data
    place = found[int(rng.integers(len(found)))].start()
    return data[:place] + str(int(rng.integers(10))).encode() + data[place + 1 :]


def single(data: bytes, rng: Stream) -> bytes:
    """One four-byte float replaced by an odd one, as if all floats stood at the end of the file."""
    if len(data) < 4:
        return data
    place = len(data) - 4 * int(rng.integers(1, len(data) // 4 + 1))
    return data[:place] + struct.pack("<f", ODD_FLOATS[int(rng.integers(len(ODD_FLOATS)))]) + data[place + 4 :]


def point(data: bytes, rng: Stream) -> bytes:
    """One vertex of a binary STL moved wherever it occurs, by an odd float or a factor: the surface stays closed."""
    facets = (len(data) - STL_HEAD) // STL_FACET
    if facets < 1:
        return data
    place = STL_HEAD + STL_FACET * int(rng.integers(facets)) + 12 * int(rng.integers(1, 4))
    old = data[place : place + 12]
    values = list(struct.unpack("<3f", old))
    axis = int(rng.integers(3))
    factor = FACTORS[int(rng.integers(len(FACTORS)))]
    scaled = float(np.clip(values[axis] * factor, -3e38, 3e38))
    values[axis] = scaled if rng.integers(4) else ODD_FLOATS[int(rng.integers(len(ODD_FLOATS)))]
    return data.replace(old, struct.pack("<3f", *values))


def insert(data: bytes, rng: Stream) -> bytes:
    """Odd text put somewhere."""
    place = int(rng.integers(0, len(data) + 1))
    return data[:place] + ODD_TEXT[int(rng.integers(len(ODD_TEXT)))] + data[place:]


def lines(data: bytes, rng: Stream) -> bytes:
    """A line dropped, doubled or moved."""
    rows = data.split(b"\n")
    i, j = (int(value) for value in rng.integers(0, len(rows), 2))
    row = rows.pop(i)
    choice = int(rng.integers(3))
    if choice > 0:
        rows.insert(j, row)
    if choice == 2:
        rows.insert(j, row)
    return b"\n".join(rows)


def words(data: bytes, rng: Stream) -> bytes:
    """A word replaced by another of the file."""
    found = list(re.finditer(rb"\w+", data))
    if len(found) < 2:
        return data
    a, b = (found[int(value)] for value in rng.integers(0, len(found), 2))
    return data[: a.start()] + b.group() + data[a.end() :]


def recode(data: bytes, rng: Stream) -> bytes:
    """Another encoding or other line ends."""
    text = data.decode("utf-8", "replace")
    ways: tuple[bytes, ...] = (
        text.encode("utf-16"), text.encode("latin-1", "replace"), data.replace(b"\n", b"\r\n"),
        data.replace(b".", b","), data.replace(b",", b";"), data.replace(b"\n", b"\r"),
    )  # fmt: skip
    return ways[int(rng.integers(len(ways)))]


TEXT: Final[tuple[Mutation, ...]] = (
    nudge, nudge, nudge, digit, digit, digit, number, number, number, words, words, lines, lines, insert, flip, truncate,
    recode,
)  # fmt: skip
STL_HEAD: Final = 84
STL_FACET: Final = 50
"""Bytes of a binary STL before its facets, and of one: a normal, three vertices, two bytes."""
BINARY: Final[tuple[Mutation, ...]] = (flip, flip, digit, digit, single, single, truncate, insert)

STL: Final[tuple[Mutation, ...]] = (*BINARY, point, point, point)
TRIES: Final = 20
"""Draws after which a file that nothing changes is given up: an empty one."""


def mutated(data: bytes, seed: int, ways: tuple[Mutation, ...]) -> bytes:
    """One to three mutations of a file, mostly one (what is refused hides what else is wrong); the same for the same seed."""
    rng = np.random.default_rng(seed)
    changed = data
    for _ in range(TRIES):
        for _ in range(int(rng.choice((1, 1, 1, 2, 3)))):
            changed = ways[int(rng.integers(len(ways)))](changed, rng)
        if changed != data:
            break
    return changed
