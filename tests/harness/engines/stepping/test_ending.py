"""One rule for the end of a run: over still ground what follows the last instant is the same for the model and every engine."""

from dataclasses import replace
from typing import Any

import pytest

from analytic.excitation import Pulse
from harness import Outcome
from harness.model import Initial, Pedestal, Scene, Wall
from tests import budgets_engines as budget
from tests.engines_for_tests import run
from tests.scenes_for_tests import paestum, rectangle, scene

PUSH = Pulse("one_sine", 4.5, 0.9)
ON = Pedestal(200.0, 0.24, 0.6, 0.2)
STEP_S = 5e-4
ENGINES = ["pymunk", "pybullet", "pymunk:plain", "pybullet:plain", "spatial"]
OVER_THE_HILL: dict[str, Any] = {"theta_rate_rad_s": 1.2}
"""A block of 0.2 × 1 m needs 0.70 rad/s to pass its balance point."""
ENDS: dict[str, tuple[dict[str, Any], Outcome]] = {
    "over its base, above the hill": (OVER_THE_HILL, Outcome.OVERTURNED_RIGHT),
    "over its base, below the hill": ({"theta_rate_rad_s": -0.5}, Outcome.STANDS),
    "beyond its balance, below the hill and moving inwards": (
        {"theta_rad": -0.3, "theta_rate_rad_s": 0.1}, Outcome.OVERTURNED_LEFT
    ),
    "beyond its balance, coming over the hill": ({"theta_rad": 0.25, "theta_rate_rad_s": -0.25}, Outcome.STANDS),
    "on a pedestal that holds": (OVER_THE_HILL | {"pedestal": ON, "mu": 0.5}, Outcome.OVERTURNED_RIGHT),
    "on a pedestal that slides, over the base": (OVER_THE_HILL | {"pedestal": ON, "mu": 0.01}, Outcome.STANDS),
    "on a pedestal that slides, beyond its balance": (
        {"theta_rad": 0.25, "theta_rate_rad_s": 0.1, "pedestal": ON, "mu": 0.01}, Outcome.UNDECIDED
    ),
    "with a wall before the hill": (
        OVER_THE_HILL | {"wall": Wall("right", 0.15), "pedestal": ON, "mu": 0.5}, Outcome.TOUCHES_WALL
    ),
}  # fmt: skip


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("name", ENGINES)
def test_a_run_ends_by_the_models_rule(name: str, end: str) -> None:
    given, outcome = ENDS[end]
    on = scene(rectangle(0.2, 1.0), mu_statue=3.0, duration_s=0.05, **given)
    model = run("analytic", on)
    assert model.outcome is outcome
    if name != "spatial" or on.pedestal is None:
        found = run(name, on, STEP_S)
        assert found.outcome is outcome
        assert found.peak_theta_rad == pytest.approx(model.peak_theta_rad, abs=budget.LAST_STATE_RAD)


@pytest.mark.parametrize("name", ["pymunk", "pybullet", "pymunk:plain", "pybullet:plain"])
def test_a_run_ends_at_the_wall(name: str) -> None:
    """What follows the touch is the wall's impact, which no model here knows: it is neither computed nor told."""
    for on in (
        replace(paestum(0.429, 2.0, pedestal=False, duration_s=8.0), wall=Wall("right", 0.2)),
        replace(paestum(0.5, 1.5, mu=(0.20, 0.15), duration_s=8.0), wall=Wall("left", 0.12)),
    ):
        model, found = run("analytic", on), run(name, on, STEP_S)
        assert model.outcome is found.outcome is Outcome.TOUCHES_WALL
        assert found.end_s == pytest.approx(model.end_s, abs=budget.WALL_S)
        assert found.history.t_s[-1] == found.end_s
        # Its last sample is of the way to the wall, not of what the wall did.
        assert found.history.theta_rad[-1] == pytest.approx(model.history.theta_rad[-1], abs=budget.WALL_RAD)
        assert found.history.slip_m[-1] == pytest.approx(model.history.slip_m[-1], abs=budget.WALL_M)
        assert found.steps < 0.5 * on.duration_s / STEP_S


def test_while_the_floor_still_moves_nothing_is_foretold() -> None:
    on = scene(rectangle(0.2, 1.0), duration_s=0.05, **OVER_THE_HILL)
    shaken = replace(on, base_excitation=replace(on.base_excitation, x=PUSH))
    assert {run(name, shaken, STEP_S).outcome for name in ("analytic", "pymunk")} == {Outcome.STANDS}


SLIDES = replace(scene(
    rectangle(0.3, 1.0), PUSH, pedestal=Pedestal(20.0, 0.6, 0.6, 0.05), mu=0.05, mu_statue=3.0, duration_s=0.5
), wall=Wall("left", 0.25))  # fmt: skip
TIPS = replace(paestum(0.429, 2.0, mu=0.03, duration_s=0.3), initial=Initial(0.0, -1.0), wall=Wall("left", 0.15))


@pytest.mark.parametrize("name", ENGINES[:4])
@pytest.mark.parametrize(("on", "room_m"), [(SLIDES, 0.1), (TIPS, 0.06335)])
def test_a_wall_is_touched_when_the_model_says_with_what_slip_adds(name: str, on: Scene, room_m: float) -> None:
    model, found = run("analytic", on), run(name, on, STEP_S)
    assert model.outcome is found.outcome is Outcome.TOUCHES_WALL
    assert model.validity["wall_touch_time_s"] == model.end_s
    assert -room_m <= model.residual_slip_m * (1.0 - 1e-12)
    # Of two pedestals one touches itself, the other one's statue does before.
    assert (model.residual_slip_m > -0.99 * room_m) is (on is TIPS)
    touch_s = budget.PLAIN_TOUCH_S if name.endswith("plain") else budget.TOUCH_S
    assert found.validity["wall_touch_time_s"] == pytest.approx(model.end_s, abs=touch_s)
