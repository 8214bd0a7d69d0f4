"""Hard questions that are not one file: mirrored, perturbed, permuted, refined.

`python -m tests.measures.invariance_checks` asks them all and prints a line for each; 1 where one does not hold.
"""

import math
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from analytic.block import GRAVITY_M_S2
from analytic.excitation import SampledAcceleration
from harness import Run, RunOptions, engines
from harness.comparison.scores import error_rad
from harness.engines.base import Engine, Settings
from harness.model import BaseExcitation, Scene
from harness.questions.bench import stress_run
from harness.questions.bench.standard_scenes import COLUMN, PAESTUM, PEDESTAL, harmonic, scene_of
from harness.questions.bench.stress_run import ALL, CONTACT, leaning, solution
from harness.records.bench import HardRow, Measure

HOLDS: Final = "holds"
STEP_S: Final = 5e-4
PERMUTED_RAD: Final = 2e-4
"""What another order of bodies may change where friction switches between two coefficients: a fifth of what runs aim at."""
PERMUTED_STEP_S: Final = 2.5e-4
PERTURBATIONS: Final = (1e-12, 1e-9, 1e-6, 1e-3)
GROWTH: Final = (0.1, 20.0)
"""Rotation, rad, by which a start perturbed by a share of the slenderness must and may part in two seconds with impacts."""
ROUNDING_RAD: Final = 1e-10
"""What rounding may add to that in a contact engine."""
ORDER_SHORT: Final = 0.2
"""What the observed order may lack of the declared one."""
TOUCH_S: Final = 0.13748078897644156
"""Start of the push that turns a falling block back just where it would land: from here on it touches."""
TOUCH_EARLY_S: Final = 1e-9
TOUCH_APART_RAD: Final = 1e-5
"""What the two sides of that may part by: an impact at 1e-4 rad/s loses no more."""
FAR_S: Final = 46.0
FAR_STEP_S: Final = 0.01
HULLS: Final = (8, 1000, 10_000)
HULL_RAD: Final = 1e-3
"""What more vertices on the same two corners may change of the peak, over the peak."""
SAME: Final = RunOptions(skips=frozenset())
FORCED: Final = {"duration_s": 1.0, "statue": PAESTUM, "pedestal": PEDESTAL, "motion": harmonic(0.429, 3.0)}


def _row(name: str, answers: Mapping[str, Sequence[Measure]]) -> HardRow:
    got = {engine: HOLDS if stress_run.all_hold(measured) else "wrong" for engine, measured in answers.items()}
    return HardRow(name, HOLDS, got, all(each == HOLDS for each in got.values()), answers)


def _here(names: tuple[str, ...]) -> list[Engine]:
    return [engine for engine in map(engines.load, names) if engine.missing() is None]


def _settings(engine: Engine, scene: Scene, step_s: float = STEP_S) -> Settings:
    return (
        engine.refinement_levels(scene)[-1] if engine.capabilities.certifies else engine.settings_for_dt(scene, step_s)
    )


def _run(engine: Engine, scene: Scene, step_s: float = STEP_S) -> Run:
    return engine.simulate(scene, _settings(engine, scene, step_s), SAME)


def _apart(one: Run, other: Run, sign: float = 1.0) -> float:
    """Largest difference of two rotations of one grid, the second times `sign`; infinite where the grids differ."""
    if one.history is None or other.history is None or one.history.t_s.shape != other.history.t_s.shape:
        return math.inf
    return float(np.max(np.abs(one.history.theta_rad - sign * other.history.theta_rad)))


def _mirrored() -> HardRow:
    """Mirrored input gives the mirrored output."""
    given = {**FORCED, "duration_s": 0.6}
    statue = {**PAESTUM, "corner_left_m": PAESTUM["corner_right_m"], "corner_right_m": PAESTUM["corner_left_m"]}
    mirror = {**given, "statue": statue, "motion": harmonic(-0.429, 3.0)}
    scene, image = scene_of("given", given), scene_of("mirror", mirror)
    answers: dict[str, Sequence[Measure]] = {}
    for engine in _here(ALL):
        apart = _apart(_run(engine, scene), _run(engine, image), -1.0)
        # A contact engine visits contacts in the order of creation, which the mirror does not swap: its own error is left.
        allowed = 0.0 if engine.capabilities.certifies else _settings(engine, scene).expected_error_rad
        answers[engine.name] = [stress_run.within("apart_rad", apart, allowed)]
    return _row("mirrored input, mirrored output", answers)


