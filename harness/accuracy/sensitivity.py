"""How much a small change of the motion moves an engine's answer: where that is much, two runs may agree by chance.

The error of a step acts as a slightly other motion does. A third run, under a motion stronger by as much as the step is expected
to err by, shows what the scene makes of such an error: it does not take part in the luck of two runs that agree.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from harness.accuracy.horizon import shaken
from harness.accuracy.spread import Error, Spread, spread
from harness.engines.base import Engine, Settings
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene

PARTED: Final = 4.0
"""Two runs that differ by this many times the target have parted for good."""


def stronger(scene: Scene, share: float) -> Scene:
    """The scene with all its motion, or without any its start, stronger by this share."""
    if not scene.base_excitation.still:
        return shaken(scene, 1.0 + share)
    start = scene.initial
    if start.pose is not None:
        pose = start.pose.faster(1.0 + share)
        return replace(scene, initial=replace(start, pose=pose))
    return replace(scene, initial=start.plus(share * start.theta_rad, share * start.theta_rate_rad_s))


def stronger_run(
    engine: Engine, scene: Scene, settings: Settings, run: Run, expected_error_rad: float, target: Error, until_s: float
) -> tuple[Scene, Settings, RunOptions]:
    """What a run under a motion stronger by `expected_error_rad` / rad is made of, beside `run` (made with `settings`).

    A scene that turns the statue by as much as its motion changes (1 rad for all of it) makes of this share just the expected
    error.
    """
    history = run.history

    def parted(t_s: float, theta_rad: float) -> bool:
        if history is None or t_s > run.end_s:
            return False
        return t_s > until_s or abs(float(history.at(t_s)) - theta_rad) > PARTED * target.rotation_rad

    return stronger(scene, expected_error_rad), engine.sensitivity_settings(scene, settings), RunOptions(stop=parted)


def moved(run: Run, other: Run, target: Error) -> Spread | None:
    """How far a run and the one under a stronger motion are apart; None where that one failed.

    They part where their rotations do: what a slip is moved by is stated, however much, as it may turn nothing.
    """
    if other.outcome.failed or run.history is None:
        return None
    return spread(other, run, target, replace(target, slip_m=math.inf))
