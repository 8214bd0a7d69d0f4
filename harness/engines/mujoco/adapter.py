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
from typing import Any, ClassVar, Final, final

import numpy as np
from numpy.typing import NDArray

from harness.engines.base import MOVING_TABLE, Engine, EngineFailure, Settings, near, own_settings, refuse
from harness.engines.contact import frame
from harness.engines.contact.friction import FloorFriction, floor_friction, followed
from harness.engines.contact.reduce import Report, reduce_trajectory
from harness.engines.contact.spatial import fallen
from harness.engines.mujoco.model import FLOOR_PAIR, model_xml
from harness.engines.mujoco.samples import trajectory
from harness.model.interventions import Intervention
from harness.model.options import Capabilities, RunOptions
from harness.model.run import Run
from harness.model.scene import OVERTURN_RAD, Scene

Array = NDArray[np.float64]

LEVELS: Final = ((1e-3, 1e-2), (5e-4, 5e-3), (2.5e-4, 2.5e-3), (1e-4, 1e-3), (5e-5, 5e-4))
"""(step in s, error in rad reached where tuned): the paper's four cases with a pedestal, first second."""
STIFF_STEPS: Final = 2.0
"""The contact's time constant in steps: MuJoCo's least."""
BLOCK_STEPS: Final = 512
SOFT_LIMIT: Final = 1.0 - 1e-3
"""Share of its limit at which a soft friction cone slides: it is reached within its regularisation, not within rounding."""
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
    import mujoco

    imposed = "a prescribed ratio at impact (contact.restitution; its impact is its own soft contact)"
    asked = {
        imposed: scene.contact.restitution is not None,
        MOVING_TABLE: scene.table == "moving",
        "a wall": scene.wall is not None,
    }
    refuse(name, asked, "pymunk", "pybullet")
    begin = time.perf_counter()
    try:
        model = mujoco.MjModel.from_xml_string(model_xml(scene, own.dt_s, own.stiff_steps))
    except ValueError as error:
        raise EngineFailure(f"mujoco refused the scene: {error}") from error
    edges: Array = np.arange(frame.step_count(scene.duration_s, own.dt_s) + 1, dtype=np.float64) * own.dt_s
    gravity = frame.apparent_gravity(scene, edges)
    states, again = _stepped(mujoco, model, scene, own, gravity, options, repeats=repeats)
    marched = len(states) - 1
    if scene.initial.pose is None:
        states = states[: _until_fallen(states)]
    seen = trajectory(scene, own.dt_s, edges[: len(states)], gravity[: len(states) - 1, [0, 2]], states)
    base = scene.statue.corner_left_m + scene.statue.corner_right_m
    # A soft contact gives g τ² under the weight, τ being its time constant; over the base's width that is a rotation.
    settling = scene.gravity_m_s2 * (own.stiff_steps * own.dt_s) ** 2
    report = Report(
        engine=name,
        settings=own.as_dict(),
        steps=marched,
        wall_s=0.0,
        resolution_rad=max(RESOLUTION_STEPS * settling / base, 1e-6),
        stuck_below_m_s=1e-4,
        with_history=options.history or not options.allows("no_history"),
        interventions={"friction_release": Intervention(steps_again=again)} if again else {},
        coulomb=False,
    )
    return replace(reduce_trajectory(scene, seen, report), wall_s=time.perf_counter() - begin)


def _start(scene: Scene, own: MujocoSettings, data: Any) -> None:
    """Stand the statue on the vertex about which its initial rotation turns it, half a step ahead of t = 0; or throw it."""
    statue, pedestal, pose = scene.statue, scene.pedestal, scene.initial.pose
    if pose is not None:
        data.qpos[:7] = [*pose.position_m, *pose.quaternion_wxyz]
        data.qvel[:6] = [*pose.velocity_m_s, *pose.angular_velocity_rad_s]
        return
    theta, rate = scene.initial.theta_rad, scene.initial.theta_rate_rad_s
    base = statue.footprint_m[:, [0, 2]] - np.array([0.0, statue.centroid_height_m])
    cos, sin = math.cos(theta), math.sin(theta)
    turned = np.column_stack([base[:, 0] * cos + base[:, 1] * sin, base[:, 1] * cos - base[:, 0] * sin])
    pivot = int(np.argmin(turned[:, 1] - 1e-9 * math.copysign(1.0, theta or rate) * base[:, 0]))
    top = 0.0 if pedestal is None else pedestal.height_m
    centre = np.array([base[pivot, 0], top]) - turned[pivot]
    velocity = rate * np.array([-turned[pivot, 1], turned[pivot, 0]])
    centre += 0.5 * own.dt_s * velocity
    half = 0.5 * (theta + 0.5 * own.dt_s * rate)
    data.qpos[:7] = [centre[0], 0.0, centre[1], math.cos(half), 0.0, math.sin(half), 0.0]
    data.qvel[:6] = [velocity[0], 0.0, velocity[1], 0.0, rate, 0.0]
    if pedestal is not None:
        x = statue.base_centre_m + pedestal.offset_m
        data.qpos[7:14] = [x, 0.0, pedestal.centroid_height_m, 1.0, 0.0, 0.0, 0.0]


