"""A study's rows arranged for tables and pictures: conditions down, models across."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final, Self

from harness.model import grouped
from harness.records.study import CaseRun, StudyRow, Value
from reports.messages import Language

LEAST: Final = 3
"""Fewer values than this along an axis make no map and no curve: the table shows them better."""
ENGINES: Final = ("analytic", "pymunk", "pybullet")
"""Those that come first within a variant."""


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
        """The value of a key that varies among numbers."""
        return float(self.varied[key])


@dataclass(frozen=True)
class Answers:
    """What the models of a study answer under each condition."""

    models: Sequence[str]
    cases: Sequence[Condition]
    asked: Sequence[str] = ()
    """The keys of the study's own axes; what is scattered stands in the conditions alone."""

    @classmethod
    def of(cls, rows: Iterable[StudyRow], asked: Iterable[str] = ()) -> Self:
        """The conditions in the study's order; variants as the study has them, within each the analytic model first."""
        ordered = sorted(rows, key=lambda row: int(row.number))
        varied = [{key: value for key, value in row.varied.items() if key != "variant"} for row in ordered]
        by_values = grouped((tuple(each.values()), (each, row)) for each, row in zip(varied, ordered, strict=True))
        cases = [Condition(group[0][0], {row.model: row for _, row in group}) for group in by_values.values()]
        models = list(dict.fromkeys(row.model for row in ordered))
        variants = list(dict.fromkeys(model.partition(" (")[2] for model in models))

        def place(model: str) -> tuple[int, int, str]:
            engine, _, variant = model.partition(" (")
            return variants.index(variant), (*ENGINES, engine).index(engine), engine

        return cls(sorted(models, key=place), cases, [*asked])

    @cached_property
    def keys(self) -> list[str]:
        """All keys of the conditions."""
        return list(self.cases[0].varied) if self.cases else []

    @cached_property
    def varying(self) -> list[str]:
        """The keys that take more than one value."""
        return [key for key in self.keys if len({repr(item.varied[key]) for item in self.cases}) > 1]

    @cached_property
    def axes(self) -> list[str]:
        """The study's own axes along which something varies."""
        return [key for key in self.asked if key in self.varying]

    def runs(self, model: str) -> list[tuple[Condition, CaseRun]]:
        """The conditions that a model answered, each with its run."""
        return [(item, run) for item in self.cases if (run := item.run(model)) is not None]

    def numbers(self, key: str) -> list[float]:
        """The values that a key takes, in their order; none where one of them is not a number."""
        values = {item.varied[key] for item in self.cases}
        known = [value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool)]
        return sorted(map(float, known)) if len(known) == len(values) else []

    @cached_property
    def plane(self) -> tuple[str, str] | None:
        """The axes of a map: the two of numbers with most values, when both have enough of them (an amplitude is drawn
        upwards)."""
        sizes = sorted(((len(self.numbers(key)), key) for key in self.axes), reverse=True)
        first, second = ([key for size, key in sizes if size >= LEAST] + ["", ""])[:2]
        if not second:
            return None
        return (second, first) if "amplitude" in first else (first, second)

    @cached_property
    def single_plane(self) -> tuple[str, str] | None:
        """The axes of a map where each of its places stands for one condition."""
        places = {tuple(item.varied[key] for key in self.plane or ()) for item in self.cases}
        return self.plane if len(places) == len(self.cases) else None

    def apart(self, kept: Sequence[str], say: Language) -> list[tuple[str, Self]]:
        """The conditions by all axes but the `kept`, with what these are in words."""
        keys = [key for key in self.axes if key not in kept]
        groups = grouped((repr([item.varied[key] for key in keys]), item) for item in self.cases)
        return [
            (
                "".join(f" · {say.label(key)} {say.value(members[0].varied[key], 'plain')}" for key in keys),
                replace(self, cases=members),
            )
            for members in groups.values()
        ]
