"""MuJoCo (optional extra): a third opinion in three dimensions, with soft contact.

The statue stands on small spheres at its base's vertices that can touch; nothing else of it does. MuJoCo's contact is a
spring and damper whose time constant is tied to the step, so that it hardens with it. Velocities are changed first, positions
follow with the new ones: positions lead by half a step, and both are second order when they are read so.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from importlib import util
from typing import ClassVar, Final, final

import numpy as np

from harness.engines.base import MOVING_TABLE, Engine, EngineFailure, Settings, near, own_settings, refuse
from harness.engines.contact.frame import step_count
from harness.engines.contact.reduce import Report, reduce_trajectory
from harness.engines.event_stepping.columns import trajectory
from harness.engines.event_stepping.loop import integrate
from harness.engines.event_stepping.plain_steps import plain_steps
from harness.engines.event_stepping.rows import Row
from harness.engines.event_stepping.schedule import Schedule
from harness.engines.event_stepping.step_log import StepLog
from harness.engines.event_stepping.step_state import StepState
from harness.engines.event_stepping.stepper import Stepper
from harness.engines.event_stepping.watch import Watch
from harness.engines.mujoco.model import integrator, model_xml
from harness.model.options import Capabilities, RunOptions
from harness.model.run import Run
from harness.model.scene import Scene

LEVELS: Final = ((1e-3, 1e-2), (5e-4, 5e-3), (2.5e-4, 2.5e-3), (1e-4, 1e-3), (5e-5, 5e-4))
"""(step in s, error in rad at least stated): of the paper's four cases without a pedestal, first second, 2e-4 to 8e-5; with one
2e-4 to 2.4e-2 on each level, in no order (docs/bench.md)."""
STIFF_STEPS: Final = 2.0
"""The contact's time constant in steps: MuJoCo's least."""
RESOLUTION_STEPS: Final = 8.0
"""A soft contact settles by about g·(time constant)²: rotation within this many of it over the base's width is rest."""


@dataclass(frozen=True)
class MujocoSettings(Settings):
    """Step and stiffness: `stiff_steps` is the contact's time constant in steps."""

    stiff_steps: float = STIFF_STEPS


@final
class Mujoco3D(Engine):
    """MuJoCo, in the contract of the harness."""

    name: ClassVar[str] = "mujoco"
    capabilities: ClassVar[Capabilities] = Capabilities(
        dimensions=3, uses_mesh=True, own_impact=True, pedestal_tips=True, statue_slips=True, flies=True, forces=True,
        posed_start=True, skips=frozenset({"no_history", "stop_at_overturn"}), edge_shape="the base's vertices alone",
    )  # fmt: skip
    order: ClassVar[float] = 1.0

    def missing(self) -> str | None:
        """Why MuJoCo cannot run here, or None."""
        return None if util.find_spec("mujoco") else "mujoco is not installed: pip install 'rockcheck[mujoco]'"

    def refinement_levels(self, scene: Scene) -> tuple[MujocoSettings, ...]:
        """Steps of 1 ms to 0.05 ms."""
        return tuple(MujocoSettings(dt, error) for dt, error in LEVELS)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> MujocoSettings:
        """The nearest level's stiffness with the given step."""
        return MujocoSettings(*near(LEVELS, dt_s))

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[MujocoSettings, ...]:
        """Half the step, and so half the contact's time constant."""
        own = own_settings(self.name, MujocoSettings, settings)
        return (replace(own, dt_s=0.5 * own.dt_s, expected_error_rad=0.5 * own.expected_error_rad),)

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene. Raises `EngineFailure` where MuJoCo refuses it, or where it asks for what is not computed here."""
        return _simulated(self.name, scene, own_settings(self.name, MujocoSettings, settings), options, repeats=True)


@final
class PlainMujoco3D(Engine):
    """MuJoCo as it comes: after the start no body is written to, and no step is repeated.

    The floor's coefficient follows the pedestal's own velocity (`harness.engines.contact.friction.followed`).
    """

    name: ClassVar[str] = "mujoco:plain"
    capabilities: ClassVar[Capabilities] = Mujoco3D.capabilities
    order: ClassVar[float] = 1.0

    missing = Mujoco3D.missing
    refinement_levels = Mujoco3D.refinement_levels
    settings_for_dt = Mujoco3D.settings_for_dt
    verification_settings = Mujoco3D.verification_settings

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene. Raises `EngineFailure` where MuJoCo refuses it, or where it asks for what is not computed here."""
        return _simulated(self.name, scene, own_settings(self.name, MujocoSettings, settings), options, repeats=False)