def _stepped(
    mujoco: Any, model: Any, scene: Scene, own: MujocoSettings, gravity: Array, options: RunOptions, *, repeats: bool
) -> tuple[Array, int]:
    """All steps: rows of positions and velocities, shape (n + 1, nq + nv), and how many were solved again."""
    data = mujoco.MjData(model)
    _start(scene, own, data)
    friction = floor_friction(scene, own.dt_s)
    switching = scene.pedestal is not None and friction.switches
    rows = np.empty((len(gravity) + 1, model.nq + model.nv))
    rows[0, : model.nq], rows[0, model.nq :] = data.qpos, data.qvel
    stuck, repeated, step, n = True, 0, mujoco.mj_step, model.nq
    for k in range(len(gravity)):
        model.opt.gravity[:] = gravity[k]
        step(model, data)
        if switching and not repeats:
            model.pair(FLOOR_PAIR).friction[:2] = followed(friction, float(data.qvel[6]))
        elif switching:
            stuck, again = _follow(mujoco, model, data, scene, friction, rows[k], gravity[k] * own.dt_s, stuck)
            repeated += again
        rows[k + 1, :n], rows[k + 1, n:] = data.qpos, data.qvel
        looks = k % BLOCK_STEPS == 0 and scene.initial.pose is None
        if looks and _may_end(own, options, k + 1, _axis(data.qpos[3:7])):
            rows = rows[: k + 2]
            break
    return rows, repeated


def _may_end(own: MujocoSettings, options: RunOptions, steps: int, axis: tuple[float, float, float]) -> bool:
    """Whether the statue has overturned, or nobody asks further."""
    if options.allows("stop_at_overturn") and fallen(*axis):
        return True
    return options.stop is not None and options.stop(steps * own.dt_s, math.atan2(axis[0], axis[2]))


def _axis(turn: Any) -> tuple[float, float, float]:
    """The statue's axis in the world, from its quaternion (w, x, y, z)."""
    w, x, y, z = (float(value) for value in turn)
    return 2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)


def _until_fallen(rows: Array) -> int:
    """How many rows up to the first at which the statue counts as overturned, and one more: samples lie half a step before."""
    up_z = 1.0 - 2.0 * (rows[:, 4] ** 2 + rows[:, 5] ** 2)
    low = np.flatnonzero(up_z <= math.cos(OVERTURN_RAD / 2.0))
    return next((min(int(k) + 2, len(rows)) for k in low if fallen(*_axis(rows[k, 3:7]))), len(rows))


def _follow(
    mujoco: Any,
    model: Any,
    data: Any,
    scene: Scene,
    friction: FloorFriction,
    before: Array,
    gravity_step: Array,
    stuck: bool,
) -> tuple[bool, int]:
    """Let the floor's coefficient follow the sliding state (contact/friction.py); MuJoCo's state is its q and v."""
    rate, last = float(data.qvel[6]), float(before[model.nq + 6])
    if not stuck:
        sticks = abs(rate) <= friction.stuck_below_m_s or rate * last < 0.0
        if sticks:
            model.pair(FLOOR_PAIR).friction[:2] = friction.static
        return sticks, 0
    pedestal_kg = scene.pedestal.mass_kg if scene.pedestal is not None else 0.0
    change = scene.statue.mass_kg * (data.qvel[:3] - before[model.nq : model.nq + 3] - gravity_step)
    change = change + pedestal_kg * (data.qvel[6:9] - before[model.nq + 6 : model.nq + 9] - gravity_step)
    if abs(change[0]) < friction.static * change[2] * SOFT_LIMIT:
        return True, 0
    model.pair(FLOOR_PAIR).friction[:2] = friction.kinetic
    _restore(model, data, before)
    mujoco.mj_step(model, data)
    return False, 1


def _restore(model: Any, data: Any, before: Array) -> None:
    """Put the bodies back to where a step began that is solved again: all that is written to them after the start."""
    data.qpos[:], data.qvel[:] = before[: model.nq], before[model.nq :]
