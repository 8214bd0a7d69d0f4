"""The engine `spatial` where a level's runs do not reach their end: another level answers, and is named."""

import time
from dataclasses import replace
from typing import Any

import pytest

import analytic.solver
import analytic.spatial
from analytic.excitation import Harmonic, Pulse
from analytic.machine_code import Entry
from analytic.spatial import Certified, Problem, solver
from analytic.spatial import Outcome as Paradox
from harness import Outcome, RunOptions, engines
from harness.engines import spatial
from harness.engines.spatial import LEVELS
from harness.model import BaseExcitation, Scene
from tests.scenes_for_tests import GRAVITY_M_S2, block, rectangle, scene


def between_two_feet() -> Scene:
    statue = block(
        mass_kg=400.0,
        corner_left_m=0.15,
        corner_right_m=0.17,
        centroid_height_m=0.7,
        inertia_kg_m2=72.0,
        height_m=1.4,
        depth_m=0.4,
    )
    motion = BaseExcitation(Pulse("one_sine", 3.66, 0.7), Pulse("one_sine", 3.37, 0.9, 0.2))
    return replace(scene(statue, mu_statue=0.354, duration_s=2.0), base_excitation=motion)


@pytest.mark.parametrize("level", range(len(LEVELS)))
def test_every_level_answers_by_itself(level: int) -> None:
    given, engine = between_two_feet(), engines.load("spatial")
    run = engine.simulate(given, engine.refinement_levels(given)[level], RunOptions())
    assert run.settings["tolerance"] == LEVELS[level][0]
    assert run.work["levels_given_up"] == 0
    assert run.outcome is Outcome.OVERTURNED_RIGHT


def test_a_level_that_takes_too_many_steps_is_answered_by_the_next_coarser(monkeypatch: pytest.MonkeyPatch) -> None:
    given, engine = between_two_feet(), engines.load("spatial")
    monkeypatch.setattr(spatial, "LEAST_STEPS", 1500)
    monkeypatch.setattr(spatial, "STEPS_SHARE", 1.0)
    coarse, *_, fine = engine.refinement_levels(given)
    run = engine.simulate(given, fine, RunOptions())
    alone = engine.simulate(given, coarse, RunOptions())
    assert run.settings == alone.settings
    assert run.work["levels_given_up"] == len(LEVELS) - 1
    assert run.outcome is alone.outcome
    assert run.peak_theta_rad == alone.peak_theta_rad
    assert run.numerical_uncertainty_rad == alone.numerical_uncertainty_rad


def test_a_coarse_level_that_finds_no_motion_is_answered_by_a_finer_one(monkeypatch: pytest.MonkeyPatch) -> None:
    given, engine, certify = between_two_feet(), engines.load("spatial"), analytic.spatial.certify

    def lost(problem: Problem, *, tolerance: float, **limits: Any) -> Certified:
        found = certify(problem, tolerance=tolerance, **limits)
        if tolerance < LEVELS[0][0]:
            return found
        return replace(found, solution=replace(found.solution, outcome=Paradox.FRICTION_PARADOX), complete=False)

    monkeypatch.setattr(analytic.spatial, "certify", lost)
    run = engine.simulate(given, engine.refinement_levels(given)[0], RunOptions())
    assert run.settings["tolerance"] == LEVELS[1][0]
    assert run.outcome is Outcome.OVERTURNED_RIGHT
    assert run.work["levels_given_up"] == 1


def test_choices_among_several_motions_are_told() -> None:
    """Where the floor falls away under an edge that begins to slide, one of its vertices may let go before the other."""
    given, engine = scene(rectangle(0.27, 1.2, depth_m=0.4), mu_statue=1.0, duration_s=0.15), engines.load("spatial")
    floor = BaseExcitation(x=Harmonic(0.3 * GRAVITY_M_S2, 2.0), z=Harmonic(1.3 * GRAVITY_M_S2, 6.0))
    shaken = replace(given, base_excitation=floor)
    run = engine.simulate(shaken, engine.refinement_levels(shaken)[0], RunOptions())
    (told,) = [found for found in run.findings if found.code == "several_joint_states"]
    assert told.values["count"] == run.work["ambiguous_states"] > 0


def test_a_run_whose_error_nobody_asks_for_is_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    given, engine, runs = between_two_feet(), engines.load("spatial"), []
    level = engine.refinement_levels(given)[0]
    stated = engine.simulate(given, level, RunOptions())
    monkeypatch.setattr(solver, "run_all", lambda *told, run=solver.run_all: (runs.append(1), run(*told)))
    run = engine.simulate(given, level, RunOptions(stated=False))
    assert len(runs) == 2  # with the coarse one that tells how many steps are worth while
    assert run.history is not None
    assert stated.history is not None
    assert run.history.theta_rad.tobytes() == stated.history.theta_rad.tobytes()
    assert run.numerical_uncertainty_rad is run.slip_uncertainty_m is run.reliable_until_s is None
    assert run.impact_times_s == stated.impact_times_s
    assert run.work == {**stated.work, "ambiguous_states": 0}


@pytest.mark.parametrize(("name", "compiled"), [("analytic", analytic.solver.run), ("spatial", solver.run_rows)])
def test_compiling_is_no_part_of_a_runs_time(name: str, compiled: Entry, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is compiled once after an upgrade, for up to a minute, was told as the time that the first run takes."""
    there: list[bool] = []

    def clock() -> float:
        there.append(compiled._call is not None)
        return 0.0

    monkeypatch.setattr(compiled, "_call", None)
    monkeypatch.setattr(time, "perf_counter", clock)
    model, given = engines.load(name), scene(rectangle(0.2, 1.0), duration_s=0.1, theta_rad=0.01)
    model.simulate(given, model.refinement_levels(given)[0], RunOptions())
    assert there
    assert all(there)
