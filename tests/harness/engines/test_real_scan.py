"""A real scan under a real record in three directions: the exact body stands on the same ragged base as pybullet."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analytic import spatial
from harness import Outcome, RunOptions, engines, load_scene
from harness.accuracy.horizon import perturbed
from harness.engines.spatial import outcome_of, problem_of
from tests import budgets_spatial as budget
from tests.measures.seeded_scenes import space_scene

FIRST_IMPACTS_S = 8.2
"""Two impacts after 7.5 s of rest; later flight and sliding tell pybullet's friction from Coulomb's."""


def test_a_scan_shaken_in_space_is_the_same_in_pybullet_and_exactly(root: Path, data_dir: Path) -> None:
    """Its base has 26 points within a millimetre that can touch, of which the outline holds 16."""
    pytest.importorskip("pybullet")
    if not (data_dir / "meshes" / "maria_acephalous.obj").is_file():
        pytest.skip(f"real data absent: {data_dir}")
    scene = load_scene(root / "scenes" / "maria.toml", {"motion.scale": 2.5, "duration_s": FIRST_IMPACTS_S})
    assert (len(scene.statue.footprint_m), len(scene.statue.feet_m)) == (16, 26)
    turns = []
    for name, level in (("spatial", 0), ("pybullet", -1)):
        engine = engines.load(name)
        run = engine.simulate(scene, engine.refinement_levels(scene)[level], RunOptions())
        columns = [run.history.extra[f"{axis}_rad"][:-1] for axis in ("roll", "pitch", "yaw")]
        turns.append(Rotation.from_euler("xyz", np.column_stack(columns)))
    assert np.max(turns[0].magnitude()) > budget.SCAN_ROCKS_RAD
    assert np.max((turns[0] * turns[1].inv()).magnitude()) < budget.SCAN_RAD


def test_outcomes_of_a_scan_are_decided_at_every_friction(root: Path, data_dir: Path) -> None:
    """A ragged base lands on a vertex beside another that slides: a rebound dropped at one pushed the other down, without end."""
    if not (data_dir / "meshes" / "maria_acephalous.obj").is_file():
        pytest.skip(f"real data absent: {data_dir}")
    problem = problem_of(load_scene(root / "scenes" / "maria.toml"))
    friction = np.linspace(0.5, 0.9, 9)
    runs = spatial.outcomes(
        problem, {"friction": friction, "scale": np.full(9, 2.0)}, most_steps=budget.SCAN_STEPS, threads=1
    )
    assert set(runs.outcomes) <= {spatial.Outcome.STANDS, spatial.Outcome.OVERTURNED}


def test_a_rebound_too_small_to_be_seen_is_made_where_nothing_goes_without(root: Path, data_dir: Path) -> None:
    """What stayed down though it rose was pushed sideways by friction that no mode of motion had: the runs ended as paradoxes."""
    if not (data_dir / "meshes" / "maria_acephalous.obj").is_file():
        pytest.skip(f"real data absent: {data_dir}")
    draws = {
        "friction": [0.63771829238493, 0.6696425941776052, 0.5929245901142124],
        "scale": [2.0619104576022864, 1.8303490366706927, 2.033636496347089],
        "heading_rad": [3.950627358320686, 1.6841454106218612, 5.783394393541104],
    }
    problem = problem_of(load_scene(root / "scenes" / "maria.toml"))
    runs = spatial.outcomes(problem, draws, most_steps=budget.SCAN_STEPS, threads=1)
    assert set(runs.outcomes) <= {spatial.Outcome.STANDS, spatial.Outcome.OVERTURNED}


@pytest.mark.parametrize("size", [1e-7, 1e-5, 1e-3])
def test_a_scan_that_barely_turns_goes_on(root: Path, data_dir: Path, size: float) -> None:
    """Three vertices nearly in a line: the forces of a mode were not those of the state put into it, and it went on for 2e-12 s a
    step; at 1e-5 the run was given up at 3e-6 s, and said to stand.
    """
    if not (data_dir / "meshes" / "maria_acephalous.obj").is_file():
        pytest.skip(f"real data absent: {data_dir}")
    scene, engine = load_scene(root / "scenes" / "maria.toml", {"motion.scale": 2.5}), engines.load("spatial")
    for start in perturbed(scene, size)[:2]:
        run = engine.simulate(start, engine.refinement_levels(start)[-1], RunOptions())
        assert run.outcome is Outcome.OVERTURNED_BACK
        assert run.steps <= budget.SCAN_STEPS


def test_a_run_that_is_given_up_has_no_outcome() -> None:
    body = spatial.Body.block(100.0, 0.2, 0.3, 1.0)
    solved = spatial.solve(spatial.Problem(body, 0.1, 0.5), dt_out_s=None)
    for gave_up, reduced, told in (
        (False, Outcome.STANDS, Outcome.STANDS),
        (True, Outcome.STANDS, Outcome.UNDECIDED),
        (True, Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_LEFT),
    ):
        assert outcome_of(replace(solved, gave_up=gave_up), reduced) is told
    paradox = replace(solved, outcome=spatial.Outcome.FRICTION_PARADOX)
    assert outcome_of(paradox, Outcome.STANDS) is Outcome.FRICTION_PARADOX


@pytest.mark.parametrize("seed", [770058, 770101, 770190])
def test_a_pole_is_no_direction_of_sliding(seed: int) -> None:
    """Where a sliding vertex' equations have no solution the sign of its response changes too: taken for a root it hid the true
    one, and the run ended as a paradox.
    """
    scene, engine = space_scene(seed), engines.load("spatial")
    run = engine.simulate(scene, engine.refinement_levels(scene)[-1], RunOptions())
    assert run.outcome is not Outcome.FRICTION_PARADOX
    assert run.end_s == scene.duration_s or run.outcome.overturned
