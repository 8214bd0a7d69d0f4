"""The conservator's page speaks each language from one file, wholly, in short sentences, and explains what it names."""

import re
from collections.abc import Callable, Iterator, Mapping
from html import unescape
from pathlib import Path
from string import Formatter

import pytest

from harness.model import InputError
from harness.records.base import Record
from reports import messages as languages
from reports.messages import ENGLISH, LANGUAGES, Language, agreed, language
from reports.pages.page import _conservator
from tests.budgets_reports import GULPEASE, SENTENCE_WORDS_MEAN, SENTENCE_WORDS_MOST

BARE = ("decimal", "numbers", "articles", "and")
"""Strings that are put together with others."""
FINDINGS = (
    "finding",
    "word",
    "short",
    "pair",
    "wrote",
    "kind",
    "severity",
    "section",
    "table",
    "tool",
    "label",
    "meaning",
    "text",
    "assumed",
    "published",
)
"""Tables of findings, outcomes and verdicts, and of the engineer's page."""
SHARED = {"order.case", "study.more", "chart.arias", "chart.peak", "chart.setting"}
"""Strings that hold nothing but signs around braces."""
JARGON = {
    "en": (
        "rad", "radian", "kHz", "μ", "horizon", "integrat", "slenderness", "restitution", "theta", "θ", "centroid", "inertia",
        "amplitude", "frequency", "numerical", "analytic", "pymunk", "pybullet", "spatial", "contact engine", "Housner",
        "coefficient", "probability", "simulation", "solver", "PGA", "quantile",
    ),
    "it": (
        "rad", "radiant", "orizzonte", "integra", "snellezza", "restituzione", "theta", "θ", "inerzia", "ampiezza", "frequenza",
        "numeric", "analytic", "pymunk", "pybullet", "spatial", "coefficient", "probabilità", "simulazion", "PGA",
        "quantil",
    ),
}  # fmt: skip
"""Terms of the field that no conservator's page may use."""
EXPLAINED = {
    "en": {
        "friction": "how hard it is to make one thing slide on another",
        "possible case": "drawn many times by chance",
        "centre of gravity": "the point at which the statue would balance",
    },
    "it": {
        "attrito": "quanto è difficile far scorrere una cosa su un'altra",
        "casi possibili": "estratto a sorte molte volte",
        "baricentro": "il punto in cui la statua starebbe in equilibrio",
    },
}
"""Terms that a page may use where it says what they mean."""
KINDS = ("apart", "meshed", "bare", "table", "map", "rose", "effects")
"""Records with a conservator's page."""


@pytest.fixture(scope="module")
def records(written: Callable[[str], Path], record_of: Callable[[str], Record]) -> dict[Path, Record]:
    return {written(kind): record_of(kind) for kind in KINDS}


def of_page(say: Language) -> dict[str, str]:
    """The strings of the conservator's page: those of findings have tests of their own."""
    return {key: text for key, text in say.strings.items() if key.partition(".")[0] not in FINDINGS}


def braces(text: str) -> set[str]:
    return {name for _, name, _, _ in Formatter().parse(agreed(text, {})) if name is not None}


def page(folder: Path, record: Record, say: Language) -> str:
    """The conservator's page; `write_report` writes it, which takes the engineer's with it."""
    return _conservator(folder, record.texted(say.say), say)


def pieces(html: str) -> Iterator[str]:
    """Every piece of text that a page shows or a screen reader reads, its title and its style aside."""
    body = re.sub(r"<(style|title|noscript)\b.*?</\1>", "", html[html.index("<body") :], flags=re.S)
    yield from (unescape(text) for text in re.findall(r'aria-label="([^"]*)"', body))
    yield from (text.strip() for text in unescape(re.sub(r"<[^>]+>", "\n", body)).split("\n") if text.strip())


