"""Small, reproducible damage to a file: what editors, networks, spreadsheets and hands do to it."""

import gzip
import re
import struct
import zlib
from collections.abc import Callable
from functools import lru_cache
from typing import Final

import numpy as np

Stream = np.random.Generator
Mutation = Callable[[bytes, Stream], bytes]

NUMBER: Final = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
FRACTION: Final = re.compile(rb"[-+]?\d+\.\d+(?:[eE][-+]?\d+)?")
DIGIT: Final = re.compile(rb"\d")
WORD: Final = re.compile(rb"\w+")
FACTORS: Final = (-1.0, 0.0, 0.5, 2.0, 10.0, 1e-3, 1e3, 1e-12, 1e12, 1e150, 1e-150)
ODD_FLOATS: Final = (0.0, -1.0, 1e-30, 1e30, float("nan"), float("inf"), 0.5, 2.0)
ODD_VALUES: Final = (
    b"nan", b"inf", b"-inf", b"1e999", b"-1", b"0", b"1e-300", b"1e300", b"1e18", b"", b"x", b'"3"', b"3,5", b"0x10",
    b"true", b"[]", b"{}", b"9999999999999999999999", b"-0.0", b"1_000",
)  # fmt: skip
ODD_TEXT: Final = (
    b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", "é θ 😀".encode(), b"\r", b"\t", b'"', b"'''", b"#", b"[[", b"=", b",,,", b"\x1a",
)  # fmt: skip


@lru_cache(maxsize=4)
def spans(pattern: re.Pattern[bytes], data: bytes) -> list[tuple[int, int]]:
    """Where a pattern is in a file, which is mutated a thousand times over."""
    return [place.span() for place in pattern.finditer(data)]


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
    found = spans(NUMBER, data)
    if not found:
        return data
    begin, end = found[int(rng.integers(len(found)))]
    return data[:begin] + ODD_VALUES[int(rng.integers(len(ODD_VALUES)))] + data[end:]


def nudge(data: bytes, rng: Stream) -> bytes:
    """One number scaled or turned in sign: still a number, perhaps one that nothing can be computed with."""
    found = spans(NUMBER, data)
    if not found:
        return data
    begin, end = found[int(rng.integers(len(found)))]
    value = float(data[begin:end]) * FACTORS[int(rng.integers(len(FACTORS)))]
    return data[:begin] + f"{value:g}".encode() + data[end:]


def digit(data: bytes, rng: Stream) -> bytes:
    """One digit replaced by another: nothing moves, not even in a binary file that holds text."""
    found = spans(DIGIT, data)
    if not found:
        return data
    place, _ = found[int(rng.integers(len(found)))]
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
    likely = rng.integers(3) > 0
    factor = 2.0 ** float(rng.uniform(-1.0, 1.0)) if likely else FACTORS[int(rng.integers(len(FACTORS)))]
    scaled = float(np.clip(values[axis] * factor, -3e38, 3e38))
    values[axis] = scaled if likely or rng.integers(4) else ODD_FLOATS[int(rng.integers(len(ODD_FLOATS)))]
    return data.replace(old, struct.pack("<3f", *values))


def vary(data: bytes, rng: Stream) -> bytes:
    """One to four numbers with decimals halved to doubled, as wide as they were where blanks leave room: still a likely file."""
    found = spans(FRACTION, data)
    for place in sorted(
        {int(rng.integers(len(found))) for _ in range(int(rng.integers(1, 5)))} if found else (), reverse=True
    ):
        begin, end = found[place]
        old = data[begin:end]
        value = float(old) * 2.0 ** float(rng.uniform(-1.0, 1.0))
        decimals = len(re.split(rb"[eE]", old)[0].partition(b".")[2])
        new = f"{value:.{decimals}{'e' if old.lower().count(b'e') else 'f'}}".encode().rjust(end - begin)
        while len(new) > end - begin and data[begin - 1 : begin] == b" ":
            begin -= 1
        data = data[:begin] + new + data[end:]
    return data


def dress(data: bytes, rng: Stream) -> bytes:
    """Other line ends, blanks or blank lines, a comment, a mark before the first letter: what editors do, and readers bear."""
    rows = data.split(b"\n")
    place = int(rng.integers(len(rows)))
    ways: tuple[bytes, ...] = (
        data.replace(b"\n", b"\r\n"), b"\xef\xbb\xbf" + data, data + b"\n", data.rstrip(b"\n"), b"# a comment\n" + data,
        b"\n".join([*rows[:place], rows[place] + b"   ", *rows[place + 1 :]]),
        b"\n".join([*rows[:place], b"", *rows[place:]]),
    )  # fmt: skip
    return ways[int(rng.integers(len(ways)))]


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
    found = spans(WORD, data)
    if len(found) < 2:
        return data
    a, b = (found[int(value)] for value in rng.integers(0, len(found), 2))
    return data[: a[0]] + data[b[0] : b[1]] + data[a[1] :]


def recode(data: bytes, rng: Stream) -> bytes:
    """Another encoding or other line ends."""
    text = data.decode("utf-8", "replace")
    ways: tuple[bytes, ...] = (
        text.encode("utf-16"), text.encode("latin-1", "replace"), data.replace(b"\n", b"\r\n"),
        data.replace(b".", b","), data.replace(b",", b";"), data.replace(b"\n", b"\r"),
    )  # fmt: skip
    return ways[int(rng.integers(len(ways)))]


