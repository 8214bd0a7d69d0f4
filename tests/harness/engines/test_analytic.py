"""The analytic model behind the engine contract: every wish, label, limit and form reaches the run."""

from dataclasses import replace

import numpy as np
import pytest

import analytic
from analytic import Harmonic, Pulse
from harness import Outcome, Run, RunOptions
from harness.engines.analytic import ACCURACIES_RAD, TwoBlock
from harness.engines.base import EngineFailure, Settings
from harness.model import Form, Pedestal, Scene, Severity, Wall, block_of, keywords
from tests import doubles
from tests.scenes_for_tests import GRAVITY_M_S2, PAESTUM, PAESTUM_PEDESTAL, paestum, rectangle, scene

ENGINE = TwoBlock()
EVERYTHING = RunOptions(skips=frozenset())


def run(each: Scene, options: RunOptions = EVERYTHING, settings: Settings | None = None) -> Run:
    return ENGINE.simulate(each, settings or ENGINE.refinement_levels(each)[1], options)


def test_it_is_always_there_and_its_levels_aim_finer_and_finer() -> None:
    assert ENGINE.missing() is None
    each = paestum()
    errors = [level.expected_error_rad for level in ENGINE.refinement_levels(each)]
    assert tuple(errors) == ACCURACIES_RAD
    assert ENGINE.settings_for_dt(each, 0.005).dt_s == 0.005


def test_it_gives_what_the_library_gives() -> None:
    each = paestum(mu=(0.20, 0.15))
    ours = run(each)
    theirs = analytic.simulate(
        block_of(each), each.base_excitation.x, dt_s=each.output_dt_s, accuracy_rad=ACCURACIES_RAD[1], **keywords(each)
    )
    assert np.array_equal(ours.history.theta_rad, theirs.theta_rad)
    assert np.array_equal(ours.history.slip_m, theirs.slip_m)
    assert ours.impact_times_s == tuple(theirs.impact_times_s)
    assert ours.validity["energy_lost_j"] == theirs.energy_lost_j


def test_verification_runs_are_finer_and_agree_within_what_is_stated() -> None:
    each = paestum(duration_s=0.8)
    first = ENGINE.refinement_levels(each)[1]
    base = run(each, settings=first)
    finer, shorter = (run(each, settings=verification) for verification in ENGINE.verification_settings(each, first))
    assert base.numerical_uncertainty_rad is not None
    for verification in (finer, shorter):
        assert np.max(np.abs(verification.history.theta_rad - base.history.theta_rad)) <= base.numerical_uncertainty_rad
    assert shorter.steps > base.steps


def test_an_outcome_is_told_what_leaves_the_domain_after_the_motion() -> None:
    """A tall pedestal whose statue was struck tips at an impact at 0.86 s, long after the blow of 0.17 s."""
    tall, blow = Pedestal(7085.0, 2.3, 3.14, 3.11), Pulse("rectangular", 0.42 * GRAVITY_M_S2, 0.167)
    statue = rectangle(1.59, 4.77, mass_kg=10657.0)
    each = scene(statue, blow, pedestal=tall, mu=(0.3, 0.27), mu_statue=0.51, duration_s=3.0, theta_rad=-0.096)
    whole, alone = run(each), run(each, RunOptions(history=False))
    assert whole.validity["left_domain_s"] > 0.2
    assert alone.validity["left_domain_s"] == pytest.approx(whole.validity["left_domain_s"], rel=1e-9)
    assert (alone.end_s, alone.impacts) == (whole.end_s, whole.impacts)


def test_vertical_motion_reaches_the_run_and_can_lift_it_off() -> None:
    each = paestum(0.3, 2.0)
    plain = run(each)
    shaken = run(replace(each, base_excitation=replace(each.base_excitation, z=Harmonic(3.0, 5.0))))
    assert shaken.peak_theta_rad != plain.peak_theta_rad
    flown = run(replace(each, base_excitation=replace(each.base_excitation, z=Harmonic(1.2 * GRAVITY_M_S2, 2.0))))
    assert flown.outcome is Outcome.LIFT_OFF
    assert flown.end_s < each.duration_s


