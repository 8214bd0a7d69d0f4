"""What random rechecks say: whether the runs that were left out would have said anything new."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from harness.records.study import RecheckRecord, StudyRow, Value
from harness.studies import case_selection as selection
from harness.studies.file import StudyFile


def recheck(study: StudyFile, rows: Sequence[StudyRow]) -> RecheckRecord | None:
    """How the rechecked cases came out, in numbers and one sentence; None where every case was asked.

    Near a boundary the engine's outcome is held against the analytic one, on a refined map against the outcome that its cell was
    taken to have.
    """
    if study.ask.cases == "all":
        return None
    expected = _of_reference(rows) if study.ask.cases == "boundary" else _of_cells(study, rows)
    asked = [(row, row.run) for row in rows if row.run is not None and _place(row) in expected]
    differ = sum(run.outcome != expected[_place(row)] for row, run in asked)
    against = (
        "the analytic model's" if study.ask.cases == "boundary" else "the one that the map would have taken for it"
    )
    sentence = f"Of the cases left out, {len(asked)} were run at random after all: {differ} had another outcome than {against}."
    return RecheckRecord(len(asked), differ, sentence)


def _place(row: StudyRow) -> tuple[int, str]:
    return row.number, row.engine


def _of_reference(rows: Sequence[StudyRow]) -> dict[tuple[int, str], str]:
    """The analytic outcome of every rechecked case, by the case and the engine that was asked."""
    known = {row.number: str(row.run.outcome) for row in rows if _is_reference(row) and row.run is not None}
    return {
        _place(row): known[row.number]
        for row in rows
        if row.reason == selection.RECHECK and not _is_reference(row) and row.number in known
    }


def _is_reference(row: StudyRow) -> bool:
    return row.engine == selection.REFERENCE and row.run is not None


def _of_cells(study: StudyFile, rows: Sequence[StudyRow]) -> dict[tuple[int, str], str]:
    """What a map refined without the rechecks says of every rechecked case, by case and engine."""
    values = {item.key: sorted({row.varied[item.key] for row in rows}, key=repr) for item in study.vary}
    index = {key: {repr(value): k for k, value in enumerate(_in_order(own))} for key, own in values.items()}
    axes = selection.map_axes(study)
    groups: dict[tuple[str, str], list[tuple[selection.Place, StudyRow]]] = defaultdict(list)
    for row in rows:
        if row.engine != selection.REFERENCE:
            place = tuple(index[item.key][repr(row.varied[item.key])] for item in study.vary)
            groups[row.engine, str(row.varied["variant"])].append((place, row))
    expected: dict[tuple[int, str], str] = {}
    for members in groups.values():
        places = [place for place, _ in members]
        known = {p: selection.Answer(str(row.run.outcome), 0.0) for p, row in members if row.run is not None}
        needed = selection.refined(places, known, axes)
        taken = selection.filled(places, {place: known[place] for place in needed if place in known}, axes)
        for place, row in members:
            if row.reason == selection.RECHECK and place not in needed and place in taken:
                expected[_place(row)] = taken[place]
    return expected


def _in_order(values: Sequence[Value]) -> list[Value]:
    """Numbers by size, so that the neighbours of a grid are neighbours; anything else by its text."""
    numbers = all(isinstance(value, (int, float)) for value in values)
    return sorted(values) if numbers else list(values)
