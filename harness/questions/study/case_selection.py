"""Which cases an engine is asked (all, those near the boundary of the outcome, or a map refined where it changes), and what
random rechecks say of those that were left out."""

import itertools
import random
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from harness.model import grouped
from harness.questions.study.file import StudyFile
from harness.records.study import RecheckRecord, StudyRow

Place = tuple[int, ...]
Cell = tuple[tuple[int, int], tuple[int, int]]
"""Lowest and highest index along both axes of a map."""

REFERENCE: Final = "analytic"
"""The model that runs every case first; it costs next to nothing."""
EVERY: Final = "every_case"
NEAR: Final = "near_change"
MARGIN: Final = "near_balance"
RECHECK: Final = "random_recheck"
COARSE: Final = "coarse_grid"
REFINED: Final = "beside_change"
NOT_SENT: Final = "not_sent"
SAME_CELL: Final = "same_cell"
"""Why a case is asked or not, as the catalogues of messages name it."""
COARSEST: Final = 8
"""Stride of the map's first grid: every eighth point along each axis."""


@dataclass(frozen=True)
class PlaceAnswer:
    """What one run said: its outcome and its peak as a share of the slenderness on that side."""

    outcome: str
    share: float


def map_axes(study: StudyFile) -> tuple[int, int]:
    """The two axes given as grids, which make the map (the study file's own check: there are exactly two)."""
    first, second = (axis for axis, item in enumerate(study.vary) if item.values is None)
    return first, second


def near_boundary(known: Mapping[Place, PlaceAnswer], margin: float, share: float, seed: int) -> dict[Place, str]:
    """Places whose neighbour's outcome differs or whose peak is near the balance point; of the rest a random share."""
    reasons = {}
    stream = random.Random(seed)
    for place in sorted(known):
        draw = stream.random()
        around = (known[other] for other in neighbours(place) if other in known)
        if any(other.outcome != known[place].outcome for other in around):
            reasons[place] = NEAR
        elif abs(known[place].share - 1.0) <= margin:
            reasons[place] = MARGIN
        elif draw < share:
            reasons[place] = RECHECK
    return reasons


def rechecked(places: Iterable[Place], share: float, seed: int) -> dict[Place, str]:
    """A random share of all places, the same for every engine and every call."""
    stream = random.Random(seed)
    return {place: RECHECK for place in sorted(set(places)) if stream.random() < share}


def neighbours(place: Place) -> list[Place]:
    """The next places along each axis."""
    return [(*place[:axis], place[axis] + step, *place[axis + 1 :]) for axis in range(len(place)) for step in (-1, 1)]


def refined(
    places: Sequence[Place],
    known: Mapping[Place, str],
    axes: tuple[int, int],
    strides: tuple[int, int] = (COARSEST, COARSEST),
) -> dict[Place, str]:
    """The map's places to compute: a coarse grid first, then the halves of every cell whose known corners differ."""
    reasons: dict[Place, str] = {}
    for _, corners, reason in _cells(places, known, axes, strides):
        for corner in corners:
            reasons.setdefault(corner, reason)
    return reasons


def filled(
    places: Sequence[Place],
    known: Mapping[Place, str],
    axes: tuple[int, int],
    strides: tuple[int, int] = (COARSEST, COARSEST),
) -> dict[Place, str]:
    """The outcome of a refined map's places: their own where computed, else that of their cell, whose corners agree."""
    outcome = dict(known)
    for cell, corners, _ in _cells(places, known, axes, strides):
        said = {known.get(corner) for corner in corners}
        if len(said) == 1 and (agreed := said.pop()) is not None:
            for pair in itertools.product(*(range(low, high + 1) for low, high in cell)):
                outcome.setdefault(_placed(corners[0], axes, pair), agreed)
    return outcome


def _cells(
    places: Sequence[Place], known: Mapping[Place, str], axes: tuple[int, int], strides: tuple[int, int]
) -> Iterator[tuple[Cell, list[Place], str]]:
    """The cells of every map with their corners and why these are computed; the halves of one whose corners differ follow it.

    A cell is cut when its corners are all known and disagree; an unknown corner waits for the next call.
    """
    # The places of each map agree on every other axis: their indices on the map's own axes are set to 0.
    for fixed, plane in grouped((_placed(place, axes, (0, 0)), place) for place in places).items():
        ends = [max(place[axis] for place in plane) for axis in axes]
        grid = [[*range(0, end, stride), end] for end, stride in zip(ends, strides, strict=True)]
        cells = [(cell, COARSE) for cell in _between(grid)]
        while cells:
            cell, reason = cells.pop()
            corners = [_placed(fixed, axes, pair) for pair in itertools.product(*cell)]
            yield cell, corners, reason
            said = {known.get(corner) for corner in corners}
            if len(said) > 1 and None not in said:
                halves = [sorted({low, (low + high) // 2, high}) for low, high in cell]
                # A cell without places between its corners is its own only part.
                cells += [(part, REFINED) for part in _between(halves) if part != cell]


def _between(lines: Iterable[Iterable[int]]) -> list[Cell]:
    """The cells between the lines along both axes."""
    first, second = map(itertools.pairwise, lines)
    return list(itertools.product(first, second))


def _placed(place: Place, axes: tuple[int, int], indices: Sequence[int]) -> Place:
    changed = list(place)
    for axis, index in zip(axes, indices, strict=True):
        changed[axis] = index
    return tuple(changed)


def recheck(study: StudyFile, rows: Sequence[StudyRow]) -> RecheckRecord | None:
    """How the rechecked cases came out; None where every case was asked.

    Near a boundary the engine's outcome is held against the analytic one, on a refined map against the outcome that its cell was
    taken to have.
    """
    if study.ask.cases == "all":
        return None
    near = study.ask.cases == "boundary"
    expected = _of_reference(rows) if near else _of_cells(study, rows)
    asked = [(row.run.outcome, expected.get((row.number, row.engine))) for row in rows if row.run is not None]
    told = [(outcome, taken) for outcome, taken in asked if taken is not None]
    differ = sum(outcome != taken for outcome, taken in told)
    return RecheckRecord(len(told), differ, "analytic" if near else "map")


def _of_reference(rows: Sequence[StudyRow]) -> dict[tuple[int, str], str]:
    """The analytic outcome of every rechecked case, by the case and the engine that was asked."""
    known = {row.number: str(row.run.outcome) for row in rows if row.engine == REFERENCE and row.run is not None}
    asked = [row for row in rows if row.reason == RECHECK and row.engine != REFERENCE]
    return {(row.number, row.engine): known[row.number] for row in asked if row.number in known}


def _of_cells(study: StudyFile, rows: Sequence[StudyRow]) -> dict[tuple[int, str], str]:
    """What a map refined without the rechecks says of every rechecked case, by case and engine."""
    axes = map_axes(study)
    groups: dict[tuple[str, int], dict[Place, StudyRow]] = defaultdict(dict)
    for row in rows:
        if row.engine != REFERENCE:
            place = study.place(row.number)
            groups[row.engine, place[-1]][place[:-1]] = row
    expected: dict[tuple[int, str], str] = {}
    for members in groups.values():
        known = {place: str(row.run.outcome) for place, row in members.items() if row.run is not None}
        needed = refined([*members], known, axes)
        taken = filled([*members], {place: known[place] for place in needed if place in known}, axes)
        for place, row in members.items():
            if row.reason == RECHECK and place not in needed and place in taken:
                expected[row.number, row.engine] = taken[place]
    return expected
