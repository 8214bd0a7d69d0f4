"""Every sentence, in one file for each language, and numbers as people read them in it: units always, three digits, no false
zeros.

A finding's sentence stands under `finding.CODE`: a text, or a table of texts of which the value named by its `by` chooses one.
`{until_s:s}` is a value in a format of `FORMATS`; what stands in square brackets is left out where one of its values is empty.
`{cases|case|cases}` is the first word where the value is 1, else the second.
"""

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any, Final

from harness.model import Finding, check_known, printable

FOLDER: Final = Path(__file__).parent
LANGUAGES: Final = tuple(sorted(file.stem for file in FOLDER.glob("*.toml")))
OPTIONAL: Final = re.compile(r"\[([^\[\]]*)\]")
"""A part of a sentence that may be left out: no user's text is searched, only the catalogue's own."""
FIELD: Final = re.compile(r"\{(\w+)(?::(\w+))?\}")
_PART: Final = r"(?:[^{}|]|\{[^{}]*\})*"
COUNTED: Final = re.compile(rf"\{{(\w+)\|({_PART})\|({_PART})\}}")
"""Words that follow a count."""
SOON_S: Final = 1e-6
"""A sooner instant is the beginning: its digits are rounding's."""
PLACE: Final = re.compile(rf"(?:\b(\w+) )?{FIELD.pattern}")
"""A value's place with the word before it, of the catalogue too: an article that follows the number."""

ROUNDING: Final = 1e-15
"""Rounding of numbers near one: a size below it is none."""
SMALLEST_SHARE: Final = 5e-7
"""A smaller share is told as none: its digits are rounding's."""
RAISED: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
UNITS = {
    "m_s2": "m/s²",
    "m_s": "m/s",
    "rad_s": "rad/s",
    "kg_m2": "kg m²",
    "kg_m3": "kg/m³",
    "rad": "rad",
    "kg": "kg",
    "hz": "Hz",
    "deg": "°",
    "s": "s",
    "m": "m",
    "g": "g",
    "j": "J",
    "n": "N",
}


