"""One engine on one scene: to an accuracy, or with an expert's own step; its failures told as outcomes."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from harness import engines
from harness.engines.base import Engine, EngineFailure, LayerFault, own_failures
from harness.model import Outcome, Run, RunOptions, Scene, must_be_scene, require

if TYPE_CHECKING:
    from harness.input.tables import Overrides

DEFAULT_ACCURACY_RAD: Final = 1e-3
FINEST_DT_S: Final = 1e-6
"""Finer steps than this are refused: 10 s would take ten million of them."""


@dataclass(frozen=True)
class RunTarget:
    """What a run aims at: an accuracy, rad, or the expert's own step, s (neither: the default accuracy); and its options."""

    accuracy_rad: float | None = None
    dt_s: float | None = None
    options: RunOptions = field(default_factory=RunOptions)

    @property
    def target_rad(self) -> float:
        """The accuracy that is aimed at where no step is given, rad."""
        return self.accuracy_rad or DEFAULT_ACCURACY_RAD


def simulate(
    scene: Scene,
    engine: str,
    *,
    accuracy_rad: float | None = None,
    dt_s: float | None = None,
    options: RunOptions | None = None,
    overrides: Overrides = (),
) -> Run:
    """Compute one scene with one engine to an accuracy (default 1e-3 rad) or with an expert's own step.

    >>> run = harness.simulate(scene, "pymunk", accuracy_rad=1e-3)

    `overrides` replace keys of the scene as `scene.replace` does. An engine's own failure is a `Run` whose outcome says so.
    Raises `InputError` for an unknown engine or key, an accuracy or step out of range, or both given.
    """
    must_be_scene(scene, "simulate")
    check_target(accuracy_rad, dt_s)
    if overrides:
        scene = scene.replace(overrides)
    return simulate_with(engines.load(engine), scene, RunTarget(accuracy_rad, dt_s, options or RunOptions()))


def simulate_with(engine: Engine, scene: Scene, target: RunTarget) -> Run:
    """The same with an engine that is loaded, and a target that was checked."""
    reason, start, spent_s = engine.missing(), time.perf_counter(), time.thread_time()
    try:
        with own_failures(engine.name):
            if reason is not None:
                run = failed(engine.name, Outcome.UNAVAILABLE, reason)
            elif scene.initial.pose is not None and not engine.capabilities.posed_start:
                reason = (
                    f"{engine.name} does not begin from a pose in space (initial.position_m and its like): ask pybullet"
                )
                run = failed(engine.name, Outcome.CRASHED, reason)
            elif target.dt_s is not None and not engine.capabilities.certifies:
                run = engine.simulate(scene, engine.settings_for_dt(scene, target.dt_s), target.options)
            else:
                from harness.accuracy.refinement import run_to_accuracy

                run = run_to_accuracy(engine, scene, target.target_rad, target.options)
    except EngineFailure as error:
        run = failed(engine.name, Outcome.CRASHED, str(error), time.perf_counter() - start)
        if isinstance(error, LayerFault):
            run = replace(run, validity={"layer_fault": error.code, **error.values})
    axes = scene.base_excitation.axes(engine.capabilities.dimensions)
    return replace(run, motion_axes=axes, cpu_s=time.thread_time() - spent_s)


def check_target(accuracy_rad: float | None, dt_s: float | None) -> None:
    """Raise `InputError` unless at most one of the two is given and it is in its range."""
    require(accuracy_rad is None or dt_s is None, "--accuracy and --dt", "one of the two", "both")
    require(
        accuracy_rad is None or 1e-9 <= accuracy_rad <= 0.1,
        "--accuracy",
        "a rotation between 1e-9 and 0.1 rad",
        f"{accuracy_rad!r}",
    )
    require(
        dt_s is None or FINEST_DT_S <= dt_s <= 0.1, "--dt", f"a step between {FINEST_DT_S:g} and 0.1 s", f"{dt_s!r}"
    )


def failed(engine: str, outcome: Outcome, message: str, wall_s: float = 0.0) -> Run:
    """A run that says why there is no answer."""
    return Run(
        engine=engine,
        outcome=outcome,
        history=None,
        settings={},
        steps=0,
        wall_s=wall_s,
        peak_theta_rad=0.0,
        peak_time_s=0.0,
        end_s=0.0,
        message=message,
    )
