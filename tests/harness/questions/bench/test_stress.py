"""The stress run: checks that fail when they must, cells whose category follows from numbers, scenes that come out."""

import itertools
import math
from dataclasses import replace
from typing import Any, Final

import numpy as np
import pytest

from harness import History, Outcome, Run, RunOptions, Scene, engines
from harness.engines.base import Settings
from harness.questions.bench import stress_run
from harness.questions.bench.standard_scenes import COLUMN, PAESTUM, PEDESTAL, harmonic, scene_of
from harness.questions.bench.stress_run import catalogue, converged, leaning
from harness.records.bench import HardRow, Measure, PartRow, StabilityCell, StressRecord, findings_of
from tests import doubles
from tests.measures import invariance_checks as invariance
from tests.scenes_for_tests import paestum

QUICK = ("released 1e-6 rad below balance", "released 1e-3 rad beyond balance", "0.01 m high", "100 m high",
         "floor falls at 1 g: the two-block model", "floor falls at 1 g: the engines", "height to width 50",
         "pedestal 1000 times the statue's mass", "floor friction 0", "floor friction 5", "5 g at 100 Hz")  # fmt: skip


@pytest.fixture(scope="module")
def scene() -> Scene:
    return scene_of("free", leaning(COLUMN, 0.5, 0.6))


@pytest.fixture(scope="module")
def exact(scene: Scene) -> Run:
    engine = engines.load("analytic")
    return engine.simulate(scene, engine.refinement_levels(scene)[-1], RunOptions())


@pytest.mark.parametrize("name", QUICK)
def test_hard_scenes_come_out(name: str) -> None:
    hard = next(item for item in catalogue() if item.name == name)
    found = stress_run.row_of(hard)
    assert found.holds, found.got


def test_names_of_hard_scenes_are_their_own() -> None:
    names = [item.name for item in catalogue()]
    assert len(set(names)) == len(names)


def test_every_hard_scene_is_held_to_the_exact_solution_or_to_rest() -> None:
    loose = {hard.name for hard in catalogue() if not hard.exact and stress_run.creep not in hard.checks}
    assert loose == {"floor falls at 1 g: the two-block model", "floor falls at 1 g: the engines"}, (
        "only where the two-block model ends is there no exact solution"
    )


def test_a_hard_scene_with_another_outcome_or_another_motion_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    hard = next(item for item in catalogue() if item.name == "height to width 50")
    assert stress_run.row_of(hard).holds
    assert not stress_run.row_of(replace(hard, wanted="overturned_left")).holds
    whole = stress_run.simulate

    def unmoved(*given: Any) -> Run:
        run = whole(*given)
        h = run.history
        return replace(run, history=replace(h, theta_rad=0.0 * h.theta_rad))

    monkeypatch.setattr(stress_run, "simulate", unmoved)
    found = stress_run.row_of(hard)
    assert not found.holds
    for measured in found.checks.values():
        (error,) = (each for each in measured if each.check == "error_rad")
        assert (error.value, error.allowed) == (pytest.approx(1e-2, rel=0.1), pytest.approx(5e-4, rel=0.1))