@dataclass(frozen=True, eq=False)
class Language:
    """A language by its code (`en`)."""

    code: str

    @cached_property
    def strings(self) -> Mapping[str, str]:
        """Its strings by `table.key`, read when the first is said."""
        import tomllib

        return dict(_flat(tomllib.loads((FOLDER / f"{self.code}.toml").read_text(encoding="utf-8"))))

    def __call__(self, key: str, /, **values: object) -> str:
        """The string of a key, its braces filled. Raises `KeyError` for an unknown key."""
        return PLACE.sub(lambda place: self._after(place[1], str(values[place[2]])), agreed(self.strings[key], values))

    def say(self, finding: Finding) -> str:
        """The sentence of a finding. Raises `KeyError` for an unknown code."""
        key, values = f"finding.{finding.code}", finding.values
        by = self.strings.get(f"{key}.by")
        template = agreed(self.strings[key if by is None else f"{key}.{values[by]}"], values)
        filled = OPTIONAL.sub(lambda part: part[1] if self._full(part[1], values) else "", template)
        text = PLACE.sub(
            lambda place: self._after(place[1], self.value(values.get(place[2]), place[3] or "plain")), filled
        )
        return f"{text} ({self.word('runs')}: {values['in_runs']})" if "in_runs" in values else text

    def _after(self, word: str | None, value: str) -> str:
        """A value after the word before it, in the form that an article has before its number: `nell'8 %`, `dello 0,3 %`."""
        if word is None:
            return value
        vowel, nought = self._articles.get(word, (word, word))
        whole = re.match(r"\d*", value)[0]  # type: ignore[index]
        article = vowel if whole[:1] == "8" or whole in ("1", "11") else nought if whole == "0" else word
        return article + ("" if article.endswith("'") else " ") + value

    @cached_property
    def _articles(self) -> dict[str, tuple[str, str]]:
        """An article's forms before a number that begins with a vowel, and before nought."""
        forms = (each.split() for each in self.strings["articles"].split(",") if each)
        return {word: (vowel, nought) for word, vowel, nought in forms}

    def _full(self, part: str, values: Mapping[str, Any]) -> bool:
        """Whether every value of a part is there; nought, False and what is not finite are none."""
        named = [values.get(place[1]) for place in FIELD.finditer(part)]
        return all(bool(value) and value != math.inf for value in named)

    def value(self, value: Any, form: str) -> str:
        """A value in one of `FORMATS`; an en dash where there is none."""
        if value is None or (isinstance(value, float) and not math.isfinite(value)):
            return "–"
        return FORMATS[form](self, value)

    def range(self, ends: Sequence[str]) -> str:
        """`4.1 to 5.2`, of texts in order; one of them where all are alike."""
        return ends[0] if ends[0] == ends[-1] else f"{ends[0]} {self.word('to')} {ends[-1]}"

    def word(self, name: str) -> str:
        """A name of the program (an outcome, a cause) in words; itself where it has none: an engine's name, a file's."""
        return self.strings.get(f"word.{name}", printable(name))

    def written(self, text: str) -> str:
        """The text of a number as this language writes it."""
        return text.replace(".", self.strings["decimal"])

    def digits(self, value: float | None, count: int = 3) -> str:
        """A number to `count` significant digits, in plain form between 0.001 and 100 000; an en dash for None."""
        if value is None or not math.isfinite(value):
            return "–"
        size = abs(value)
        if size < ROUNDING:
            return "0"
        if size < 1e-3 or size >= 1e5:
            mantissa, exponent = f"{value:.{count - 1}e}".split("e")
            mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
            return self.written(f"{mantissa}·10{str(int(exponent)).translate(RAISED)}".replace("-", "−"))
        places = max(0, count - 1 - int(f"{size:e}".partition("e")[2]))
        return self.written(f"{value:.{places}f}".replace("-", "−"))

    def short(self, value: float, count: int = 4) -> str:
        """A number as given: no zeros at its end."""
        text, point = self.digits(value, count), self.strings["decimal"]
        return text.rstrip("0").rstrip(point) if point in text and "·" not in text else text

    def unit(self, value: float | None, name: str, count: int = 3) -> str:
        """A number with its unit, a no-break space between."""
        return self.digits(value, count) if value is None else f"{self.digits(value, count)}\u00a0{name}"

    def given(self, value: float, name: str) -> str:
        """A given number, as short as it was given, with its unit."""
        return f"{self.short(value)}\u00a0{name}"

    def length(self, value_m: float, count: int = 3) -> str:
        """A length in the unit in which a person would say it: m, cm or mm."""
        size = abs(value_m)
        if size < 5e-7:
            return "0\u00a0mm"
        value, name = (value_m, "m") if size >= 1.0 else (100.0 * value_m, "cm")
        if size < 0.01:
            value, name = 1000.0 * value_m, "mm"
        return f"{self.short(value, count - (size < 0.1))}\u00a0{name}"

    def percent(self, share: float, count: int = 2) -> str:
        """A push as a share of the statue's weight."""
        return f"{self.short(100.0 * share if abs(share) >= SMALLEST_SHARE else 0.0, count)} %"

    def label(self, key: str) -> str:
        """What a value of a record is called, and its unit (`motion.x.amplitude_g` → `amplitude [g]`)."""
        words, unit = self.named(key)
        return f"{words} [{unit}]" if unit else words

    def named(self, key: str) -> tuple[str, str]:
        """What a value is called, and its unit, apart: of a scene's dotted key its last part, with its table where both have a
        name of their own."""
        words, unit = split_unit(key.rpartition(".")[2])
        return self.key(key, "label") or words, unit

    def plain(self, value: Any, count: int = 4) -> str:
        """Any value of a record in one table cell, its numbers with `count` digits."""
        if isinstance(value, bool | str):
            return self.word(str(value))
        if isinstance(value, list | tuple):
            return self.row([self.plain(each, count) for each in value[:12]], len(value))
        if isinstance(value, Mapping):
            return as_filed(value)
        return (
            self.digits(value, count)
            if value is None or isinstance(value, float)
            else self.written(str(value).replace("-", "−"))
        )

    def row(self, texts: Sequence[str], size: int = 0) -> str:
        """Values one after another, parted by what none of them holds; of `size` in all the first alone."""
        between = "; " if any("," in text for text in texts) else ", "
        return (between.join(texts) or "–") + (f"{between}… ({size})" if size > len(texts) else "")

    def count(self, count: int) -> str:
        """A small count as a word."""
        words = self.strings["numbers"].split()
        return words[count] if count < len(words) else str(count)

    def key(self, key: str, among: str = "key") -> str | None:
        """A dotted key of a scene in words: with its table where that has words of its own, else alone; None without words."""
        *table, last = key.split(".")
        whole = "_".join([*table[-1:], last])
        return self.strings.get(f"{among}.{whole}", self.strings.get(f"{among}.{last}"))

    def listed(self, items: Iterable[str]) -> str:
        """`a`, `a and b`, `a, b and c`."""
        names = list(items)
        return "".join(names) if len(names) < 2 else f"{', '.join(names[:-1])} {self.strings['and']} {names[-1]}"


