"""A study's rows arranged for tables and pictures: conditions down, models across."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from harness.model.history import Outcome
from harness.records.study import CaseRun, StudyRow, Value
from reports.messages import Language

SIGNS: Final = {
    "stands": "●", "overturned_left": "◀", "overturned_right": "▶", "overturned_front": "▼", "overturned_back": "▲",
    "touches_wall": "▌", "left_pedestal": "⇲", "lift_off": "↥", "friction_paradox": "∅", "undecided": "?",
}  # fmt: skip
"""The sign of each outcome: told apart without colour."""
FAMILY: Final = {"stands": "stands", "touches_wall": "wall"}


@dataclass(frozen=True)
class Cell:
    """One model's answer under one condition."""

    sign: str
    words: str
    family: str
    tip: str


@dataclass(frozen=True)
class Condition:
    """One combination of what the study varies, with every model's row of it (the variants' own keys aside)."""

    varied: Mapping[str, Value]
    answers: Mapping[str, StudyRow] = field(default_factory=dict)

    def run(self, model: str) -> CaseRun | None:
        """A model's run; None where it was not sent."""
        row = self.answers.get(model)
        return None if row is None else row.run

    def number(self, key: str) -> float:
        """The value of a key that varies among numbers. Raises `TypeError` for a text."""
        value = self.varied[key]
        if isinstance(value, str):
            raise TypeError(f"{key} is {value!r}, no number")
        return value


def conditions(rows: Sequence[StudyRow]) -> tuple[list[str], list[Condition]]:
    """The models in their order, and all conditions in the study's order."""
    models: dict[str, None] = {}
    by_keys: dict[tuple[Value, ...], tuple[dict[str, Value], dict[str, StudyRow]]] = {}
    for row in sorted(rows, key=lambda item: int(item.number)):
        varied = {key: value for key, value in row.varied.items() if key != "variant"}
        models[row.model] = None
        by_keys.setdefault(tuple(varied.values()), (varied, {}))[1][row.model] = row
    variants = list(dict.fromkeys(model.partition(" (")[2] for model in models))
    return sorted(models, key=lambda model: _order(model, variants)), [
        Condition(varied, answers) for varied, answers in by_keys.values()
    ]


def runs_of(cases: Sequence[Condition], model: str) -> list[tuple[Condition, CaseRun]]:
    """The conditions that a model answered, each with its run."""
    return [(item, run) for item in cases if (run := item.run(model)) is not None]


def _order(model: str, variants: Sequence[str]) -> tuple[int, int, str]:
    """Variants as the study has them, within each the analytic model first."""
    engine, _, variant = model.partition(" (")
    rank = {"analytic": 0, "pymunk": 1, "pybullet": 2}.get(engine, 3)
    return variants.index(variant), rank, engine


def family(outcome: str) -> str:
    """The outcome's class for colours: stands, overturns, wall, other, failed."""
    if Outcome(outcome).overturned:
        return "overturns"
    if Outcome(outcome).failed:
        return "failed"
    return FAMILY.get(outcome, "other")


def symbol(outcome: str, say: Language) -> tuple[str, str]:
    """Sign and words of an outcome, of any failure the same."""
    return (SIGNS[outcome], say(f"short.{outcome}")) if outcome in SIGNS else ("✕", say("text.map_failed"))


def symbols(say: Language) -> list[tuple[str, str]]:
    """Every sign with its words."""
    return [*(symbol(each, say) for each in (*SIGNS, "failed")), ("·", say("text.not_sent"))]


def cell(row: StudyRow | None, say: Language) -> Cell:
    """What a table shows of one row."""
    run = None if row is None else row.run
    if run is None:
        sign, words = symbols(say)[-1]
        return Cell(sign, words, "none", words if row is None else say.word(str(row.reason)))
    sign, words = symbol(run.outcome, say)
    stood = run.outcome == "stands"
    told = {
        "peak": abs(run.peak_theta_rad) if stood and run.peak_theta_rad is not None else None,
        "no_return": run.no_return_time_s,
        "error": run.numerical_uncertainty_rad,
    }
    known = [say(f"text.tip_{name}", value=say.digits(value, 4)) for name, value in told.items() if value is not None]
    return Cell(sign, words, family(run.outcome), "; ".join([words, *known]))


def varying_keys(cases: Sequence[Condition]) -> list[str]:
    """The keys that take more than one value."""
    keys = list(cases[0].varied) if cases else []
    return [key for key in keys if len({repr(item.varied[key]) for item in cases}) > 1]
