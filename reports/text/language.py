"""The strings of the conservator's page in one language, from one file each (`languages/`), and numbers as it writes them."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

from harness.model.errors import InputError, Mistake
from reports.text import numbers

FOLDER: Final = Path(__file__).with_name("languages")
LANGUAGES: Final = tuple(sorted(file.stem for file in FOLDER.glob("*.toml")))


@dataclass(frozen=True, eq=False)
class Language:
    """A language by its code (`en`), with its strings by `table.key`."""

    code: str
    strings: Mapping[str, str]

    def __call__(self, key: str, /, **values: object) -> str:
        """The string of a key, its braces filled. Raises `KeyError` for an unknown key."""
        return self.strings[key].format(**values)

    def _written(self, text: str) -> str:
        return text.replace(".", self.strings["decimal"])

    def length(self, value_m: float) -> str:
        """A length, as `numbers.length`."""
        return self._written(numbers.length(value_m))

    def digits(self, value: float, count: int = 3) -> str:
        """A number, as `numbers.digits`."""
        return self._written(numbers.digits(value, count))

    def short(self, value: float, count: int = 4) -> str:
        """A number, as `numbers.short`."""
        return self._written(numbers.short(value, count))

    def percent(self, share: float, count: int = 2) -> str:
        """A share, as `numbers.percent`."""
        return self._written(numbers.percent(share, count))

    def count(self, count: int) -> str:
        """A small count as a word."""
        words = self.strings["numbers"].split()
        return words[count] if count < len(words) else str(count)

    def key(self, key: str) -> str | None:
        """A dotted key of a scene in words: with its table where that has words of its own, else alone; None without words."""
        *table, last = key.split(".")
        known = (f"key.{name}" for name in ("_".join([*table[-1:], last]), last))
        return self.strings.get(next((name for name in known if name in self.strings), ""))

    def listed(self, items: Iterable[str]) -> str:
        """`a`, `a and b`, `a, b and c`."""
        names = list(items)
        return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {self.strings['and']} {names[-1]}"


@cache
def language(code: str) -> Language:
    """The language of a code. Raises `InputError` for one without a file."""
    if code not in LANGUAGES:
        raise InputError(Mistake("--language", "", f"one of {', '.join(LANGUAGES)}", repr(code)))
    with (FOLDER / f"{code}.toml").open("rb") as file:
        return Language(code, dict(_flat(tomllib.load(file))))


def _flat(table: Mapping[str, str | Mapping[str, str]]) -> Iterable[tuple[str, str]]:
    for key, value in table.items():
        if isinstance(value, str):
            yield key, value
        else:
            yield from ((f"{key}.{name}", text) for name, text in value.items())


ENGLISH: Final = language("en")
