"""The colour of every verdict on pages, from a probability of falling or from outcomes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, Literal

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


def tone_of_study(families: Iterable[str]) -> Tone:
    """The colour of a study's outcomes: without a probability of a fall never green, however many situations are stood."""
    tone = tone_of_outcomes(families)
    return "differ" if tone == "agree" else tone


def tone_of_probability(item: Assessment) -> Tone:
    """The colour of a probability: `agree` only where a fall is improbable, and its interval says so too."""
    if item.probability_overturned <= SAFE and item.high < SAFE_HIGH:
        return "agree"
    return "failed" if item.probability_overturned >= LIKELY else "differ"


def tone_of_answers(answers: Mapping[str, Assessment]) -> Tone:
    """The worst colour of several models' probabilities; no green where all leave a part of the shaking out."""
    known = any(not item.plane_only for item in answers.values())
    return max([*map(tone_of_probability, answers.values()), "agree" if known else "differ"], key=SEVERITY.index)


def worse_tone(answers: Mapping[str, Assessment], colour: str) -> str:
    """The worse of a run's colour and that of its probabilities: a probability makes no run's green greener."""
    return max([colour, tone_of_answers(answers)], key=SEVERITY.index)
