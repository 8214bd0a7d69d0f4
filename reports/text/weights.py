"""Notes and warnings of a record by their weight: what changes the answer, what should be known, what stands for the record."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Final

CHANGES: Final = "It changes the answer"
KNOWN: Final = "It should be known"
RECORD: Final = "For the record"
_DECIDING: Final = re.compile(
    r"not to be trusted|is not bounded|outside the model's domain|across the rocking plane is left out|nearly tangent"
    r"|several states of motion were possible|yet the statue left its plane|changes with the integrator|nothing moves|drifts"
)
"""Sentences of a model that left its domain, whose numbers are not exact, or that was asked for something that cannot happen."""
_SETTLED: Final = re.compile(
    r"agrees with|(?:is|are) not used|vanishing size were ended|before its difference from another|faces looked at pass through"
)
"""Sentences of what was looked at and found in order, or is without effect."""


def weighed(texts: Iterable[str]) -> Mapping[str, list[str]]:
    """The sentences under each weight, in their order; what is known by neither pattern should be known."""
    lists: dict[str, list[str]] = {CHANGES: [], KNOWN: [], RECORD: []}
    for text in dict.fromkeys(texts):
        lists[CHANGES if _DECIDING.search(text) else RECORD if _SETTLED.search(text) else KNOWN].append(text)
    return lists
