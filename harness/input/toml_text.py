"""TOML as a user hands it in: no more of it than memory should be given, and no number that TOML does not have."""

from __future__ import annotations

import re
import tomllib
from typing import Final

from pydantic import JsonValue

from harness.model.errors import InputError, Mistake

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