def with_strings(strings: Mapping[str, str]) -> Language:
    """English with other strings."""
    changed = Language("en")
    vars(changed)["strings"] = strings
    return changed


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_language_has_the_same_strings_with_the_same_braces(code: str) -> None:
    own = of_page(language(code))
    assert own.keys() == of_page(ENGLISH).keys()
    assert {key: braces(text) for key, text in own.items()} == {
        key: braces(text) for key, text in of_page(ENGLISH).items()
    }
    if code != "en":
        same = {key for key, text in own.items() if text == ENGLISH.strings[key]}
        assert same <= SHARED, "a string was left in English"


def test_no_string_of_the_page_stands_outside_the_file(records: dict[Path, Record]) -> None:
    """With marks around every string of the file, nothing but numbers, units and the user's own words is left outside."""
    marked = {key: text if key in BARE or key.endswith(".by") else f"⟦{text}⟧" for key, text in ENGLISH.strings.items()}
    for folder, record in records.items():
        own = {str(record.title), "rockcheck"}
        for text in pieces(page(folder, record, with_strings(marked))):
            left = text
            while (inner := re.sub(r"⟦[^⟦⟧]*⟧", "", left)) != left:
                left = inner
            for word in own:
                left = left.replace(word, "")
            left = re.sub(r"\b(?:cm|mm|m|and|no|one|two|three|four|five|One|Two|Three)\b", "", left)
            assert not re.search(r"[^\W\d_]", left), (folder.name, text)


@pytest.mark.parametrize("code", LANGUAGES)
def test_sentences_are_short_and_terms_explained(records: dict[Path, Record], code: str) -> None:
    for folder, record in records.items():
        name, html = folder.name, page(folder, record, language(code))
        assert f'<html lang="{code}">' in html
        shown = re.findall(r"<(li|p|h2)\b[^>]*>(.*?)</\1>", html[html.index("<main") :], re.S)
        text = [unescape(re.sub(r"<[^>]+>", "", part)).replace("\u00a0", "") for _, part in shown]
        lengths = [len(words) for part in text for each in re.split(r"(?<=[.?!])\s+", part) if (words := each.split())]
        assert max(lengths) <= SENTENCE_WORDS_MOST, (name, max(text, key=len))
        assert sum(lengths) / len(lengths) <= SENTENCE_WORDS_MEAN, name
        whole = " ".join(text)
        assert not re.search(r"\b(?:un modelli|one models|[Oo]ne of one|un[oa]? su un)\b", whole), name
        letters = sum(map(str.isalnum, whole))
        assert 89.0 + (300.0 * len(lengths) - 10.0 * letters) / sum(lengths) >= GULPEASE, name
        assert [word for word in JARGON[code] if re.search(rf"(?<!\w){re.escape(word)}", whole)] == [], name
        for term, words in EXPLAINED[code].items():
            assert words in whole or term not in whole.lower(), (name, term)


def test_the_check_sees_a_long_sentence_and_a_string_outside() -> None:
    assert list(pieces('<body><p>one</p><svg aria-label="two"></svg></body>')) == ["two", "one"]
    long = with_strings({**ENGLISH.strings, "run.put": "word " * (SENTENCE_WORDS_MOST + 1)})
    assert len(long("run.put").split()) > SENTENCE_WORDS_MOST


def test_numbers_are_written_as_the_language_does() -> None:
    italian = language("it")
    assert italian.length(0.0667) == "6,7\u00a0cm"
    assert italian.percent(0.088) == "8,8 %"
    assert italian.listed(["a", "b", "c"]) == "a, b e c"
    assert italian.count(3) == "tre"
    assert ENGLISH.count(12) == "12"


def test_an_unknown_language_is_refused() -> None:
    with pytest.raises(InputError, match="--language"):
        languages.language("xx")


@pytest.mark.parametrize("code", LANGUAGES)
def test_what_a_study_varies_is_said_in_the_pages_own_words(code: str) -> None:
    """Whatever key of a scene it is; a pedestal's mass is not a statue's."""
    say = language(code)
    keys = ("pedestal.mass_kg", "statue.mass_kg", "contact.statue", "motion.x.amplitude_g", "output.dt_s")
    words = [say.key(key) or say("key.other") for key in keys]
    names = ("pedestal_mass_kg", "mass_kg", "contact_statue", "amplitude_g", "other")
    assert words == [say(f"key.{name}") for name in names]
