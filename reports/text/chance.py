"""The colour of every verdict on pages, from a probability of falling or from outcomes; a run's headline with its probability."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, Literal

from harness.assess.words import sentence
from harness.records.assess import Assessment

SAFE: Final = 0.05
"""Green only where the probability of falling is at most this, and"""
SAFE_HIGH: Final = 0.10
"""its interval stays below this."""
LIKELY: Final = 0.5
"""From here on a fall is the likelier end."""
Tone = Literal["agree", "differ", "failed"]
SEVERITY: Final[tuple[str, ...]] = ("agree", "differ", "failed")


def tone_of_outcomes(families: Iterable[str]) -> Tone:
    """The colour of outcomes by their families (`study_rows.family`): `agree` only where every answer is that it stands."""
    ends = set(families)
    return "agree" if ends == {"stands"} else "differ" if ends & {"stands", "wall"} else "failed"


def tone_of_probability(item: Assessment) -> Tone:
    """The colour of a probability: `agree` only where a fall is improbable, and its interval says so too."""
    if item.probability_overturned <= SAFE and item.high < SAFE_HIGH:
        return "agree"
    return "failed" if item.probability_overturned >= LIKELY else "differ"


def first_line(answers: Mapping[str, Assessment] | None, headline: str, colour: str) -> tuple[str, str]:
    """A run's headline and colour with the probability before them, where the record has one.

    The worse of both colours: a probability makes no run's green greener.
    """
    if not answers:
        return headline, colour
    item = max(answers.values(), key=lambda each: each.high)
    nominal = headline[0].lower() + headline[1:]
    worse = max(colour, tone_of_probability(item), key=SEVERITY.index)
    return f"The statue {sentence(item)}. As given, once: {nominal}", worse
