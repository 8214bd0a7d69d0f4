"""The horizon of prediction, on a model whose sensitivity is known in closed form."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from analytic.excitation import Harmonic
from harness import History, Outcome, Run, Scene, engines
from harness.accuracy import horizon as horizon_room
from harness.accuracy.horizon import horizon, horizon_of, parted_s, perturbed
from harness.engines.base import EngineFailure
from tests import doubles
from tests.scenes_for_tests import PAESTUM, paestum, scene

GROWTH = 3.0
TOLERANCE = 0.01


@dataclass
class Unstable:
    """A model whose rotation is its start times e^{3t}, and 0.05 sin t times its motion's strength; it counts its runs."""

    runs: int = 0

    def __call__(self, each: Scene) -> Run:
        self.runs += 1
        t = np.linspace(0.0, 10.0, 10001)
        strength = each.base_excitation.x.peak_m_s2
        theta = (each.initial.theta_rad + 1e-2 * (strength - 1.0)) * np.exp(GROWTH * t)
        if each.initial.theta_rate_rad_s > 1e-4:
            raise EngineFailure("thrown too hard")
        rate = GROWTH * theta
        fell = Outcome.OVERTURNED_RIGHT if theta[-1] > 1.5 else Outcome.STANDS
        return doubles.run_of(History(t, theta, rate, 0 * t, 0 * t), outcome=fell)


SCENE = scene(PAESTUM, Harmonic(1.0, 1.0), duration_s=10.0)


def test_the_horizon_is_where_the_growth_reaches_the_tolerance() -> None:
    """δ e^{3t} = tolerance at ln(tolerance/δ)/3; the rate's variant leaves the rotation alone, the motion's is smaller."""
    model = Unstable()
    found = horizon(SCENE, model, tolerance_rad=TOLERANCE)
    assert found.until_s == pytest.approx(
        [math.log(TOLERANCE / size) / GROWTH for size in found.perturbations], rel=1e-6
    )
    assert found.growth_per_s == pytest.approx(GROWTH, rel=1e-6)
    assert model.runs == 1 + 4 * len(found.perturbations)
    assert found.failed == 1  # the rate perturbed by 1e-3 p
    assert found.outcomes == ("overturned_right", "stands")


def test_the_horizon_is_read_between_its_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    model, given = engines.load("analytic"), replace(paestum(0.429, 3.0), duration_s=5.0)
    coarse = horizon_of(model, given, model.refinement_levels(given)[-1])
    monkeypatch.setattr(horizon_room, "SAMPLED_S", 1e-3)
    fine = horizon_of(model, given, model.refinement_levels(given)[-1])
    assert 0.1 < coarse.until_s[-1] < given.duration_s
    assert coarse.until_s == pytest.approx(fine.until_s, abs=1e-4)


def test_the_least_change_that_ends_otherwise_is_told() -> None:
    """It was called the smallest of all, where only a motion stronger by a thousandth makes it fall."""

    def model(each: Scene) -> Run:
        falls = each.base_excitation.x.peak_m_s2 > 1.0005
        return doubles.run_of(doubles.rest(), outcome=Outcome.OVERTURNED_LEFT if falls else Outcome.STANDS)

    assert horizon(SCENE, model, tolerance_rad=TOLERANCE).outcome_from == 1e-3
    assert horizon(SCENE, Unstable(), tolerance_rad=TOLERANCE).outcome_from == 1e-9


def test_a_fall_that_the_scene_s_end_cuts_off_is_no_other_end() -> None:
    def model(each: Scene) -> Run:
        strength = each.base_excitation.x.peak_m_s2
        end = Outcome.STANDS if strength > 1.0005 else Outcome.UNDECIDED if strength > 1.0 else Outcome.OVERTURNED_LEFT
        return doubles.run_of(replace(doubles.rest(), t_s=np.linspace(0.0, 10.0, doubles.rest().t_s.size)), outcome=end)

    assert horizon(SCENE, model, tolerance_rad=TOLERANCE).outcome_from == 1e-3


def test_a_stable_model_is_predictable_to_the_end() -> None:
    found = horizon(SCENE, lambda each: doubles.run_of(doubles.rest()), tolerance_rad=TOLERANCE)
    assert set(found.until_s) == {SCENE.duration_s}
    assert found.growth_per_s is None
    assert found.outcomes == ("stands",)


