"""The compiled model held to the independent solver on random blocks under motion in two and three directions."""

import math
from typing import Final

import numpy as np
import pytest

import analytic
from analytic import spatial
from tests import budgets_spatial as budget
from tests.analytic.spatial import reference
from tests.analytic.spatial.bodies import G, base, block_inertia
from tests.analytic.spatial.reference_body import Case

FRICTIONS: Final = (0.3, 0.4, 0.6, 0.8, 1.0, 2.0)
SEEDS: Final = (0, 1, 2, 3, 4, 5, 9, 10, 11, 15, 16, 17)
"""All frictions in turn. Left out: where edges rock by little as they slide (7, 8) the reference takes a minute."""
DURATION_S: Final = 0.5
STEP_S: Final = 0.005


def drawn(seed: int, kinetic: float) -> tuple[spatial.Problem, Case]:
    """A block under harmonics along x and y, every third along z too, for either solver; kinetic: its coefficient's share."""
    rng = np.random.default_rng(seed)
    width, depth = rng.uniform(0.25, 0.45, 2)
    height = rng.uniform(0.8, 1.3)
    mu = FRICTIONS[seed % len(FRICTIONS)]
    amplitudes = [*(rng.uniform(0.35, 0.6, 2) * G), rng.uniform(0.1, 0.2) * G if seed % 3 == 0 else 0.0]
    frequencies = rng.uniform(0.9, 2.0, 3)
    motions = [
        analytic.Harmonic(a, f) if a else analytic.ZeroExcitation()
        for a, f in zip(amplitudes, frequencies, strict=True)
    ]
    x, y, z = (
        lambda t, a=a, f=f: a * math.sin(2.0 * math.pi * f * t) for a, f in zip(amplitudes, frequencies, strict=True)
    )
    problem = spatial.Problem(
        spatial.Body.block(400.0, width, depth, height),
        DURATION_S,
        mu,
        kinetic * mu,
        motion_x=motions[0],
        motion_y=motions[1],
        motion_z=motions[2],
        gravity_m_s2=G,
    )
    case = Case(
        400.0,
        block_inertia(400.0, width, depth, height),
        base(width, depth, height),
        mu,
        kinetic * mu,
        x,
        y,
        z,
        gravity_m_s2=G,
    )
    return problem, case


def angles_rad(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Angle between the attitudes of two histories of quaternions (n, 4)."""
    sign = np.sign(np.einsum("ij,ij->i", one, other))[:, None]
    return np.asarray(4.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(one - sign * other, axis=1), 0.0, 1.0)))


@pytest.mark.parametrize(("seed", "kinetic"), [*((seed, 1.0) for seed in SEEDS), *((seed, 0.75) for seed in SEEDS[:6])])
def test_a_random_block_follows_the_reference(seed: int, kinetic: float) -> None:
    problem, case = drawn(seed, kinetic)
    times = np.linspace(0.0, DURATION_S, round(DURATION_S / STEP_S) + 1)
    wanted = reference.simulate(case, reference.initial_state(np.array([0.0, 0.0, -case.vertices_m[0, 2]])), times)
    found = spatial.certify(problem, dt_out_s=STEP_S)
    assert wanted.outcome == "ran"
    solution = found.solution
    assert len(solution.t_s) == len(times)
    turned = angles_rad(solution.quaternion_wxyz, wanted.states[:, 6:10])
    moved = np.linalg.norm(solution.position_m - wanted.states[:, :3], axis=1)
    impacts = [event.time_s for event in wanted.impacts()]
    before = times < min(impacts, default=math.inf)
    assert before.sum() > 1
    assert turned[before].max() < budget.TWO_SOLVERS
    assert moved[before].max() < budget.TWO_SOLVERS
    reliable = times <= found.reliable_until_s
    assert turned[reliable].max() < budget.TWO_SOLVERS + found.uncertainty_rad
    assert moved[reliable].max() < budget.TWO_SOLVERS + found.place_uncertainty_m
