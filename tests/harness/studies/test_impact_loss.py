"""What an impact costs, told from a history: the known losses of the paper's statue, and impacts too near to tell apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.engines import load
from harness.model.options import RunOptions
from harness.studies.impact_loss import energy_lost_j
from tests import budgets
from tests.scenes_for_tests import paestum

INERTIA_KG_M2 = 118.72641
KNOWN_J = (9.095, 8.309, 5.284, 16.985)
"""docs/model.md, section 7: the surveyed statue on the floor at 0.429 g and 3 Hz, its first four impacts."""


def test_the_first_impacts_of_the_papers_statue_lose_what_is_known() -> None:
    scene = paestum(0.429, 3.0, pedestal=False, duration_s=2.5)
    scene = scene.but(statue=replace(scene.statue, inertia_kg_m2=INERTIA_KG_M2))
    engine = load("analytic")
    run = engine.simulate(scene, engine.refinement_levels(scene)[-1], RunOptions())
    assert run.history is not None
    lost = energy_lost_j(run.history, run.impact_times_s[:4], scene.pivot_inertia_kg_m2)
    assert lost == pytest.approx(KNOWN_J, rel=budgets.IMPACT_LOSS_REL)
    # Two impacts within a step of each other cannot be told apart; none is told of a history without any.
    first = run.impact_times_s[0]
    assert energy_lost_j(run.history, (first, first + 1e-3), scene.pivot_inertia_kg_m2).size == 0
    assert np.array_equal(energy_lost_j(run.history, (), scene.pivot_inertia_kg_m2), np.zeros(0))
