"""An engine's settings with far more iterations a step: what a solver would find if it did not end its steps early."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

from harness.engines.base import Settings

ITERATIONS: Final = 3000
"""Sweeps a step: ten times those of the finest levels, which leaves a bench scene's error to the step alone."""
IMPACT_ITERATIONS: Final = 9000
RESIDUAL: Final = 1e-16
"""Squared change of velocity, (m/s)², at which a solver that watches it may end before."""
MANY: Final = {
    "iterations": ITERATIONS, "turning_iterations": ITERATIONS, "impact_iterations": IMPACT_ITERATIONS,
    "event_iterations": IMPACT_ITERATIONS, "residual": RESIDUAL,
}  # fmt: skip
"""By the name of a field of settings; an engine has some of them."""


def converged(settings: Settings) -> Settings:
    """The same settings with as many iterations as converge. Raises `ValueError` where the engine counts none."""
    known = settings.as_dict()
    if "iterations" not in known:
        raise ValueError(f"{type(settings).__name__} has no iterations")
    changes: dict[str, Any] = {name: value for name, value in MANY.items() if name in known}
    return replace(settings, **changes)


def iterations(settings: Settings) -> str:
    """How many, in words."""
    return f"up to {settings.as_dict()['iterations']} iterations"