STEPS: Final = (
    b"1.E-02", b"1e-2", b"1d-2", b"1D-02", b".01", b"0.01", b"1.0-002", b"+.02", b"1_0", b"0x1", b"nan", b"inf", b"1,0", b"0",
    b"-0.01", b"1e-300", b"1e300", b"", b"x", b"0.01 0.02", "١".encode(), b"1.0E-2SEC", b"5.0E-03", b"200", b"1.",
)  # fmt: skip
STEP: Final = re.compile(rb"(?i)(DT\s*=\s*)([^\s,]*)")
TITLES: Final = (
    "x [/] y", "[bold]x", "[/bold]", ":smile:", "a\\nb", "\\u001b[31mred", "\\u009b2J", "\\u202e", "\\ud800", "\\r", "\\t",
    "%s{0}{x}", "../../etc", "=HYPERLINK(1)", "<script>alert(1)</script>", "é θ 😀", "\\u0000", "a" * 5000, " ", "$x$", "\\\\",
)  # fmt: skip
TITLE: Final = re.compile(rb'(?m)^(title = ")(.*)(")$')
MOST_REPACKED: Final = 50_000
"""Bytes of a packed file that is mutated within: a bomb's millions of numbers would cost the mutation gigabytes."""
KINDS: Final = (b'"study"', b'"stress"', b'"bench"', b'"none"', b"1", b"[]", b"null", b'"run "')
LISTED: Final = (
    b'""', b'"."', b'".."', b'"/"', b'"/etc/passwd"', b'"../good.toml"', b'"a/b"', b'"~"', b'"\\u0000"', b'"\\ud800"',
    b'"' + b"a" * 300 + b'"', b'"result.json"', b'".coming.json"', b'"x": [1], "y": {}, "z"', b'"*"',
)  # fmt: skip
BOMB_BYTES: Final = 96 * 2**20
"""Half as much again as a record may have: enough to be refused, and unpacked in a tenth of a second where it is not."""


def step(data: bytes, rng: Stream) -> bytes:
    """The step in a header written in another way, or as no number."""
    return STEP.sub(lambda old: old.group(1) + STEPS[int(rng.integers(len(STEPS)))], data)


def title(data: bytes, rng: Stream) -> bytes:
    """The title replaced or joined by what steers a terminal, a page or a format; sometimes by bytes that are no text."""
    new = TITLES[int(rng.integers(len(TITLES)))].encode()
    new = new if rng.integers(8) else bytes(rng.integers(128, 256, 4, dtype=np.uint8))
    kept = bool(rng.integers(2))
    return TITLE.sub(lambda old: old.group(1) + (old.group(2) if kept else b"") + new + old.group(3), data)


def gathered(data: bytes, rng: Stream) -> bytes:
    """A gzip file of several members, one after the other, or members followed by what is none."""
    return data * int(rng.integers(2, 6)) + (b"", b"", b"tail")[int(rng.integers(3))]


def repacked(data: bytes, rng: Stream) -> bytes:
    """What is in a gzip file mutated as text and packed again; a damaged file as it is."""
    if len(data) > MOST_REPACKED:
        return data
    try:
        text = gzip.decompress(data)
    except (OSError, EOFError, zlib.error):
        return data
    return gzip.compress(TEXT[int(rng.integers(len(TEXT)))](text, rng), 1, mtime=0)


def bomb(data: bytes, rng: Stream) -> bytes:
    """A small file that unpacks to more than may be read: of blanks, of numbers, or after a whole file."""
    fill = (b" ", b"0 1\n", b"\0")[int(rng.integers(3))]
    return (data if rng.integers(2) else b"") + _packed(fill)


@lru_cache(maxsize=3)
def _packed(fill: bytes) -> bytes:
    return gzip.compress(fill * (BOMB_BYTES // len(fill)), 1, mtime=0)


LIKELY: Final[tuple[Mutation, ...]] = (*(vary,) * 9, *(dress,) * 4)
"""What most readers bear: these files get past reading, and what is computed from them is tried."""
TEXT: Final[tuple[Mutation, ...]] = (
    *LIKELY, *LIKELY,
    nudge, nudge, nudge, digit, digit, digit, number, number, number, words, words, lines, lines, insert, flip, truncate,
    recode,
)  # fmt: skip
STL_HEAD: Final = 84
STL_FACET: Final = 50
"""Bytes of a binary STL before its facets, and of one: a normal, three vertices, two bytes."""
BINARY: Final[tuple[Mutation, ...]] = (flip, flip, digit, digit, single, single, truncate, insert)

STL: Final[tuple[Mutation, ...]] = (*BINARY, *(point,) * 12)


def listed(data: bytes, rng: Stream) -> bytes:
    """A result's record that claims another kind, or lists among its files what is no file of its folder."""
    if rng.integers(2):
        return data.replace(b'"kind": "run"', b'"kind": ' + KINDS[int(rng.integers(len(KINDS)))], 1)
    return data.replace(b'"files": {', b'"files": {' + LISTED[int(rng.integers(len(LISTED)))] + b": null, ", 1)


STEPPED: Final[tuple[Mutation, ...]] = (step, step, step, step, nudge, lines, recode, insert)
TITLED: Final[tuple[Mutation, ...]] = (title, title, title, title, insert, recode, words)
RECORD: Final[tuple[Mutation, ...]] = (*TEXT, listed, listed, listed, listed, listed, listed)
PACKED: Final[tuple[Mutation, ...]] = (*(repacked,) * 12, gathered, flip, truncate, bomb)
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