def _simulated(name: str, scene: Scene, own: MujocoSettings, options: RunOptions, *, repeats: bool) -> Run:
    """Compute the scene; `repeats` says whether a step in which the pedestal breaks loose is computed again."""
    imposed = "a prescribed ratio at impact (contact.restitution; its impact is its own soft contact)"
    asked = {
        imposed: scene.contact.restitution is not None,
        MOVING_TABLE: scene.table == "moving",
        "a wall": scene.wall is not None,
    }
    refuse(name, asked, "pymunk", "pybullet")
    begin = time.perf_counter()
    record = _integrated(scene, own, options, repeats=repeats)
    base = scene.statue.corner_left_m + scene.statue.corner_right_m
    # A soft contact gives g τ² under the weight, τ being its time constant; over the base's width that is a rotation.
    settling = scene.gravity_m_s2 * (own.stiff_steps * own.dt_s) ** 2
    report = Report(
        engine=name,
        settings=own.as_dict(),
        steps=len(record.t_s) - 1,
        wall_s=0.0,
        resolution_rad=max(RESOLUTION_STEPS * settling / base, 1e-6),
        stuck_below_m_s=1e-4,
        with_history=options.history or not options.allows("no_history"),
        interventions=record.ledger.record(),
        coulomb=False,
    )
    path = trajectory(scene, record, np.eye(3), own.dt_s)
    return replace(reduce_trajectory(scene, path, report), wall_s=time.perf_counter() - begin)


def _integrated(scene: Scene, own: MujocoSettings, options: RunOptions, *, repeats: bool) -> StepLog:
    """Samples of a run."""
    from harness.engines.mujoco.backend import MujocoBackend

    try:
        backend = MujocoBackend(model_xml(scene, own.dt_s, own.stiff_steps))
    except ValueError as error:
        raise EngineFailure(f"mujoco refused the scene: {error}") from error
    backend.place(_start(scene))
    schedule = Schedule(scene, own.dt_s, 0, step_count(scene.duration_s, own.dt_s))
    watch = Watch(stop=options.stop, ends_fallen=options.allows("stop_at_overturn"))
    if repeats and scene.pedestal is not None:
        state = StepState(Stepper(backend, scene, schedule), backend.read(), 0, 0.0, even=True)
        return integrate(scene, schedule, watch, state)
    # Of order four places and velocities move at once: neither lags.
    return plain_steps(backend, schedule, watch, lags=integrator(scene) == "Euler")


def _start(scene: Scene) -> Row:
    """The statue on the vertex about which its initial rotation turns it, or thrown; the pedestal on the floor."""
    statue, pedestal, pose = scene.statue, scene.pedestal, scene.initial.pose
    if pose is not None:
        w, x, y, z = pose.quaternion_wxyz
        spin = pose.rotation @ np.array(pose.angular_velocity_rad_s)
        return (*pose.position_m, x, y, z, w, *pose.velocity_m_s, *spin.tolist())
    theta, rate = scene.initial.theta_rad, scene.initial.theta_rate_rad_s
    base = statue.footprint_m[:, [0, 2]] - np.array([0.0, statue.centroid_height_m])
    cos, sin = math.cos(theta), math.sin(theta)
    turned = np.column_stack([base[:, 0] * cos + base[:, 1] * sin, base[:, 1] * cos - base[:, 0] * sin])
    pivot = int(np.argmin(turned[:, 1] - 1e-9 * math.copysign(1.0, theta or rate) * base[:, 0]))
    top = 0.0 if pedestal is None else pedestal.height_m
    x, z = np.array([base[pivot, 0], top]) - turned[pivot]
    u, w = rate * np.array([-turned[pivot, 1], turned[pivot, 0]])
    row: Row = (float(x), 0.0, float(z), 0.0, math.sin(0.5 * theta), 0.0, math.cos(0.5 * theta))
    row += (float(u), 0.0, float(w), 0.0, rate, 0.0)
    if pedestal is None:
        return row
    place = (statue.base_centre_m + pedestal.offset_m, 0.0, pedestal.centroid_height_m)
    return (*row, *place, 0.0, 0.0, 0.0, 1.0, *6 * (0.0,))
