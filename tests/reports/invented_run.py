"""An invented result folder for the pages' own tests: the shape is the harness's, the motion is made up on purpose."""

import itertools
from dataclasses import MISSING, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from analytic.excitation import Harmonic
from harness.model import (
    BaseExcitation,
    Contact,
    Form,
    History,
    Outcome,
    Pattern,
    Pedestal,
    Run,
    Scene,
    Statue,
    Wall,
    caution,
    info,
)
from harness.questions.scene.scene_run import Result, write_result
from harness.records.scores import Evidence, Scores, Verdict
from harness.statics.plan import Step
from reports.messages import ENGLISH

MASS_KG = 707.0
AGREE = partial(info, "pair_agrees", difference_rad=1e-4, limit_rad=1e-3)


def invented_scores(a: str, b: str) -> Scores:
    """Stands in for the comparator's scores, which have their own tests."""
    none: dict[str, Any] = {each.name: None for each in fields(Scores) if "None" in str(each.type)}
    lists: dict[str, Any] = {each.name: () for each in fields(Scores) if str(each.type).startswith("Sequence[float")}
    known = {"rms_theta_rad": 1.25e-4, "peak_ratio": 0.997, "together_until_s": 4.5, "together_tolerance_rad": 0.01}
    alone = {f"{kind}_alone_{side}": 0 for kind in ("uplifts", "impacts") for side in "ab"}
    evidence = {each.name: None for each in fields(Evidence) if each.default is MISSING}
    evidence |= {"limit_rad": 1e-3, "coverage": 2.0, "left_domain_by": "", "outcome_flips_within_uncertainty": False}
    evidence |= dict.fromkeys(("largest_difference_rad", "largest_reliable_difference_rad"), 1e-4)
    return Scores(
        **none
        | lists
        | known
        | alone
        | {"a": a, "b": b, "peak_theta_a_rad": 0.1, "peak_theta_b_rad": 0.1, "numerical_uncertainty": {}}
        | {"verdict": Verdict.AGREE, "evidence": Evidence(**evidence), "findings": [AGREE(a=a, b=b)]}
    )


def block_scene(*, pedestal: bool = True, wall: bool = True) -> Scene:
    """The paper's statue as a block by its numbers."""
    section = np.array([[-0.3585, 0.0], [0.0682, 0.0], [0.0682, 1.46], [-0.3585, 1.46]])
    foot = np.array([[-0.3585, -0.36, 0.0], [0.0682, -0.36, 0.0], [0.0682, 0.36, 0.0], [-0.3585, 0.36, 0.0]])
    statue = Statue(MASS_KG, 0.774, 0.3585, 0.0682, 152.4, 1.46, 0.72, section, foot, np.diag([150.0, 152.4, 40.0]))
    return Scene(
        title="An invented <statue> & its pedestal",
        duration_s=10.0,
        gravity_m_s2=9.81,
        form=Form(),
        statue=statue,
        pedestal=Pedestal(250.0, 0.60, 0.80, 0.20) if pedestal else None,
        contact=Contact(0.2, 0.15, 1.0),
        base_excitation=BaseExcitation(x=Harmonic(0.429 * 9.81, 3.0)),
        wall=Wall("left", 0.70) if wall else None,
        given={"title": "invented", "duration_s": 10.0, "motion": {"x": {"kind": "harmonic", "frequency_hz": 3.0}}},
        findings=(info("key_assumed", key="statue.height_m", value=1.46),),
    )


def with_figure(scene: Scene) -> Scene:
    """The same scene with the generated figure's mesh."""
    from harness.input.mesh_statue import statue_of
    from tests.meshes import togatus

    return replace(scene, statue=statue_of(togatus.build()))


def invented_history(phase_rad: float, *, falls: bool = False, samples: int = 10001) -> History:
    """A made-up rocking history; `falls` ends it at 1.5 rad."""
    t = np.linspace(0.0, 10.0, samples)
    theta = 0.11 * np.sin(5.0 * t + phase_rad * t) * np.abs(np.sin(0.7 * t)) * np.exp(-0.08 * t)
    theta[t < 0.2] = 0.0
    if falls:
        theta = theta + np.where(t > 6.0, 0.4 * np.maximum(t - 6.0, 0.0) ** 2, 0.0)
        end = int(np.argmax(theta >= 1.5))
        t, theta = t[: end + 1], theta[: end + 1]
    slip = 0.02 * np.cumsum(np.cos(3.0 * t + phase_rad)) / len(t)
    return History(t, theta, np.gradient(theta, t), slip, np.gradient(slip, t))


def invented_run(engine: str, history: History, outcome: Outcome, uncertainty_rad: float | None) -> Run:
    """A run around an invented history."""
    t, theta = history.t_s, history.theta_rad
    peak = int(np.argmax(np.abs(theta)))
    edges = np.linspace(0.2, float(t[-1]), 40)
    names = ("rocking", "both", "sliding", "both")
    patterns = [Pattern(0.0, 0.2, "rest")]
    patterns += [Pattern(float(a), float(b), names[i % 4]) for i, (a, b) in enumerate(itertools.pairwise(edges))]
    falls = outcome.overturned
    return Run(
        engine=engine,
        outcome=outcome,
        history=history,
        settings={"dt_s": 2.5e-4, "expected_error_rad": 1e-4},
        steps=40_000,
        wall_s=0.31,
        peak_theta_rad=float(theta[peak]),
        peak_time_s=float(t[peak]),
        end_s=float(t[-1]),
        overturn_time_s=float(t[-1]) if falls else None,
        no_return_time_s=float(t[-1]) - 0.9 if falls else None,
        impact_times_s=[0.8, 1.4, 2.0],
        peak_slip_m=float(np.abs(history.slip_m).max()),
        patterns=patterns,
        validity={"friction_needed_at_pivot": 0.41, "least_normal_force_n": 6100.0},
        numerical_uncertainty_rad=uncertainty_rad,
        reliable_until_s=4.6 if uncertainty_rad and uncertainty_rad > 1e-6 else float(t[-1]),
        skipped={"quiet_start": 0.2} if engine == "pymunk" else {},
        findings=(caution("own_contact", keys=["model.friction_normal"]),) if engine == "pybullet" else (),
    )


def write_invented(folder: Path, *, disagree: bool = False, mesh: bool = False, pedestal: bool = True) -> Path:
    """Write an invented result folder; `disagree` lets one engine's statue fall."""
    scene = block_scene(pedestal=pedestal)
    scene = with_figure(scene) if mesh else scene
    fallen = Outcome.OVERTURNED_RIGHT if disagree else Outcome.STANDS
    runs = {
        "analytic": invented_run("analytic", invented_history(0.0), Outcome.STANDS, 1e-10),
        "pymunk": invented_run("pymunk", invented_history(0.01), Outcome.STANDS, 4e-4),
        "pybullet": invented_run("pybullet", invented_history(0.02, falls=disagree), fallen, 2e-3),
    }
    scores = {f"analytic_vs_{name}": invented_scores("analytic", name) for name in ("pymunk", "pybullet")}
    plan = [Step("quiet_start", "*", True, info("plan_nothing_moves", until_s=0.2))]
    write_result(Result(scene, runs, scores, plan, 1.9), folder, ENGLISH.say)
    return folder
