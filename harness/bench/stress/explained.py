"""Why a cell of a stability map is not stable: the setting of the same row that is, or nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Final

from harness.engines.base import Settings
from harness.records.stress import Cell

ITERATIONS: Final = 3000
"""Solver iterations a step: ten times those of the finest levels, which leaves a bench scene's error to the step alone."""
IMPACT_ITERATIONS: Final = 9000
RESIDUAL: Final = 1e-16
"""Squared change of velocity, (m/s)², at which a solver that watches it may end before."""
MANY: Final = {
    "iterations": ITERATIONS, "turning_iterations": ITERATIONS, "impact_iterations": IMPACT_ITERATIONS,
    "event_iterations": IMPACT_ITERATIONS, "residual": RESIDUAL,
}  # fmt: skip
"""By the name of a field of settings; an engine has some of them."""


def explained(row: Sequence[Cell], converged: Callable[[], Cell | None] = lambda: None) -> Iterator[Cell]:
    """The cells of one row, from coarse to fine; those that are not stable with the setting that is, or "" where none is known.

    A cell is explained by a whole run with a finer step that is stable. Where there is none, `converged` computes the row with
    far more iterations a step: that cell follows the others, and explains those before it when it is stable.
    """
    open_cells = [index for index, cell in enumerate(row) if cell.category != "stable" and not _finer(row[index + 1 :])]
    last = converged() if open_cells else None
    for index, cell in enumerate(row):
        if cell.category == "stable":
            yield cell
        elif stable := _finer(row[index + 1 :]):
            yield replace(cell, explained=f"the step is too long for this scene: {stable.setting} is stable")
        elif last is not None and last.category == "stable" and not last.short:
            sentence = (
                f"no step alone avoids it, the solver ends each too early: {last.setting} is stable ({last.evidence})"
            )
            yield replace(cell, explained=sentence)
        else:
            yield cell
    if last is not None:
        yield last


def _finer(finer: Sequence[Cell]) -> Cell | None:
    return next((cell for cell in finer if cell.category == "stable" and not cell.short), None)


def converged(settings: Settings) -> Settings:
    """The same settings with as many iterations as converge. Raises `ValueError` where the engine counts none."""
    known = settings.as_dict()
    if "iterations" not in known:
        raise ValueError(f"{type(settings).__name__} has no iterations")
    changes = {name: value for name, value in MANY.items() if name in known}
    return replace(settings, **changes)


def iterations(settings: Settings) -> str:
    """How many, in words."""
    return f"up to {settings.as_dict()['iterations']} iterations"