def test_motion_across_the_plane_is_left_out_and_told() -> None:
    each = paestum()
    across = run(replace(each, base_excitation=replace(each.base_excitation, y=Harmonic(2.0, 2.0))))
    assert "motion_across_left_out" in doubles.codes(across.findings)
    assert across.peak_theta_rad == run(each).peak_theta_rad


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_wall_ends_the_run(side: str) -> None:
    tilt = 0.05 if side == "right" else -0.3
    rate = 0.5 if side == "right" else -1.5
    each = scene(PAESTUM, theta_rad=tilt, theta_rate_rad_s=rate, wall=Wall(side, 0.55), duration_s=2.0)  # type: ignore[arg-type]
    found = run(each)
    assert found.outcome is Outcome.TOUCHES_WALL
    assert each.wall_rotation_rad is not None
    assert found.peak_theta_rad == pytest.approx(each.wall_rotation_rad, abs=1e-9)


def test_a_wall_that_is_reached_after_the_end_has_no_time() -> None:
    """The energy at the end of the run tells that the statue will touch it, not when."""
    each = scene(PAESTUM, theta_rad=0.05, theta_rate_rad_s=0.9, wall=Wall("right", 0.55), duration_s=2.0)
    touched_s = run(each).validity["wall_touch_time_s"]
    short = run(replace(each, duration_s=0.5 * touched_s))
    assert short.outcome is Outcome.TOUCHES_WALL
    assert "wall_touch_time_s" not in short.validity


def test_a_run_that_is_known_up_to_its_wall_is_known_to_its_end() -> None:
    """Runs of other tolerances touch it some 1e-8 s earlier or later: no part of the history lies between."""
    shaken = replace(paestum(0.429, 3.0, pedestal=False, duration_s=10.0), wall=Wall("right", 0.6))
    found = run(shaken)
    assert found.outcome is Outcome.TOUCHES_WALL
    assert found.end_s - 1e-6 < found.reliable_until_s < found.end_s
    assert "error_not_bounded" not in doubles.codes(found.findings)


def test_both_preset_forms_reach_the_model() -> None:
    mu = (0.20, 0.15)
    consistent = paestum(0.429, 4.5, mu=mu, duration_s=4.0)
    paper = paestum(0.429, 4.5, mu=mu, restitution=0.875, form=Form("static", "unchanged"), duration_s=4.0)
    assert keywords(consistent)["form"] == analytic.Form()
    assert keywords(paper)["form"] == analytic.Form.paper(0.875)
    ours, theirs = run(consistent), run(paper)
    assert ours.validity["energy_gained_j"] == 0.0
    assert theirs.validity["energy_gained_j"] > 0.0
    assert "impacts_gained_energy" in doubles.codes(theirs.findings)
    ratios = theirs.validity["impact_ratios"]
    kept = [ratio for ratio in ratios if ratio != 0.0]
    assert kept
    assert kept == pytest.approx([0.875] * len(kept), rel=1e-12)


def test_limits_of_the_model_are_reported_with_the_run() -> None:
    with_pedestal, bare = run(paestum()), run(paestum(pedestal=False))
    assert "pedestal_tipping_margin_m" in with_pedestal.validity
    assert "pedestal_tipping_margin_m" not in bare.validity
    assert bare.validity["peak_over_slenderness"] > 0.0
    smooth = scene(PAESTUM, Harmonic(0.429 * GRAVITY_M_S2, 3.0), pedestal=PAESTUM_PEDESTAL, mu_statue=0.1)
    left = run(smooth)
    assert left.validity["left_domain_s"] is not None
    assert "left_domain" in doubles.codes(left.findings)


def test_what_the_library_refuses_is_an_engine_failure_in_its_words() -> None:
    each = paestum()
    beyond = replace(each, initial=replace(each.initial, theta_rad=1.6))
    with pytest.raises(EngineFailure, match="theta0_rad"):
        run(beyond)


def test_a_limit_that_is_passed_after_the_fall_changes_no_answer() -> None:
    """The falling statue slides on its support after the point of no return; with too little friction it slides before."""
    slow = Harmonic(0.429 * GRAVITY_M_S2, 1.0)
    late, soon = (run(replace(scene(PAESTUM, slow, mu_statue=mu), duration_s=6.0)) for mu in (1.0, 0.4))
    for fell, severity in ((late, Severity.INFO), (soon, Severity.CHANGES_ANSWER)):
        assert (fell.no_return_time_s < fell.validity["left_domain_s"]) is (severity is Severity.INFO)
        assert {found.severity for found in fell.findings if found.code == "left_domain"} == {severity}
