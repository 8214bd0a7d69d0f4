"""Energy lost at each impact of the surveyed statue on the floor (scenes/paestum_floor.toml), known from the reference."""

import numpy as np
import pytest

from analytic import Block, Harmonic, simulate
from tests import budgets_reference as budget
from tests.analytic import reference_lagrange
from tests.analytic.reference_case import GRAVITY, PAESTUM, Case, harmonic
from tests.analytic.reference_lagrange_model import Lagrange

INERTIA_KG_M2 = 118.72641
"""Of the generated statue's mesh; the survey gives none."""
TIMES_S = (0.854385, 0.955105, 1.758210, 1.934888)
LOST_J = (9.095, 8.309, 5.284, 16.985)
"""To the digits printed."""


def test_energy_lost_at_each_impact(monkeypatch: pytest.MonkeyPatch) -> None:
    case = Case(**(PAESTUM | {"inertia": INERTIA_KG_M2}), accel_x=harmonic(0.429 * GRAVITY, 3.0))
    lost: list[float] = []
    right = Lagrange.impact

    def impact(self: Lagrange, side: int, y: np.ndarray, stuck: bool) -> tuple[float, float]:
        after = right(self, side, y, stuck)
        b_old, b_new = (case.b_right, case.b_left) if side > 0 else (case.b_left, case.b_right)
        j_old, j_new = (case.inertia + case.m2 * (case.h**2 + b**2) for b in (b_old, b_new))
        lost.append(0.5 * j_old * float(y[1]) ** 2 - 0.5 * j_new * after[0] ** 2)
        return after

    monkeypatch.setattr(Lagrange, "impact", impact)
    path = reference_lagrange.solve(case, 2.5, 0.02)
    block = Block.two_corners(
        mass_kg=case.m2,
        centroid_height_m=case.h,
        inertia_kg_m2=case.inertia,
        corner_left_m=case.b_left,
        corner_right_m=case.b_right,
    )
    impacts = simulate(block, Harmonic(0.429 * GRAVITY, 3.0), duration_s=2.5).impacts
    assert path.times("impact") == pytest.approx(TIMES_S, abs=1e-6 * budget.PRINTED_DIGITS * 1.01)
    assert lost == pytest.approx(LOST_J, abs=1e-3 * budget.PRINTED_DIGITS * 1.01)
    assert [-event.energy_j for event in impacts] == pytest.approx(lost, rel=budget.KERNEL_RAD)
