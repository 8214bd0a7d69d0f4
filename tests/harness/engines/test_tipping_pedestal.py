"""A pedestal that tips about its edge: its centroid moves, what it stands on does not, and the statue rides on its top."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import analytic
from analytic import Harmonic, Pulse
from harness import Outcome, RunOptions
from harness.accuracy.horizon import unseen_tipping_s
from harness.accuracy.refinement import run_to_accuracy
from harness.comparison.scores import error_rad
from harness.engines.stepping.trajectory import STANDS_RAD, base_velocity
from harness.model import BaseExcitation, Pedestal, support_m
from tests import budgets_engines as budget
from tests.doubles import codes
from tests.engines_for_tests import apart, bullet, ready, run
from tests.measures.seeded_scenes import tipping_scene, wide_scene
from tests.scenes_for_tests import GRAVITY_M_S2, paestum, rectangle, scene

HALF_M = (0.4, 0.3, 0.6)


@pytest.mark.parametrize("tilt_rad", [0.0, 1e-6, 1e-3, -0.2, 0.7])
@pytest.mark.parametrize("turn_rad", [0.0, 0.8, 3.0])
def test_the_edge_about_which_a_pedestal_tips_does_not_slip(tilt_rad: float, turn_rad: float) -> None:
    """Its centroid moves by the rate times its height over the edge; a slip of the whole is told as it is."""
    rotation = Rotation.from_euler("ZY", [turn_rad, tilt_rad])
    edge = np.array([math.copysign(HALF_M[0], tilt_rad) if abs(tilt_rad) > STANDS_RAD else 0.0, 0.0, -HALF_M[2]])
    rate = 1.3 * rotation.apply([0.0, 1.0, 0.0])
    slip = np.array([0.2, -0.1, 0.0])
    velocity = slip - np.cross(rate, rotation.apply(edge))
    row = (*np.zeros(16), *rotation.as_quat(), *velocity, *rate)
    assert base_velocity(HALF_M, row, row) == pytest.approx(slip[:2])


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_a_pedestal_that_tips_does_not_slide(name: str) -> None:
    """Holding it as it tips needs more than kinetic friction: taken to slide, as its centroid moves, it is 3.9e-3 rad off."""
    scene = replace(wide_scene(772183), duration_s=0.7)
    located, plain = (
        # Of a pedestal that tips 200 iterations leave 1.6e-3 rad.
        run(kind, scene, 1e-4, **changes)
        for kind, changes in ((name, {}), (name + ":plain", {"iterations": 1000}))
    )
    assert located.validity["pedestal_tilt_rad"] > 0.05
    assert error_rad(located, plain, 0.7) <= budget.TIPPING_ALIKE_RAD


@pytest.mark.parametrize("name", ["pymunk", "pybullet", "pymunk:plain"])
def test_a_statue_that_stands_on_a_pedestal_that_tips_neither_slides_nor_sinks_in(name: str) -> None:
    validity = run(name, tipping_scene(765_005)).validity
    assert validity["pedestal_tilt_rad"] > 0.05
    assert validity["plain_because"] == ["pedestal_tips"]
    assert max(validity["statue_slip_m"], validity["statue_flight_m"], validity["penetration_m"]) <= budget.ON_TOP_M


def test_a_statue_that_falls_beside_its_pedestal_is_not_in_it() -> None:
    found = run("pymunk", wide_scene(772183), 1e-3)
    assert found.outcome.overturned
    assert found.validity["penetration_m"] <= budget.ON_TOP_M


@pytest.mark.parametrize("name", ["pymunk", "pybullet", "pymunk:plain", "pybullet:plain"])
def test_a_pedestal_that_only_tips_has_not_slipped(name: str) -> None:
    """Its centroid moves by 0.2 m over the edge on which it stands, which friction holds."""
    narrow = Pedestal(100.0, 0.3, 0.5, 0.6)
    on = scene(rectangle(0.25, 1.0), Harmonic(0.6 * GRAVITY_M_S2, 2.0), pedestal=narrow, mu=1.0, mu_statue=2.0)
    found = run(name, on, 5e-4)
    tilt_rad = found.history.extra["pedestal_tilt_rad"]
    assert np.max(np.abs(tilt_rad)) > 0.05
    assert found.peak_slip_m <= budget.ON_TOP_M
    moved_m = support_m(narrow, found.history.slip_m, found.history.extra)
    assert np.max(np.abs(moved_m)) > 0.9 * narrow.height_m * np.sin(np.max(np.abs(tilt_rad)))


def test_the_friction_that_a_statue_needs_is_read_along_its_pedestals_tilted_top() -> None:
    """With a little more than is needed it stays, with a little less it slides, at its own coefficient."""
    narrow = Pedestal(100.0, 0.3, 0.5, 0.6)

    def validity(mu_statue: float) -> dict[str, float]:
        motion = Harmonic(0.6 * GRAVITY_M_S2, 2.0)
        on = scene(rectangle(0.25, 1.0), motion, pedestal=narrow, mu=1.0, mu_statue=mu_statue, duration_s=1.0)
        return dict(run("pybullet", on, 5e-4).validity)

    needed = validity(2.0)["statue_friction_needed"]
    assert validity(1.03 * needed)["statue_slip_m"] <= budget.ON_TOP_M
    sliding = validity(0.95 * needed)
    assert sliding["statue_slip_m"] > 10.0 * budget.ON_TOP_M
    assert sliding["statue_friction_needed"] == pytest.approx(0.95 * needed, rel=1e-3)


@pytest.mark.parametrize("seed", [0, 2, 4, 5])
def test_nothing_is_located_while_the_pedestal_tips(seed: int) -> None:
    """From rest both bodies tip as one: events located in it shifted these by 3e-3 to 6e-2 rad at 1 ms."""
    located, plain = (bullet(tipping_scene(seed), 1e-3, events=events) for events in (True, False))
    assert plain.validity["pedestal_tilt_rad"] > budget.TIPS_RAD
    assert apart(located, plain) <= budget.TIPPING_RAD
    assert 0.0 < located.validity["plain_from_s"] < located.end_s
    assert 0.0 < located.validity["plain_for_s"] <= located.end_s - located.validity["plain_from_s"]


def test_a_pedestal_that_stands_is_never_left_to_plain_steps() -> None:
    validity = bullet(paestum(0.334, 3.0), 1e-3).validity
    assert (validity["plain_from_s"], validity["plain_for_s"]) == (None, 0.0)


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_a_tipping_that_no_step_resolves_ends_what_is_stated(name: str) -> None:
    """Statue and tall pedestal rock as one body, by Housner to 3e-3 rad; levels that all hold it agree on nothing but that."""
    tall = tipping_scene(840_001)
    engine, statue, pedestal, motion = ready(name), tall.statue, tall.pedestal, tall.base_excitation.x
    assert isinstance(motion, Harmonic)
    mass = statue.mass_kg + pedestal.mass_kg
    share, up_m = statue.mass_kg / mass, pedestal.height_m + statue.centroid_height_m
    x_m, z_m = -share * statue.base_centre_m, share * up_m + (1.0 - share) * 0.5 * pedestal.height_m
    own = pedestal.mass_kg * (pedestal.width_m**2 + pedestal.height_m**2) / 12.0 + statue.inertia_kg_m2
    apart_m2 = (statue.base_centre_m) ** 2 + (up_m - 0.5 * pedestal.height_m) ** 2
    inertia = own + mass * share * (1.0 - share) * apart_m2
    half_m = 0.5 * pedestal.width_m
    block = analytic.Block(mass, z_m, inertia, ((-half_m - x_m, 0.0), (half_m - x_m, 0.0)))
    together = analytic.simulate(block, motion, duration_s=tall.duration_s)
    found = run_to_accuracy(engine, tall, 1e-3, RunOptions())
    # It rocks by more than what the run states, and than ten times what the run sees of it.
    least_rad = max(2.0 * found.numerical_uncertainty_rad, 10.0 * found.validity["pedestal_tilt_rad"])
    assert together.peak_theta_rad > least_rad
    assert found.reliable_until_s == pytest.approx(together.uplift_times_s[0], abs=budget.TIPS_S)
    assert "tipping_not_resolved" in codes(found.findings)
    # What a fall takes along at its end was not seen to tip before.
    history = found.history
    tilt_rad = np.where(history.t_s > 1.0, 0.1, history.extra["pedestal_tilt_rad"])
    tipped = replace(history, extra={**history.extra, "pedestal_tilt_rad": tilt_rad})
    falls = replace(found, history=tipped, no_return_time_s=1.0, validity={**found.validity, "pedestal_tilt_rad": 0.1})
    expected_rad = found.settings["expected_error_rad"]
    assert unseen_tipping_s(tall, falls, expected_rad) == unseen_tipping_s(tall, found, expected_rad)
    assert unseen_tipping_s(tall, replace(falls, no_return_time_s=None), expected_rad) == math.inf


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
@pytest.mark.parametrize(
    ("duration_s", "outcome"), [(1.2, Outcome.UNDECIDED), (1.5, Outcome.UNDECIDED), (3.0, Outcome.OVERTURNED_RIGHT)]
)
def test_a_bust_on_a_column_that_tips_over_is_not_said_to_stand(name: str, duration_s: float, outcome: Outcome) -> None:
    """Both balance as one body at 0.226 rad, the bust alone at 0.59: at first their energy is enough, then they are past it."""
    bust, column = rectangle(0.4, 0.6, mass_kg=80.0, depth_m=0.4), Pedestal(150.0, 0.42, 0.42, 1.2)
    given = scene(bust, pedestal=column, mu=(0.8, 0.7), mu_statue=0.8, duration_s=duration_s)
    shaken = replace(given, base_excitation=BaseExcitation(x=Pulse("one_sine", 0.32 * GRAVITY_M_S2, 0.8)))
    found = run(name, shaken, 5e-4)
    assert found.outcome is outcome
    balance_rad = math.atan(0.21 * 230.0 / (150.0 * 0.6 + 80.0 * 1.5))
    assert found.validity["pedestal_tilt_share"] == pytest.approx(found.validity["pedestal_tilt_rad"] / balance_rad)


def test_a_fall_with_the_pedestal_has_no_return_from_the_balance_of_both() -> None:
    """As one body they balance at 0.16 rad, which they pass a second before the statue's own 0.52 rad."""
    squat, slender = rectangle(0.34, 0.6, mass_kg=200.0), Pedestal(150.0, 0.36, 0.5, 1.2)
    push = Pulse("one_sine", 0.6 * GRAVITY_M_S2, 0.8)
    on = scene(squat, push, pedestal=slender, mu=0.8, mu_statue=0.8, duration_s=3.0)
    found = run("pymunk", on, 2e-3)
    assert found.outcome is Outcome.OVERTURNED_LEFT
    height_m = (200.0 * 1.5 + 150.0 * 0.6) / 350.0
    tilt_rad = np.abs(found.history.extra["pedestal_tilt_rad"])
    assert tilt_rad[found.history.t_s >= found.no_return_time_s].min() == pytest.approx(
        math.atan(0.18 / height_m), rel=1e-2
    )
