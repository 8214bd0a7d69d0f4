"Why a body in space leaves the planar model: said with the numbers of each thing taken away."

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from harness import Outcome, Run, Scene, Verdict, compare, load_scene, run_scene
from harness.questions.assess import probability
from harness.questions.assess.probability import space_draws
from harness.questions.scene import scene_run
from harness.questions.scene.scene_run import TAKEN_AWAY, TakenAway, explained, with_reasons
from tests.doubles import codes, raised, rest, run_of
from tests.reports.invented_run import invented_scores

pytest.importorskip("pybullet")


def test_the_shipped_pedestal_scene_differs_by_its_products_of_inertia(root: Path) -> None:
    scene = replace(load_scene(root / "scenes" / "paestum_pedestal.toml"), duration_s=1.5)
    pair = "analytic_vs_pybullet"
    differ = run_scene(scene, ("analytic", "pybullet"), accuracy_rad=2.5e-4).scores[pair]
    assert differ.verdict is Verdict.PLANE
    assert [each.values["cause"] for each in differ.findings if each.code == "plane_cause"] == ["products_of_inertia"]
    diagonal = np.diag(np.diag(scene.statue.inertia_tensor_kg_m2))
    without = replace(scene, statue=replace(scene.statue, inertia_tensor_kg_m2=diagonal))
    again = run_scene(without, ("analytic", "pybullet"), accuracy_rad=2.5e-4).scores[pair]
    assert "plane_cause" not in codes(again.findings)