def _perturbed() -> HardRow:
    """Starts perturbed by 1e-12 to 1e-3."""
    answers: dict[str, Sequence[Measure]] = {}
    scenes = {size: scene_of("start", leaning(COLUMN, 0.5 + size, 2.0)) for size in (0.0, *PERTURBATIONS)}
    for engine in _here(ALL):
        base = _run(engine, scenes[0.0])
        own = 1e-12 if engine.capabilities.certifies else ROUNDING_RAD
        apart = {size: _apart(base, _run(engine, scenes[size])) for size in PERTURBATIONS}
        answers[engine.name] = [
            Measure("apart_rad", GROWTH[0] * size <= value <= most, value, most, f"{size:g} α")
            for size, value in apart.items()
            for most in [GROWTH[1] * size + own]
        ]
    return _row("starts perturbed by 1e-12 to 1e-3", answers)


def _permuted() -> HardRow:
    """Bodies added in the other order."""
    scene = scene_of("permuted", FORCED)
    answers: dict[str, Sequence[Measure]] = {}
    for engine in _here(CONTACT):
        settings = _settings(engine, scene, PERMUTED_STEP_S)
        plain = settings.as_dict()
        flag = "pedestal_first" if "pedestal_first" in plain else "reversed_bodies"
        other: Settings = replace(settings, **{flag: not plain[flag]})
        apart = _apart(engine.simulate(scene, settings, SAME), engine.simulate(scene, other, SAME))
        answers[engine.name] = [stress_run.within("apart_rad", apart, PERMUTED_RAD)]
    return _row("bodies in the other order", answers)


def _refined() -> HardRow:
    """Observed order of convergence before the first impact, against the declared one."""
    scene = scene_of("refined", leaning(COLUMN, 0.5, 0.3))
    judge = solution(scene)
    steps = (2e-3, 1e-3, 5e-4, 2.5e-4)
    answers: dict[str, Sequence[Measure]] = {}
    for engine in _here(CONTACT):
        errors = [error_rad(_run(engine, scene, step), judge) for step in steps]
        order = math.log2(errors[0] / errors[-1]) / (len(steps) - 1)
        least = engine.order - ORDER_SHORT
        answers[engine.name] = [Measure("order_at_least", order >= least, order, least)]
    return _row("order of convergence over three halvings", answers)


def _touched() -> HardRow:
    """A near-tangent impact: a fall turned back just before and just after it lands."""
    exact = engines.load("analytic")
    sides = {}
    for name, start_s in (("missed", TOUCH_S - TOUCH_EARLY_S), ("touched", TOUCH_S + TOUCH_EARLY_S)):
        push = {"kind": "pulse", "shape": "rectangular", "amplitude_g": -0.3, "duration_s": 0.3, "start_s": start_s}
        content = {"duration_s": 0.6, "statue": COLUMN, "initial": {"theta_rad": 0.05}, "motion": {"x": push}}
        scene = scene_of(name, content)
        sides[name] = scene, solution(scene)
    answers: dict[str, Sequence[Measure]] = {
        exact.name: [
            *(
                Measure("impacts", run.work["impacts"] == count, run.work["impacts"], count, side)
                for count, (side, (_, run)) in enumerate(sides.items())
            ),
            stress_run.within("apart_rad", _apart(sides["missed"][1], sides["touched"][1]), TOUCH_APART_RAD),
        ]
    }
    for engine in _here(CONTACT):
        answers[engine.name] = [
            replace(each, case=side)
            for side, (scene, truth) in sides.items()
            for each in stress_run.agrees(scene, _run(engine, scene), truth)
        ]
    return _row("an impact touched and missed by a billionth of a second", answers)