def test_perturbations_touch_start_and_motion_by_their_size() -> None:
    lean, thrown, stronger, weaker = perturbed(SCENE, 1e-3)
    assert lean.initial.theta_rad == 1e-3
    assert thrown.initial.theta_rate_rad_s > 1e-3
    assert stronger.base_excitation.x.peak_m_s2 == pytest.approx(1.001)
    assert weaker.base_excitation.x.peak_m_s2 == pytest.approx(0.999)
    assert len(perturbed(scene(PAESTUM, theta_rad=-0.1), 1e-3)) == 2
    assert perturbed(scene(PAESTUM, theta_rad=-0.1), 1e-3)[0].initial.theta_rad == pytest.approx(-0.101)


@pytest.mark.parametrize("start", [{"theta_rad": 0.1}, {"theta_rate_rad_s": 0.2}])
def test_a_mirrored_start_is_perturbed_to_the_other_side(start: dict[str, float]) -> None:
    """One thrown to the left was lifted to the right: its impact at once took energy, and the horizon was that impact's."""
    block = replace(PAESTUM, corner_left_m=0.2, corner_right_m=0.2)
    starts = [scene(block, **{key: way * value for key, value in start.items()}) for way in (1.0, -1.0)]
    for right, left in zip(*(perturbed(each, 1e-3) for each in starts), strict=True):
        assert left.initial.theta_rad == -right.initial.theta_rad
        assert left.initial.theta_rate_rad_s == -right.initial.theta_rate_rad_s


def test_a_run_that_ends_earlier_parts_at_its_end() -> None:
    history = doubles.rocking()
    assert parted_s(history, history, TOLERANCE) is None
    assert parted_s(doubles.truncated(history, 4.0), history, TOLERANCE) == pytest.approx(4.0)
    assert parted_s(doubles.parted(history, 2.0, 0.01), history, TOLERANCE) == pytest.approx(3.0)


@pytest.mark.parametrize("outcome", [Outcome.FRICTION_PARADOX, Outcome.UNDECIDED])
def test_a_perturbed_run_that_finds_no_mode_or_is_given_up_says_nothing_of_the_horizon(outcome: Outcome) -> None:
    def model(each: Scene) -> Run:
        if each.initial.theta_rate_rad_s > 0.0:
            return doubles.run_of(doubles.truncated(doubles.rocking(), 0.1), outcome=outcome)
        return doubles.run_of(doubles.rocking())

    found = horizon(SCENE, model, tolerance_rad=TOLERANCE)
    assert found.failed == len(found.perturbations)
    assert set(found.until_s) == {SCENE.duration_s}


def test_an_unperturbed_run_without_history_is_a_failure() -> None:
    with pytest.raises(EngineFailure, match="no history"):
        horizon(SCENE, lambda each: doubles.run_of(None))


def test_each_model_s_own_horizon_enters_its_verdicts() -> None:
    """Asked for, the horizon of every model stands in the record, and the verdict holds no further than the nearer one."""
    from harness.questions.scene.scene_run import run_scene

    shaken = paestum(0.429, 3.0, mu=(0.20, 0.15), duration_s=2.0)
    found = run_scene(shaken, ["analytic", "pymunk"], dt_s=1e-3, horizon=True)
    assert set(found.horizons) == {"analytic", "pymunk"}
    nearer = min(each.intrinsic_s for each in found.horizons.values())
    scores = found.scores["analytic_vs_pymunk"]
    assert scores.evidence.horizon_s <= nearer
    for each in found.horizons.values():
        assert list(each.until_s) == sorted(each.until_s, reverse=True)
    assert found.record().horizons["analytic"].intrinsic_s == found.horizons["analytic"].intrinsic_s


def test_the_compiled_model_s_horizon_is_found_unasked() -> None:
    """It costs some twenty runs of milliseconds; with one answer alone there is nothing to compare and nothing is found."""
    from harness.questions.scene.scene_run import run_scene

    shaken = paestum(0.429, 3.0, mu=(0.20, 0.15), duration_s=2.0)
    found = run_scene(shaken, ["analytic", "pymunk"], dt_s=1e-3)
    assert set(found.horizons) == {"analytic"}
    scores = found.scores["analytic_vs_pymunk"]
    assert scores.horizon_s <= found.horizons["analytic"].intrinsic_s
    assert scores.compared_until_s <= scores.horizon_s
    assert run_scene(shaken, ["analytic"]).horizons == {}
