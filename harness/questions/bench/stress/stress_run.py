"""The stress run: hard scenes and stability maps, on all cores and in parts; one record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

from harness import engines
from harness.questions.bench.stress import hard_scenes as scenes
from harness.questions.bench.stress import stability
from harness.questions.bench.stress.catalogue import ALL
from harness.records.bench import HardRow, StabilityCell, StressRecord, answer_of, findings_of
from harness.runs.parts import Measurement, Part


def assembled(rows: Mapping[str, Sequence[Any]], head: Mapping[str, Any]) -> StressRecord:
    """The record from the rows of all parts; engines of the catalogue that are not here are named with the reason."""
    order = {row.name: place for place, row in enumerate(stability.difficulties())}
    missing = {name: engines.load(name).missing() for name in ALL}
    made = StressRecord(
        absent={name: why for name, why in missing.items() if why is not None},
        scenes=rows["scenes"],
        cells=sorted(rows["maps"], key=lambda cell: (stability.ENGINES.index(cell.engine), order[cell.difficulty])),
        **head,
    )
    return replace(made, answer=answer_of(made), findings=findings_of(made))


def all_parts(quick: bool) -> list[Part]:
    """The parts, the one with the longest tasks first: all are computed side by side."""
    return [
        Part("maps", stability.tasks(quick), partial(stability.compute, quick), stability.died, StabilityCell),
        Part("scenes", scenes.tasks(quick), scenes.compute, scenes.died, HardRow),
    ]


STRESS: Final = Measurement("stress", all_parts, assembled)