def _far() -> HardRow:
    """Rocking and overturning a kilometre from where the table started."""
    t_s = np.arange(round((FAR_S + 2.0) / FAR_STEP_S) + 1) * FAR_STEP_S
    pulse = 0.3 * np.sin(4.0 * np.pi * (t_s - FAR_S)) * (t_s < FAR_S + 0.5)
    away = SampledAcceleration(t_s, GRAVITY_M_S2 * np.where(t_s < FAR_S, 0.1, pulse))
    content = {"duration_s": FAR_S + 2.0, "table": "moving", "statue": COLUMN, "gravity_m_s2": GRAVITY_M_S2}
    scene = replace(scene_of("far", {**content, "output": {"dt_s": 1e-3}}), base_excitation=BaseExcitation(x=away))
    truth = solution(scene)
    answers: dict[str, Sequence[Measure]] = {}
    for engine in _here(CONTACT):
        run = _run(engine, scene, 1e-3)
        falls = Measure("overturns", run.outcome is truth.outcome and run.outcome.overturned)
        answers[engine.name] = [falls, *stress_run.agrees(scene, run, truth), *stress_run.energy(scene, run)]
    return _row("rocking and overturning 1 km from the origin", answers)


def _hulls() -> HardRow:
    """Hulls of 8 to 10 000 vertices on the same base."""
    import trimesh

    answers: dict[str, Sequence[Measure]] = {}
    peaks: dict[str, list[float]] = {engine.name: [] for engine in _here(ALL)}
    with tempfile.TemporaryDirectory(prefix="rockcheck-stress-") as name:
        for count in HULLS:
            file = Path(name) / f"hull{count}.ply"
            trimesh.Trimesh(_points(count)).convex_hull.export(file)
            content = {"duration_s": 1.0, "statue": {"mesh": {"file": str(file), "density_kg_m3": 2700.0}}}
            scene = scene_of("hull", {**content, "motion": harmonic(0.45, 2.0)})
            # The same body to all three: what differs is only how many vertices describe it above its base.
            statue = replace(scene.statue, mass_kg=300.0, inertia_kg_m2=26.0, centroid_height_m=0.5)
            scene = replace(scene, statue=replace(statue, inertia_tensor_kg_m2=np.diag([26.0, 26.0, 2.0])))
            for engine in _here(ALL):
                peaks[engine.name].append(_run(engine, scene).peak_theta_rad)
    for name, values in peaks.items():
        spread = float(np.ptp(values)) / max(abs(values[0]), 1e-12)
        answers[name] = [stress_run.within("peaks_apart", spread, HULL_RAD)]
    return _row("hulls of 8 to 10 000 vertices", answers)


def _points(count: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """A base of four corners under a dome of the other vertices."""
    base = np.array([[x, y, 0.0] for x in (-0.12, 0.12) for y in (-0.1, 0.1)])
    if count == 8:
        return np.vstack([base, base + np.array([0.0, 0.0, 0.9])])
    k = np.arange(count - 4) + 0.5
    up, turn = k / (count - 4), np.pi * (1.0 + math.sqrt(5.0)) * k
    across = np.sqrt(1.0 - up**2)
    dome = np.column_stack([0.11 * across * np.cos(turn), 0.09 * across * np.sin(turn), 0.3 + 0.6 * up])
    return np.vstack([base, dome])


ASKED: Final[Sequence[Callable[[], HardRow]]] = (
    _far,
    _hulls,
    _touched,
    _permuted,
    _mirrored,
    _perturbed,
    _refined,
)
"""What is asked beside the hard scenes and is not one file."""


def main() -> int:
    """Ask them all."""
    answers = []
    for ask in ASKED:
        answers.append(row := ask())
        failed = [f"{name}: {each}" for name in row.got for each in row.failed(name)]
        print(f"{'holds' if row.holds else 'FAILS'}  {row.name}", *failed, sep="\n  ", flush=True)
    return 0 if all(row.holds for row in answers) else 1


if __name__ == "__main__":
    sys.exit(main())