def split_unit(key: str) -> tuple[str, str]:
    """A record's key as words and unit: `peak_theta_rad` → (`peak theta`, `rad`)."""
    for ending, name in UNITS.items():
        if key.lower().endswith(f"_{ending}"):
            return key[: -len(ending) - 1].replace("_", " "), name
    return key.replace("_", " "), ""


def as_filed(table: Mapping[str, Any]) -> str:
    """A table of a scene, as its file has it."""
    named = ((*split_unit(key), value) for key, value in table.items())
    return ", ".join(
        f"{words} {ENGLISH.given(value, unit) if unit and isinstance(value, float) else ENGLISH.plain(value)}"
        for words, unit, value in named
    )


def agreed(template: str, values: Mapping[str, object]) -> str:
    """A string with its words as its counts have them."""
    return COUNTED.sub(lambda part: part[2] if str(values.get(part[1])) == "1" else part[3], template)


def _angles(say: Language, values_rad: Sequence[float]) -> str:
    degrees = say.range([say.digits(math.degrees(value), 3) for value in values_rad])
    return f"{degrees}° ({say.range([say.digits(value, 3) for value in values_rad])}\u00a0rad)"


def _shares(say: Language, shares: Mapping[str, float]) -> str:
    return say.listed(f"{say.percent(share)} {say.word('without')} {say.word(what)}" for what, share in shares.items())


def _factors(say: Language, factors: Mapping[str, Sequence[float | None]]) -> str:
    """`5 % at 1.10 (1.02 to 1.20)`: the factor at which each share is reached, what draws leave open, `≤` the weakest tried."""

    def factor(at: float | None, weakest: float | None) -> str:
        return "–" if at is None else f"≤ {say.digits(at, 3)}" if at == weakest else say.digits(at, 3)

    def each(
        share: str, soonest: float | None, at: float | None, latest: float | None, weakest: float | None = None
    ) -> str:
        between = f" ({factor(soonest, weakest)} {say.word('to')} {factor(latest, weakest)})"
        return f"{say.value(float(share), 'share')} {say.word('at')} {factor(at, weakest)}{'' if soonest == latest else between}"

    return say.listed(each(share, *at) for share, at in factors.items())


def _points(say: Language, share: float) -> str:
    text = f"{100.0 * share:+.1f}"
    return ("0.0" if float(text) == 0.0 else text).replace("-", "−").replace(".", say.strings["decimal"])


def _named_key(say: Language, key: str) -> str:
    words = say.key(key)
    return printable(key) if words is None else f"{words} ({key})"


def _settings(say: Language, values: Mapping[str, float]) -> str:
    """`mass 250 kg and width 0.9 m`, of dotted keys of a scene."""
    named = ((*say.named(key), say.short(value)) for key, value in values.items())
    return say.listed(f"{words} {value}" + (f"\u00a0{unit}" if unit else "") for words, unit, value in named)


def _change(say: Language, share: float) -> str:
    return say.written(f"{round(100.0 * share, 2) + 0.0:+g}\u00a0%")


