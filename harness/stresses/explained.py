"""Why a cell of a stability map is not stable, as far as the map's own numbers say."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

INACCURATE_RAD: Final = 1e-3
"""Error above which a cell counts as inaccurate: the accuracy that a run aims at unless told otherwise."""
SHRINKS: Final = 0.8
"""A quantity falls with the step when the other step leaves less than this share of it."""


@dataclass(frozen=True)
class Cell:
    """One cell: `category` (stable, inaccurate, drifting, diverged), the numbers that say so, and what it is owed to.

    `early_rad`: the error over the part of the scene that is run with the finest steps as well; `short`: nothing else was run.
    """

    engine: str
    setting: str
    difficulty: str
    category: str
    evidence: str
    explained: str = ""
    error_rad: float | None = None
    early_rad: float | None = None
    gained_j: float = 0.0
    short: bool = False

    def as_dict(self) -> dict[str, Any]:
        """Plain values."""
        return dict(vars(self))


def explained(row: Sequence[Cell], tightest: Callable[[], Cell | None] = lambda: None) -> Iterator[Cell]:
    """The cells of one row, from coarse to fine, those that are not stable with what they owe it to, or "" where nothing says it.

    `tightest` computes the row's scene with the engine's finest rung, where the step alone does not explain.
    """
    for index, cell in enumerate(row):
        if cell.category == "stable":
            yield cell
            continue
        why = _by_finer(cell, row[index + 1 :]) or _by_coarser(cell, row[:index])
        yield replace(cell, explained=why or _by_rung(cell, tightest()))


def _errors(cell: Cell, other: Cell) -> tuple[float, float] | None:
    """The errors of two cells over the same time."""
    pair = (cell.early_rad, other.early_rad) if cell.short or other.short else (cell.error_rad, other.error_rad)
    return None if pair[0] is None or pair[1] is None else (pair[0], pair[1])


def _by_finer(cell: Cell, finer: Sequence[Cell]) -> str:
    """What a finer step shows; one that was run for the first part only shows nothing of the rest."""
    whole = [other for other in finer if not other.short]
    stable = next((other for other in whole if other.category == "stable"), None)
    if stable is not None:
        return f"the step is too long for this scene: {stable.setting} is stable"
    if cell.category == "drifting":
        less = next((other for other in whole if other.gained_j < SHRINKS * cell.gained_j), None)
        return (
            "" if less is None else f"the energy added falls with the step, to {less.gained_j:.1e} J at {less.setting}"
        )
    for other in (*reversed(whole), *(other for other in finer if other.short)):
        errors = _errors(cell, other)
        if errors is not None and errors[1] < SHRINKS * errors[0]:
            part = f" over the first part, where it is {errors[0]:.1e} rad here" if other.short else ""
            return f"the step is too long for this scene: at {other.setting} the error is {errors[1]:.1e} rad{part}"
    return ""


def _by_coarser(cell: Cell, coarser: Sequence[Cell]) -> str:
    """No finer setting is better: whether what is wrong falls with the step, so that the step alone owes it."""
    before = [other for other in coarser if other.category != "diverged"]
    if not before or cell.category == "diverged":
        return ""
    last = before[-1]
    if cell.category == "drifting" and cell.gained_j < SHRINKS * last.gained_j:
        return (
            f"the solver ends each step unconverged; the energy added falls with the step, from {last.gained_j:.1e} J at "
            f"{last.setting} to {cell.gained_j:.1e} J, the error is {cell.error_rad or 0.0:.1e} rad"
        )
    errors = _errors(cell, last)
    if errors is not None and errors[0] < SHRINKS * errors[1]:
        return f"the error falls with the step, from {errors[1]:.1e} rad at {last.setting}: a finer one is wanted"
    return ""


def _by_rung(cell: Cell, tightest: Cell | None) -> str:
    """The step is not to blame: whether the solver's own iterations are."""
    if tightest is None or tightest.early_rad is None or cell.early_rad is None:
        return ""
    if tightest.early_rad > max(INACCURATE_RAD, SHRINKS * cell.early_rad):
        return ""
    return (
        f"the solver ends each step unconverged: with {tightest.setting} the error is {tightest.early_rad:.1e} rad "
        f"where it is {cell.early_rad:.1e} rad here"
    )
