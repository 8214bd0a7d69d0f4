"""Keys of a scene replaced: `KEY=VALUE` of a command line, or values by key of a program."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike, fspath
from types import MappingProxyType
from typing import Final, cast

from pydantic import JsonValue

from harness.model import InputError, Mistake, refuse, require

# TOML as a user hands it in: no more of it than memory should be given, and no number that TOML does not have.

MOST_KEYS: Final = 10_000
"""Far more than any scene or study has; the tables of a million keys take gigabytes."""
MOST_PARTS: Final = 16
"""Parts of one dotted key, twice the deepest of a scene: what the parser keeps of a key grows with their square."""
MOST: Final = 2**63
"""Whole numbers of TOML have 64 bits."""
_PART: Final = r"""(?:[\w-]+|"[^"\n]*"|'[^'\n]*')"""
_DEEP: Final = re.compile(rf"(?<![\w-]){_PART}(?:[ \t]*\.[ \t]*{_PART}){{{MOST_PARTS}}}")


def content_of(text: str, where: str, key: str = "") -> dict[str, JsonValue]:
    """The content of a TOML text. Raises `TOMLDecodeError` where it is none, `InputError` where it is more than is read.

    `key` is what the whole text belongs to, "" for a file, whose own keys and lines are named.
    """
    if (keys := text.count("=")) > MOST_KEYS:
        raise InputError(Mistake(where, key, f"TOML of at most {MOST_KEYS} keys", str(keys)))
    if deep := _DEEP.search(text):
        place = key or f"line {text.count(chr(10), 0, deep.start()) + 1}"
        raise InputError(Mistake(where, place, f"keys of at most {MOST_PARTS} parts", f"{deep.group()[:40]}..."))
    try:
        content: dict[str, JsonValue] = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError as error:
        raise InputError(Mistake(where, key, "valid TOML", "values nested too deeply to read")) from error
    except ValueError as error:  # Python's, of a number with thousands of digits
        raise InputError(Mistake(where, key, "whole numbers of 64 bits", "one of thousands of digits")) from error
    inside: list[tuple[str, JsonValue]] = [("", content)]
    while inside:
        name, value = inside.pop()
        if isinstance(value, dict):
            inside += [(f"{name}.{part}" if name else part, item) for part, item in value.items()]
        elif isinstance(value, list):
            inside += [(name, item) for item in value]
        elif isinstance(value, int) and not -MOST <= value < MOST:
            raise InputError(Mistake(where, key or name, "whole numbers of 64 bits", f"one of {value.bit_length()}"))
    return content


Overrides = Sequence[str] | Mapping[str, object]
"""`KEY=VALUE` texts with a dotted key and a TOML value, or values by dotted key; `none` or None removes the key."""
Replacement = str | tuple[str, str, object]
"""A `KEY=VALUE` text of a command line; or what a program named it by, the dotted key and the value."""
OPTION: Final = "--set"
DOT: Final = "__"
"""Stands for a dot where a key is a Python keyword argument: `motion__x__amplitude_g`. No key of a scene holds it."""


def plain(value: object) -> object:
    """A program's value as a scene file holds it: numbers and arrays of any library, tuples, paths; no key without a value."""
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items() if item is not None}
    if isinstance(value, PathLike):
        return fspath(value)
    if hasattr(value, "tolist"):
        value = value.tolist()
    return [plain(item) for item in value] if isinstance(value, list | tuple) else value


def replacements(overrides: Overrides, keywords: Mapping[str, object] = MappingProxyType({})) -> list[Replacement]:
    """Both ways of a program to replace keys, in one list."""
    given = [overrides] if isinstance(overrides, str) else overrides
    items: list[Replacement] = []
    if isinstance(given, Mapping):
        items += [("overrides", key, plain(value)) for key, value in given.items()]
    else:
        items += given
    return [*items, *((f"keyword {key}", key.replace(DOT, "."), plain(value)) for key, value in keywords.items())]


def override(content: dict[str, JsonValue], items: Iterable[Replacement]) -> dict[tuple[str, ...], str]:
    """Replace keys of a scene's content; returns by their parts what named them. Raises `InputError` with every mistake."""
    mistakes: list[Mistake] = []
    keys: dict[tuple[str, ...], str] = {}
    for item in items:
        try:
            place, key, value = (OPTION, *_parted(item)) if isinstance(item, str) else item
            keys[put(content, place, key, value)] = place
        except InputError as error:
            mistakes += error.mistakes
    refuse(mistakes)
    return keys


def _parted(item: str) -> tuple[str, object]:
    """Key and value of a `KEY=VALUE`; what is no TOML value is a text."""
    key, equals, value = item.partition("=")
    require(equals, OPTION, *_key_wanted(item), key=item)
    try:
        return key, content_of(f"value = {value}", OPTION, key)["value"]
    except tomllib.TOMLDecodeError:
        return key, value.strip()


def _key_wanted(got: str) -> tuple[str, str]:
    return "KEY=VALUE with a dotted key, such as motion.x.amplitude_g=0.3", repr(got)


def put(content: dict[str, JsonValue], place: str, key: str, value: object) -> tuple[str, ...]:
    """Set one dotted key of a scene's content, or remove it (None, "none"); returns its parts.

    `place` is what names it. Raises `InputError` where the path is no table.
    """
    parts = tuple(part.strip() for part in key.split("."))
    require(all(parts), place, *_key_wanted(key), key=key)
    table = content
    for part in parts[:-1]:
        inner = table.setdefault(part, {})
        if not isinstance(inner, dict):
            raise InputError(Mistake(place, key, f"a key inside a table, but {part} is a value", repr(key)))
        table = inner
    if value is None or value == "none":
        table.pop(parts[-1], None)
    else:
        table[parts[-1]] = cast(JsonValue, value)
    return parts