def test_a_known_failure_is_told_with_what_avoids_it_and_an_unknown_one_fails(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hard = next(item for item in catalogue() if item.name.startswith("pedestal 0.001"))
    hard = replace(hard, engines=("pymunk",))
    found = stress_run.row_of(hard)
    assert found.holds, found.got
    assert found.known["pymunk"].iterations == 3000
    assert stress_run.all_hold(found.known["pymunk"].checks)
    assert not stress_run.row_of(replace(hard, converged_s=None)).holds
    monkeypatch.setattr(stress_run, "converged", lambda settings: settings)
    still_wrong = stress_run.row_of(hard)
    assert not still_wrong.holds, "what fails with more iterations too is not known to be theirs"
    assert "energy_gained_j" in {each.check for each in still_wrong.checks["pymunk"] if not each.holds}


def test_so_many_iterations_reach_every_engine() -> None:
    for name in ("pymunk", "pybullet"):
        settings = engines.load(name).settings_for_dt(scene_of("any", leaning(COLUMN, 0.5, 1.0)), 1e-3)
        many = converged(settings)
        assert many.dt_s == settings.dt_s
        assert many.as_dict()["iterations"] >= 3 * settings.as_dict()["iterations"]
    with pytest.raises(ValueError, match="no iterations"):
        converged(Settings(1e-3, 1e-3))


holds = stress_run.all_hold


def test_checks_fail_when_they_must(scene: Scene, exact: Run) -> None:
    assert all(holds(check(scene, exact)) for check in stress_run.BASIC)
    assert not holds(stress_run.finite(scene, replace(exact, peak_theta_rad=float("nan"))))
    gained = replace(exact, validity={"energy_gained_j": 0.05 * stress_run.barrier_j(scene)})
    assert not holds(stress_run.energy(scene, gained))
    assert not holds(stress_run.depth(scene, replace(exact, validity={"penetration_m": 1e-3})))
    assert not holds(stress_run.creep(scene, exact)), "a rocking statue is not at rest"
    assert not holds(stress_run.ends_at_rest(scene, exact))
    assert not holds(stress_run.upright(scene, exact))


@pytest.mark.parametrize(("share", "right"), [(0.04, True), (0.06, False)])
def test_an_error_is_held_to_a_share_of_the_peak(share: float, right: bool) -> None:
    small = scene_of("small", leaning(COLUMN, 0.05, 0.6))
    exact = stress_run.solution(small)
    h = exact.history
    off = replace(h, theta_rad=h.theta_rad + share * exact.peak_theta_rad)
    assert stress_run.allowed_rad(exact) == pytest.approx(0.05 * exact.peak_theta_rad)
    assert stress_run.all_hold(stress_run.agrees(small, replace(exact, history=off), exact)) is right


@pytest.mark.parametrize(("off_rad", "right"), [(9e-4, True), (1.1e-3, False)])
def test_no_error_beyond_a_milliradian_is_allowed(scene: Scene, exact: Run, off_rad: float, right: bool) -> None:
    h = exact.history
    assert stress_run.AGREES_SHARE * exact.peak_theta_rad > 2e-3
    off = replace(h, theta_rad=h.theta_rad + off_rad)
    assert stress_run.all_hold(stress_run.agrees(scene, replace(exact, history=off), exact)) is right


def test_a_slip_that_is_not_the_exact_one_is_seen() -> None:
    slides = {"floor_static": 0.0, "floor_kinetic": 0.0}
    sliding = scene_of("s", {"duration_s": 0.4, "statue": PAESTUM, "pedestal": PEDESTAL, "contact": slides,
                             "motion": harmonic(0.429, 3.0)})  # fmt: skip
    exact = stress_run.solution(sliding)
    h = exact.history
    assert exact.peak_slip_m > 0.01
    assert holds(stress_run.agrees(sliding, exact, exact))
    held = replace(h, slip_m=0.9 * h.slip_m)
    assert not holds(stress_run.agrees(sliding, replace(exact, history=held), exact))


def test_an_error_counts_as_long_as_the_two_block_model_holds(scene: Scene, exact: Run) -> None:
    left = replace(exact, validity={**exact.validity, "left_domain_s": 0.2})
    h = exact.history
    late = replace(h, theta_rad=h.theta_rad + 0.1 * (h.t_s > 0.3))
    assert not holds(stress_run.agrees(scene, replace(exact, history=late), exact))
    (found,) = stress_run.agrees(scene, replace(exact, history=late), left)
    assert found.holds
    assert found.until_s == 0.2


def test_energy_from_out_of_the_plane_is_told_from_energy_of_contacts(scene: Scene, exact: Run) -> None:
    h = exact.history
    zero = np.zeros_like(h.t_s)
    gained = {"energy_gained_j": 0.05 * stress_run.barrier_j(scene)}
    turning = {"yaw_rad": 2.0 * h.t_s, "roll_rad": zero, "statue_y_m": zero}
    for extra, right in (({**turning, "yaw_rad": zero}, False), (turning, True)):
        history = replace(h, extra=extra)
        (found,) = stress_run.energy(scene, replace(exact, validity=gained, history=history))
        assert found.holds is right
    yaw_inertia = scene.statue.inertia_tensor_kg_m2[2, 2]
    assert stress_run.beyond_plane_j(scene, replace(exact, history=history)) == pytest.approx(2.0 * yaw_inertia)


def still(drift_rad: float) -> History:
    t = np.linspace(0.0, 10.0, 1001)
    zero = np.zeros_like(t)
    return History(t, drift_rad * t / 10.0 + 1e-6 * np.sin(50.0 * t), zero, zero, zero)


def test_creep_is_told_from_trembling(scene: Scene, exact: Run) -> None:
    assert holds(stress_run.creep(scene, replace(exact, history=still(1e-7), end_s=10.0)))
    assert not holds(stress_run.creep(scene, replace(exact, history=still(1e-5), end_s=10.0)))
    calm = still(0.0)
    zero = np.zeros_like(calm.t_s)
    slides = History(calm.t_s, calm.theta_rad, zero, 1e-5 * calm.t_s / 10.0, zero)
    assert not holds(stress_run.creep(scene, replace(exact, history=slides, end_s=10.0)))
    trembling = History(calm.t_s, 1e-3 * np.sin(50.0 * calm.t_s), zero, zero, zero)
    assert not holds(stress_run.creep(scene, replace(exact, history=trembling, end_s=10.0))), "it trembles too much"
    short = replace(exact, history=still(5e-7), end_s=10.0)
    assert holds(stress_run.creep(scene, short))
    assert not holds(stress_run.creep(scene, short, share=0.1)), "a tenth of the time may drift by a tenth"


def test_a_cell_is_judged_by_its_numbers(scene: Scene, exact: Run) -> None:
    def judged(run: Run, truth: Run = exact, at_rest: bool = False) -> StabilityCell:
        row = stress_run.Difficulty("hard", {}, at_rest=at_rest)
        return stress_run.judge(StabilityCell("pymunk", "1 ms", row.name, ""), scene, run, truth, row)

    h = exact.history
    assert judged(exact).category == "stable"
    wrong = replace(h, theta_rad=1.1 * h.theta_rad)
    assert judged(replace(exact, history=wrong)).category == "inaccurate"
    gained = replace(exact, validity={"energy_gained_j": stress_run.barrier_j(scene)})
    assert judged(gained).category == "drifting"
    sunk = replace(exact, validity={"penetration_m": 0.01})
    assert judged(sunk).category == "drifting"
    drifting = replace(exact, history=still(1e-5), end_s=10.0)
    assert judged(drifting, drifting, at_rest=True).category == "drifting"
    crashed = replace(exact, outcome=Outcome.CRASHED, history=None, message="died")
    found = judged(crashed)
    assert (found.category, found.evidence, found.message) == ("diverged", (), "died")


def cell(setting: str, category: str, **more: Any) -> StabilityCell:
    return StabilityCell("pymunk", setting, "hard", category, [Measure("error_rad", True, 1e-4, 1e-3)], **more)


def why(*row: StabilityCell, converged: StabilityCell | None = None) -> list[tuple[str | None, str]]:
    return [(item.remedy, item.stable) for item in stress_run.explained(row, lambda: converged)]


NOT: Final = (None, "")
"""Nothing explains a cell."""


def test_only_a_finer_stable_whole_run_explains_by_the_step() -> None:
    wrong, stable = cell("a", "inaccurate"), cell("b", "stable")
    assert why(wrong, stable) == [("step", "b"), NOT]
    assert why(stable, wrong) == [NOT, NOT], "a coarser step explains nothing"
    assert why(wrong, cell("b", "inaccurate")) == [NOT, NOT]
    assert why(cell("a", "drifting"), cell("b", "stable", short=True)) == [NOT, NOT], (
        "it says nothing of what came later"
    )
    assert why(stable, cell("b", "diverged")) == [NOT, NOT]


def test_more_iterations_explain_what_no_step_does_and_stand_in_the_row() -> None:
    wrong = cell("a", "inaccurate")
    told = why(wrong, cell("b", "drifting"), converged=cell("many", "stable"))
    assert told == [("iterations", "many"), ("iterations", "many"), NOT]
    assert why(wrong, converged=cell("many", "inaccurate")) == [NOT, NOT]
    never_asked = why(wrong, cell("b", "stable"), converged=cell("many", "stable"))
    assert never_asked == [("step", "b"), NOT], "not computed where a step is stable"


ASKED = (
    invariance._mirrored,
    invariance._permuted,
    invariance._perturbed,
    invariance._refined,
    invariance._touched,
)


@pytest.mark.parametrize("question", ASKED)
def test_hard_questions(question: Any) -> None:
    found = question()
    assert found.holds, found.got


def offset(run: Run, off_rad: float) -> Run:
    h = run.history
    return replace(run, history=replace(h, theta_rad=h.theta_rad + off_rad))


SPOILT = (
    (invariance._mirrored, 0.0, 1e-4), (invariance._perturbed, 1e-3, 0.0),
    (invariance._refined, 0.0, 1e-6), (invariance._touched, 0.0, 2e-3),
)  # fmt: skip
"""Questions, and the least rotation, rad, growing from run to run or the same in all, with which they must not hold."""


@pytest.mark.parametrize(("question", "growing_rad", "same_rad"), SPOILT)
def test_a_question_sees_what_it_asks_for(
    monkeypatch: pytest.MonkeyPatch, question: Any, growing_rad: float, same_rad: float
) -> None:
    whole, count = invariance._run, itertools.count()
    monkeypatch.setattr(invariance, "_run", lambda *given: offset(whole(*given), next(count) * growing_rad + same_rad))
    assert not question().holds


def test_a_start_that_is_not_heard_is_no_small_growth(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = invariance._run
    start = scene_of("start", leaning(COLUMN, 0.5, 2.0))
    monkeypatch.setattr(invariance, "_run", lambda engine, *given: whole(engine, start))
    assert not invariance._perturbed().holds


def test_two_sides_of_a_touch_must_differ_by_one_impact(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(invariance, "TOUCH_EARLY_S", 0.0)
    found = invariance._touched()
    assert not found.holds
    assert [each.case for each in found.checks["analytic"] if not each.holds] == ["touched"], "both touch"


def test_other_bodies_orders_and_distances_are_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(invariance, "PERMUTED_RAD", 1e-12)
    assert not invariance._permuted().holds, "an order that changes no bit was not another order"
    monkeypatch.setattr(invariance, "HULLS", (8, 200))
    monkeypatch.setattr(invariance, "HULL_RAD", 1e-12)
    assert not invariance._hulls().holds
    monkeypatch.setattr(invariance, "FAR_S", 2.0)
    assert invariance._far().holds
    whole = invariance._run
    monkeypatch.setattr(invariance, "_run", lambda *given: offset(whole(*given), 2e-3))
    assert not invariance._far().holds


def test_what_does_not_hold_is_told_and_fails() -> None:
    wrong = HardRow("n", "stands", {"pymunk": "overturned_left"}, holds=False)
    done = PartRow("maps", 1.0, 3, ())
    whole = StressRecord(
        scenes=[replace(wrong, holds=True)], cells=[cell("a", "stable")], parts=[done], seconds=1.0, versions={},
        machine={},
    )  # fmt: skip
    assert whole.holds
    assert not replace(whole, parts=[replace(done, left=["pybullet: at rest"])]).holds, "what is not done does not hold"
    for spoilt in (
        replace(whole, scenes=[wrong]),
        replace(whole, cells=[cell("a", "diverged")]),
    ):
        assert not spoilt.holds
        told = {each.code: each.values for each in findings_of(spoilt)}
        assert told.keys() & {"hard_scene_wrong", "cell_unexplained"}
    late = replace(wrong, got={"pymunk": "stands"}, checks={"pymunk": [Measure("creep_rad", False, 2e-6, 1e-6)]})
    (found,) = (each for each in findings_of(replace(whole, scenes=[late])) if each.code == "hard_check_fails")
    assert (found.engine, found.values["check"], found.values["value"]) == ("pymunk", "creep_rad", 2e-6)
    told = {each.code: each.values for each in findings_of(replace(whole, absent={"pybullet": "no wheel"}))}
    assert told["not_measured"] == {"what": "pybullet", "reason": "no wheel"}


def test_a_fall_exchanges_what_its_own_corner_lets_it_fall() -> None:
    """An unsymmetric block lies lower on one side; runs state the size of their largest rotation, not its side."""
    given = paestum(0.4, 2.0)
    for outcome, side in ((Outcome.OVERTURNED_LEFT, -1), (Outcome.OVERTURNED_RIGHT, 1)):
        fallen = stress_run.exchanged_j(
            given, doubles.run_of(None, outcome=outcome, peak_theta_rad=1.5)
        ) - stress_run.barrier_j(given)
        corner, height = given.statue.corner_m(side), given.statue.centroid_height_m
        arm, alpha = math.hypot(corner, height), math.atan2(corner, height)
        assert fallen == pytest.approx(given.statue.mass_kg * given.gravity_m_s2 * arm * (1.0 - math.cos(1.5 - alpha)))