FORMATS: Final[Mapping[str, Callable[[Language, Any], str]]] = {
    "plain": lambda say, value: say.word(str(value)) if isinstance(value, bool | str) else say.short(float(value)),
    "count": lambda say, value: str(value),
    "given": lambda say, value: f"{value:g}",
    "number": lambda say, value: say.digits(float(value), 2),
    "s": lambda say, value: f"{say.digits(value if abs(value) >= SOON_S else 0.0, 3)}\u00a0s",
    "rad": lambda say, value: f"{say.digits(value, 2)}\u00a0rad",
    "angle": lambda say, value: f"{say.digits(math.degrees(value), 3)}° ({say.digits(value, 3)}\u00a0rad)",
    "angles": _angles,
    "m": lambda say, value: say.length(value),
    "lengths": lambda say, value: say.range([say.length(each) for each in value]),
    "g": lambda say, value: f"{say.digits(value, 3)}\u00a0g",
    "j": lambda say, value: f"{say.digits(value, 3)}\u00a0J",
    "share": lambda say, value: f"{probability_text(value)}\u00a0%".replace(".", say.strings["decimal"]),
    "names": lambda say, value: say.listed(map(say.word, value)),
    "directions": lambda say, value: say.listed(f"{say.short(each)}°" for each in value),
    "vector": lambda say, value: say.row([say.short(part, 3) for part in value]),
    "groups": lambda say, value: "; ".join(f"{say.word(end)} ({say.listed(names)})" for end, names in value.items()),
    "choices": lambda say, value: "; ".join(f"{say.word(name)}: {say.word(end)}" for name, end in value.items()),
    "without": _shares,
    "change": _change,
    "adjusted": lambda say, shares: say.listed(
        f"{say.word(what)} {_change(say, each)}" for what, each in shares.items()
    ),
    "factors": _factors,
    "counts": lambda say, value: say.listed(
        f"{say.word(name)}: {say.short(float(each))}" for name, each in value.items()
    ),
    "parts": lambda say, value: say.listed(
        f"{say.word(name)}: {n} {say.word('of')} {of}" for name, (n, of) in value.items()
    ),
    "interval": lambda say, value: f"{say.digits(value[0])} ({say.range([*map(say.digits, value[1:])])})",
    "changes": lambda say, value: say.listed(
        f"{say.word(key)} {say.range([_points(say, end) for end in ends])}" for key, ends in value.items()
    ),
    "key": _named_key,
    "classes": lambda say, value: "; ".join(f"{say.percent(share)} {say.word(kind)}" for kind, share in value.items()),
    "hz": lambda say, value: f"{say.digits(value, 3)}\u00a0Hz",
    "points": _points,
    "of_points": lambda say, share: _points(say, abs(share)).removeprefix("+"),
    "pairs": lambda say, value: say.listed(f"{say.word(name)}: {say.word(each)}" for name, each in value.items()),
    "rate": lambda say, value: "{:.0f}\u00a0% ({:.0f}–{:.0f}\u00a0%)".format(*(100.0 * each for each in value)),
    "settings": _settings,
    "side": lambda say, value: say(f"side.{value}"),
    "speeds": lambda say, value: f"{say.range([*map(say.digits, value)])}\u00a0m/s",
}
"""How a value is written, by the word after its colon."""


def probability_text(share: float) -> str:
    """A share in per cent: two digits where it is small, a tenth of one where it is large: no 100 for 99.97."""
    value = 100.0 * share
    if 90.0 < value < 100.0:
        return f"{min(value, 99.9):.1f}".removesuffix(".0")
    return f"{value:.0f}" if value >= 9.95 or value == 0.0 else f"{value:.2g}"


@cache
def language(code: str) -> Language:
    """The language of a code. Raises `InputError` for one without a file."""
    check_known(code, LANGUAGES, "--language")
    return Language(code)


def _flat(table: Mapping[str, Any], above: str = "") -> Iterable[tuple[str, str]]:
    for key, value in table.items():
        if isinstance(value, str):
            yield f"{above}{key}", value
        else:
            yield from _flat(value, f"{above}{key}.")


ENGLISH: Final = language("en")
