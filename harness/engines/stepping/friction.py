"""Two coefficients of friction in an engine that knows one.

The rule, for each step: if the pedestal is stuck when the step begins, the step is computed with the static coefficient; if
the floor's friction impulse then stands at its limit, the static limit was passed inside the step, and the step is computed
again from its beginning with the kinetic coefficient (docs/model.md, sections 2 and 3: sticking holds while |F| ≤ μ_s N, else
F = −μ_k N, in motion and in an impact alike). A step that begins sliding is computed with the kinetic coefficient; when the
velocity comes to rest or changes sign in it, the next one begins stuck. Without the repetition the first sliding step, or an
impact that breaks the pedestal loose, acts with μ_s: at an impact that is an error of (μ_s − μ_k) P_n that no step size cures.
Judging by the velocity instead of the impulse is late by a time that falls only with the root of the step: the velocity has
first to grow above what the solver leaves in a pedestal that is stuck.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from harness.model.scene import Scene

Pair = tuple[float, float]

STUCK_SHARE: Final = 0.02
"""A velocity below this share of what kinetic friction takes away in one step is rest: solvers leave a little."""


@dataclass(frozen=True)
class FloorFriction:
    """Coefficients of the pedestal on the floor; `stuck_below_m_s` is the velocity that counts as rest."""

    static: float
    kinetic: float
    stuck_below_m_s: float

    @property
    def switches(self) -> bool:
        """Whether the two numbers differ, so that the coefficient must follow the sliding state."""
        return self.static != self.kinetic


def floor_friction(scene: Scene, dt_s: float) -> FloorFriction:
    """The floor's friction for steps of `dt_s`."""
    # In one step kinetic friction takes μ_k g Δt from a velocity: what a solver leaves is in proportion to it.
    contact = scene.contact
    return FloorFriction(
        contact.floor_static, contact.floor_kinetic, STUCK_SHARE * contact.floor_kinetic * scene.gravity_m_s2 * dt_s
    )


def followed(friction: FloorFriction, before_m_s: Pair, now_m_s: Pair) -> float:
    """The plainest rule for two numbers in an engine that knows one: kinetic once the pedestal slid the same way at the ends of
    two steps in a row, `before_m_s` and `now_m_s`, else static.

    It is asked after a step and holds for the next. No step is repeated, so the two steps in which the pedestal breaks loose act
    with the static coefficient: at an impact an error of (μ_s − μ_k) P_n that no step size cures (see above).
    """
    (u, v), (x, y) = before_m_s, now_m_s
    # One step's speed is not enough, where more than kinetic friction is needed to hold the pedestal: one that turned back was at
    # rest inside the step, and one that is let go because an engine lost the statue's contact for a step would be held again. By
    # that speed alone both slide on, at a chance that no step size cures (0.02 rad in a scene of the paper, pymunk at 0.25 ms).
    slides = u * x + v * y > 0.0 and min(math.hypot(u, v), math.hypot(x, y)) > friction.stuck_below_m_s
    return friction.kinetic if slides else friction.static