def test_where_a_run_leaves_the_plane_the_exact_body_says_how_probable_a_fall_is(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a base askew to the shaking the planar model leans by 2°, the body in space past its balance; a few draws show it."""
    monkeypatch.setattr(probability, "space_draws", partial(space_draws, most_steps=50_000))
    motion = {"x": {"kind": "harmonic", "amplitude_g": 0.372, "frequency_hz": 3.41}}
    turned = {"statue.mesh.azimuth_deg": 156.3, "pedestal": "none", "duration_s": 2.8, "motion": motion}
    scene = load_scene(root / "scenes" / "paestum_pedestal.toml", turned)
    found = run_scene(scene, ("analytic", "pybullet"), assess=True)
    assert found.answer().code == "plane_left_out"
    planar, space = found.assessment["analytic"], found.assessment["spatial"]
    assert planar.plane_only
    assert planar.high < 0.1 < space.low
    alone = run_scene(scene, ("analytic",), assess=True)
    assert set(alone.assessment) == {"analytic"}


def test_what_a_scene_has_none_of_is_not_taken_away(root: Path) -> None:
    block = load_scene(root / "scenes" / "paestum_block.toml")
    assert [what for what, take in TAKEN_AWAY.items() if take(block) is not None] == []


@pytest.mark.parametrize(
    ("left_rad", "code", "whole"),
    [(0.001, "plane_cause", True), (0.003, "plane_cause", False), (0.01, "plane_several_causes", None)],
)
def test_a_cause_is_named_by_what_stays_without_it(
    left_rad: float, code: str, whole: bool | None, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    "0.02 rad apart, 0.0005 rad are their joint error; without the products of inertia so much is left."
    scene = load_scene(root / "scenes" / "paestum_pedestal.toml")
    plane = run_of(rest(1.0), "pymunk")
    space = run_of(raised(rest(1.0), 0.02), "pybullet")
    monkeypatch.setattr(scene_run, "_again", lambda *given: run_of(raised(rest(1.0), left_rad), "pybullet"))
    scores = invented_scores("pymunk", "pybullet")
    evidence = replace(scores.evidence, limit_rad=5e-4, differs_in="rotation")
    scores = replace(scores, verdict=Verdict.MODEL, evidence=evidence)
    runs, taken = {"pymunk": plane, "pybullet": space}, TakenAway(scene)
    judged = with_reasons(runs, {"pair": scores}, taken)["pair"]
    assert explained(runs, {"pair": scores}, taken) == (set() if left_rad > 0.005 else {"pair"})
    told = judged.findings[-1]
    assert (told.code, told.values.get("whole")) == (code, whole)
    assert told.values["share_without"]["products_of_inertia"] == pytest.approx(left_rad / 0.02, rel=1e-6)
    assert judged.verdict is (Verdict.MODEL if whole is None else Verdict.PLANE)


@pytest.mark.parametrize(
    ("left_rad", "known_s", "verdict", "code"),
    [
        (1e-4, 1.0, Verdict.PLANE, "plane_cause"),
        (0.004, 1.0, Verdict.PLANE, "plane_cause"),
        (0.006, 1.0, Verdict.MODEL, "plane_several_causes"),
        (0.01, 1.0, Verdict.MODEL, "plane_several_causes"),
        (1e-4, 0.2, Verdict.UNBOUNDED, "plane_several_causes"),
    ],
)
def test_models_differ_where_they_do_without_all_that_the_plane_leaves_out(
    left_rad: float, known_s: float, verdict: Verdict, code: str, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    "A single run at the same step leaves half of the difference, by its own error; one that states its error decides."
    stated = {"numerical_uncertainty_rad": 2.5e-4, "slip_uncertainty_m": 1e-4}
    scene, still = load_scene(root / "scenes" / "paestum_pedestal.toml"), rest(1.0)
    runs = {
        "pymunk": run_of(still, "pymunk", **stated),
        "pybullet": run_of(replace(still, theta_rad=0.02 * still.t_s), "pybullet", **stated),
    }
    asked = []

    def bounded(bare: Scene, engine: str, *, accuracy_rad: float) -> Run:
        asked.append((TAKEN_AWAY["products_of_inertia"](bare), engine, accuracy_rad, bare.duration_s))
        apart = replace(still, theta_rad=2.0 * left_rad * still.t_s)
        return run_of(apart, "pybullet", reliable_until_s=known_s, **stated)

    half = run_of(replace(still, theta_rad=0.01 * still.t_s), "pybullet")
    monkeypatch.setattr(scene_run, "_again", lambda *given: half)
    monkeypatch.setattr(scene_run, "simulate", bounded)
    scores = compare(runs["pymunk"], runs["pybullet"])
    limit_s = scores.evidence.limit_rad / 0.02
    evidence = replace(scores.evidence, limit_rad=20.0 * scores.evidence.limit_rad)
    taken = TakenAway(scene, 5e-4)
    judged = with_reasons(runs, {"pair": replace(scores, evidence=evidence)}, taken)["pair"]
    assert (judged.verdict, judged.findings[-1].code) == (verdict, code)
    assert explained(runs, {"pair": replace(scores, evidence=evidence)}, taken) == (
        set() if verdict is Verdict.MODEL else {"pair"}
    )
    assert asked == [(None, "pybullet", 5e-4, pytest.approx(20.0 * limit_s, abs=2e-3))]
    assert ("pair_cause_not_shown" in codes(judged.findings)) is (verdict is Verdict.UNBOUNDED)


def test_an_engine_that_fails_without_it_shows_no_difference_of_models(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stated = {"numerical_uncertainty_rad": 2.5e-4, "slip_uncertainty_m": 1e-4}
    scene, still = load_scene(root / "scenes" / "paestum_pedestal.toml"), rest(1.0)
    apart = run_of(replace(still, theta_rad=0.02 * still.t_s), "pybullet", **stated)
    runs = {"pymunk": run_of(still, "pymunk", **stated), "pybullet": apart}
    monkeypatch.setattr(scene_run, "_again", lambda *given: None)
    monkeypatch.setattr(
        scene_run, "simulate", lambda *given, **named: run_of(None, "pybullet", outcome=Outcome.CRASHED)
    )
    scores = {"pair": compare(runs["pymunk"], runs["pybullet"])}
    judged = with_reasons(runs, scores, TakenAway(scene))["pair"]
    assert (scores["pair"].verdict, judged.verdict) == (Verdict.MODEL, Verdict.UNBOUNDED)


def test_of_runs_that_state_no_error_no_other_is_asked(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An expert's own step: whether their models differ is not known, and `pair_differs_unstated` says so."""
    scene, still = load_scene(root / "scenes" / "paestum_pedestal.toml"), rest(1.0)
    apart = run_of(replace(still, theta_rad=0.02 * still.t_s), "pybullet")
    runs = {"pymunk": run_of(still, "pymunk"), "pybullet": apart}
    monkeypatch.setattr(scene_run, "_again", lambda *given: apart)
    monkeypatch.delattr(scene_run, "simulate")
    scores = {"pair": compare(runs["pymunk"], runs["pybullet"])}
    assert with_reasons(runs, scores, TakenAway(scene))["pair"].verdict is scores["pair"].verdict


def test_of_a_scene_that_the_plane_leaves_nothing_out_of_no_other_run_is_asked(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stated = {"numerical_uncertainty_rad": 2.5e-4, "slip_uncertainty_m": 1e-4}
    scene, still = load_scene(root / "scenes" / "paestum_block.toml"), rest(1.0)
    apart = replace(still, theta_rad=0.02 * still.t_s)
    runs = {"pymunk": run_of(still, "pymunk", **stated), "pybullet": run_of(apart, "pybullet", **stated)}
    monkeypatch.delattr(scene_run, "simulate")
    scores = {"pair": compare(runs["pymunk"], runs["pybullet"])}
    assert with_reasons(runs, scores, TakenAway(scene))["pair"].verdict is Verdict.MODEL


@pytest.mark.parametrize(("late_s", "verdict"), [(0.5, Verdict.PLANE), (0.0, Verdict.MODEL)])
def test_a_cause_is_judged_where_the_difference_first_stands(
    late_s: float, verdict: Verdict, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What parts later without it says nothing: its run has one step, and no error that is bounded."""
    scene, still = load_scene(root / "scenes" / "paestum_pedestal.toml"), rest(1.0)
    space = replace(still, theta_rad=0.02 * still.t_s)
    again = replace(still, theta_rad=0.02 * np.maximum(still.t_s - late_s, 0.0))
    monkeypatch.setattr(scene_run, "_again", lambda *given: run_of(again, "pybullet"))
    scores = invented_scores("pymunk", "pybullet")
    scores = replace(
        scores, verdict=Verdict.MODEL, evidence=replace(scores.evidence, limit_rad=5e-4, differs_in="rotation")
    )
    runs = {"pymunk": run_of(still, "pymunk"), "pybullet": run_of(space, "pybullet")}
    assert with_reasons(runs, {"pair": scores}, TakenAway(scene))["pair"].verdict is verdict


def test_a_pedestal_that_slides_on_in_space_alone_names_the_products_of_inertia(root: Path) -> None:
    """Their slips part by 4.7 mm where the plane has the pedestal stick (`test_a_pedestal_that_turns_aside_slides_on...`)."""
    shaking = ["motion.x.amplitude_g=0.334", "motion.x.frequency_hz=2", "duration_s=1.6"]
    scene = load_scene(root / "scenes" / "paestum_pedestal.toml", shaking)
    said = run_scene(scene, ("analytic", "pybullet")).scores["analytic_vs_pybullet"]
    assert said.evidence.differs_in == "slip"
    (told,) = [each.values for each in said.findings if each.code == "plane_cause"]
    assert told["cause"] == "products_of_inertia"
    assert said.evidence.largest_slip_difference_m > 4e-3
