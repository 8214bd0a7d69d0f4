"""What is to be known of an answer: a code and the values of its sentence, not the sentence.

Whoever finds something says `caution("near_tie", margin=1e-5)`. `reports.messages` holds one sentence for each code in each
language; it is filled in where a result is written or shown, and no code reads one back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any, Final


class Severity(StrEnum):
    """How much a finding bears on the answer, the heaviest first."""

    CHANGES_ANSWER = "changes_answer"
    CAUTION = "caution"
    INFO = "info"


WEIGHT: Final = {severity: place for place, severity in enumerate(Severity)}
"""Place of each severity when findings are sorted."""


@dataclass(frozen=True)
class Finding:
    """One thing to know: `code` names its sentence, `values` fill it, `engine` is the engine or pair (`a_vs_b`) it is of.

    `values` are plain numbers in the unit that ends their key, names, lists and tables of them. An empty `engine`: of the scene.
    `text` is its sentence in a record; empty before.
    """

    code: str
    severity: Severity
    values: Mapping[str, Any] = field(default_factory=dict)
    engine: str = ""
    text: str = ""

    def of(self, engine: str) -> Finding:
        """The same finding of an engine or a pair; one that has its own keeps it."""
        return self if self.engine else replace(self, engine=engine)


Say = Callable[[Finding], str]
"""A finding's sentence in some language."""


def changes_answer(code: str, **values: Any) -> Finding:
    """A finding with which the answer may be another one."""
    return Finding(code, Severity.CHANGES_ANSWER, values)


def caution(code: str, **values: Any) -> Finding:
    """A finding to know before the numbers are used."""
    return Finding(code, Severity.CAUTION, values)


def info(code: str, **values: Any) -> Finding:
    """A finding for the record."""
    return Finding(code, Severity.INFO, values)


def weighed(findings: Iterable[Finding]) -> list[Finding]:
    """The findings by severity, each once, otherwise in their order."""
    once: list[Finding] = []
    for each in findings:
        if each not in once:
            once.append(each)
    return sorted(once, key=lambda each: WEIGHT[each.severity])


def texted(findings: Iterable[Finding], say: Say) -> list[Finding]:
    """The findings with their sentences."""
    return [replace(each, text=say(each)) for each in findings]


@dataclass(frozen=True)
class Answer:
    """The headline of a result: `code` says what kind of answer it is, `findings` are its sentences in order.

    `text` is all of them in a record; empty before.
    """

    code: str
    findings: Sequence[Finding]
    text: str = ""

    def texted(self, say: Say) -> Answer:
        """The answer with its sentences."""
        said = texted(self.findings, say)
        return Answer(self.code, said, " ".join(each.text for each in said if each.text))
