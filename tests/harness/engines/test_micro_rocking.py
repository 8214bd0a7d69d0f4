"""Rocking in half-cycles of a few milliseconds: steps longer than these must follow it, and it must come to rest in finite
work."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness import load_scene
from harness.comparison.scores import error_rad
from harness.engines.base import Engine
from harness.engines.pybullet.adapter import Bullet3D
from harness.engines.pymunk import Munk2D
from harness.engines.stepping.step_state import ContactGaps
from tests import budgets_engines as budget
from tests.engines_for_tests import NOTHING_SKIPPED, exact, ready, run
from tests.measures.micro_rocking import rows
from tests.measures.random_scenes import GENERATORS
from tests.scenes_for_tests import rectangle, scene

ENGINES = pytest.mark.parametrize("engine", [Munk2D(), Bullet3D()], ids=lambda engine: engine.name)


@ENGINES
@pytest.mark.parametrize("seed", [10129, 20399, 20809, 20866])
def test_a_micro_rocking_is_followed_by_steps_that_are_a_fraction_of_its_half_cycles(engine: Engine, seed: int) -> None:
    ready(engine.name)
    for row in rows(engine, [seed], [1e-3]):
        assert row.sensitive_rad < 1e-5, "the scene itself is sensitive"
        assert row.error_rad[1e-3] <= budget.MICRO_ROCKING_RAD


@ENGINES
@pytest.mark.parametrize("step_s", [4e-3, 1.8e-3])
def test_a_scan_that_hardly_leaves_its_base_is_followed(engine: Engine, step_s: float) -> None:
    """Half-cycles of 1e-6 to 1e-5 rad that grow to 3e-3: of the vertices that a fall would bring down higher ones rise faster."""
    motion = {"x": {"kind": "harmonic", "amplitude_g": 0.113, "frequency_hz": 8.0}}
    on = load_scene("scenes/paestum_floor.toml").replace(motion=motion, duration_s=0.7)
    model = exact(on)
    assert model.peak_theta_rad > 10.0 * budget.MICRO_ROCKING_SCAN_RAD
    assert error_rad(model, run(engine.name, on, step_s), on.duration_s) <= budget.MICRO_ROCKING_SCAN_RAD


def test_a_scan_s_foot_comes_down_as_slowly_as_a_block_s() -> None:
    """A record rocked the shipped scan by 1e-6 rad: its products of inertia made slow impacts none, at every step."""
    scan = load_scene("scenes/paestum_floor.toml")
    block = replace(scan, statue=replace(scan.statue, solid=None, inertia_tensor_kg_m2=np.diag([99.0, 99.0, 40.0])))
    feet_m = np.array([[-0.36, 0.0, -0.774], [0.07, 0.0, -0.774]])
    still = (0.0, 0.0, 0.774, 0.0, 0.0, 0.0, 1.0, *(0.0,) * 6)
    slowest = {ContactGaps(on, feet_m, None, 1e-3).falling_m_s(still) for on in (scan, block)}
    assert not scan.planar
    assert slowest == {ContactGaps(block, feet_m, None, 5e-4).falling_m_s(still)}
    assert max(slowest) < 5e-4 * math.sqrt(scan.gravity_m_s2 * scan.statue.centroid_height_m)


@ENGINES
def test_ever_shorter_half_cycles_end_in_finite_work(engine: Engine) -> None:
    found = run(engine.name, scene(rectangle(0.2, 1.0), theta_rad=2e-4, duration_s=2.0), 4e-3, NOTHING_SKIPPED)
    assert abs(found.history.theta_rad[-1]) <= budget.AFTER_MICRO_ROCKING_RAD
    assert found.steps <= budget.AFTER_MICRO_ROCKING_STEPS * 500


def test_a_half_cycle_in_the_last_steps_of_a_run_ends_with_it() -> None:
    """Its impact fell into the last whole step, and the part that follows it had no step left to end on (an IndexError)."""
    on = GENERATORS["wide"](730074)
    assert run("pymunk", on, 4e-3).end_s == pytest.approx(on.duration_s, rel=1e-12)
