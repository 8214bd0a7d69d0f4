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

from harness.contact import frame
from harness.contact.friction import FloorFriction, floor_friction
from harness.contact.reduce import Report, reduce_trajectory
from harness.contact.spatial import fall_across, fallen, matrices, planar, statue_columns
from harness.contact.trajectory import Trajectory
from harness.engine import Capabilities, Engine, EngineFailure, Settings, Want
from harness.record import Run
from harness.scene import OVERTURN_RAD, Scene

Array = NDArray[np.float64]

RUNGS: Final = ((1e-3, 1e-2), (5e-4, 5e-3), (2.5e-4, 2.5e-3), (1e-4, 1e-3), (5e-5, 5e-4))
"""(step in s, error in rad reached where tuned): the paper's four cases with a pedestal, first second."""
STIFF_STEPS: Final = 2.0
"""The contact's time constant in steps: MuJoCo's least."""
FOOT_M: Final = 1e-4
"""Radius of the spheres at the base's vertices."""
BLOCK_STEPS: Final = 512
FLOOR_PAIR: Final = "pedestal on floor"
SOFT_LIMIT: Final = 1.0 - 1e-3
"""Share of its limit at which a soft friction cone slides: it is reached within its regularisation, not within rounding."""
RESOLUTION_STEPS: Final = 8.0
"""A soft contact settles by about g·(time constant)²: rotation within this many of it over the base's width is rest."""


@dataclass(frozen=True)
class MujocoSettings(Settings):
    """Step and stiffness: `stiff_steps` is the contact's time constant in steps, `impedance_ratio` friction's over normal."""

    stiff_steps: float = STIFF_STEPS
    impedance_ratio: float = 100.0


@final
class Mujoco3D(Engine):
    """MuJoCo, in the contract of the harness."""

    name: ClassVar[str] = "mujoco"
    capabilities: ClassVar[Capabilities] = Capabilities(
        dimensions=3, uses_mesh=True, own_impact=True, pedestal_tips=True, statue_slips=True, flies=True, forces=True,
        skips=frozenset({"no_history", "stop_at_overturn"}), edge_shape="the base's vertices alone",
    )  # fmt: skip
    order: ClassVar[float] = 1.0

    def missing(self) -> str | None:
        """Why MuJoCo cannot run here, or None."""
        return None if util.find_spec("mujoco") else "mujoco is not installed: pip install 'rockcheck[mujoco]'"

    def ladder(self, scene: Scene) -> tuple[MujocoSettings, ...]:
        """Steps of 1 ms to 0.05 ms."""
        return tuple(MujocoSettings(dt, error) for dt, error in RUNGS)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> MujocoSettings:
        """The nearest rung's stiffness with the given step."""
        dt, error = min(RUNGS, key=lambda rung: abs(math.log(rung[0] / dt_s)))
        return MujocoSettings(dt_s, error * dt_s / dt)

    def probes(self, scene: Scene, settings: Settings) -> tuple[MujocoSettings, ...]:
        """Half the step, and so half the contact's time constant."""
        own = _own(settings)
        return (replace(own, dt_s=0.5 * own.dt_s, expected_error_rad=0.5 * own.expected_error_rad),)

    def simulate(self, scene: Scene, settings: Settings, want: Want) -> Run:
        """Compute the scene. Raises `EngineFailure` where MuJoCo refuses it, or where it asks for what is not computed here."""
        import mujoco

        own = _own(settings)
        _refuse(scene)
        begin = time.perf_counter()
        try:
            model = mujoco.MjModel.from_xml_string(_xml(scene, own))
        except ValueError as error:
            raise EngineFailure(f"mujoco refused the scene: {error}") from error
        edges: Array = np.arange(frame.step_count(scene.duration_s, own.dt_s) + 1, dtype=np.float64) * own.dt_s
        gravity = frame.apparent_gravity(scene, edges)
        states, work = _march(mujoco, model, scene, own, gravity, want)
        marched = len(states) - 1
        states = states[: _until_fallen(states)]
        trajectory = _trajectory(scene, own, edges[: len(states)], gravity[: len(states) - 1, [0, 2]], states)
        base = scene.statue.corner_left_m + scene.statue.corner_right_m
        settling = scene.gravity_m_s2 * (own.stiff_steps * own.dt_s) ** 2
        fall = fall_across(trajectory.extra, trajectory.theta_rad)
        report = Report(
            engine=self.name,
            settings=own.as_dict(),
            steps=marched,
            wall_s=0.0,
            outcome=fall,
            resolution_rad=max(RESOLUTION_STEPS * settling / base, 1e-6),
            stuck_below_m_s=1e-4,
            with_history=want.history or not want.may_skip("no_history"),
            work=work,
        )
        run = replace(reduce_trajectory(scene, trajectory, report), wall_s=time.perf_counter() - begin)
        return run if fall is None else replace(run, overturn_time_s=run.end_s)


def _own(settings: Settings) -> MujocoSettings:
    if not isinstance(settings, MujocoSettings):
        raise TypeError(f"mujoco wants its own settings, got {type(settings).__name__}")
    return settings


def _refuse(scene: Scene) -> None:
    """Raise `EngineFailure` for what this engine cannot compute: its answer would be that of another scene."""
    found = []
    if scene.contact.restitution is not None:
        found.append("a prescribed ratio at impact (contact.restitution; its impact is its own soft contact)")
    if scene.table == "moving":
        found.append("a moving table (table; it accelerates the floor's frame)")
    if scene.wall is not None:
        found.append("a wall")
    if found:
        raise EngineFailure(f"mujoco does not compute {' nor '.join(found)}: leave it out, or ask pymunk or pybullet")


def _xml(scene: Scene, own: MujocoSettings) -> str:
    """The model: a free statue on its feet, a free pedestal, the floor, and a pair for each contact that can occur."""
    statue, pedestal, h = scene.statue, scene.pedestal, scene.statue.centroid_height_m
    stiff = f'solref="{own.stiff_steps * own.dt_s:.9g} 1" solimp="0.9999 0.9999 0.001 0.5 2"'
    i = statue.inertia_tensor_kg_m2
    inertia = " ".join(f"{value:.17g}" for value in (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]))
    feet, pairs = [], []
    support = "floor" if pedestal is None else "pedestal"
    touching = statue.footprint_m if statue.solid is None else statue.solid.feet_m
    for k, (x, y, z) in enumerate(touching):
        place = f"{x:.17g} {y:.17g} {z - h + FOOT_M:.17g}"
        feet.append(f'<geom name="foot{k}" type="sphere" size="{FOOT_M}" pos="{place}" contype="0" conaffinity="0"/>')
        pairs.append(_pair(f"foot{k}", support, scene.contact.statue, stiff))
    bodies = (
        f'<body name="statue"><freejoint/><inertial pos="0 0 0" mass="{statue.mass_kg:.17g}" fullinertia="{inertia}"/>'
    )
    bodies += "".join(feet) + "</body>"
    if pedestal is not None:
        size = f"{0.5 * pedestal.width_m:.17g} {0.5 * pedestal.depth_m:.17g} {0.5 * pedestal.height_m:.17g}"
        box = f'<geom name="pedestal" type="box" size="{size}" mass="{pedestal.mass_kg:.17g}" contype="0" conaffinity="0"/>'
        bodies += f'<body name="block"><freejoint/>{box}</body>'
        pairs.append(_pair("pedestal", "floor", scene.contact.floor_static, stiff, name=FLOOR_PAIR))
    return (
        f'<mujoco><option timestep="{own.dt_s:.17g}" cone="elliptic" solver="Newton" iterations="200" tolerance="1e-14" '
        f'impratio="{own.impedance_ratio:g}"/><worldbody>'
        f'<geom name="floor" type="plane" size="100 100 1" contype="0" conaffinity="0"/>{bodies}</worldbody>'
        f"<contact>{''.join(pairs)}</contact></mujoco>"
    )


def _pair(first: str, second: str, friction: float, stiff: str, name: str = "") -> str:
    named = f'name="{name}" ' if name else ""
    return (
        f'<pair {named}geom1="{first}" geom2="{second}" condim="3" friction="{friction:.17g} {friction:.17g}" {stiff}/>'
    )


def _start(scene: Scene, own: MujocoSettings, data: Any) -> None:
    """Stand the statue on the vertex about which its initial rotation turns it, half a step ahead of t = 0."""
    statue, pedestal = scene.statue, scene.pedestal
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


def _march(
    mujoco: Any, model: Any, scene: Scene, own: MujocoSettings, gravity: Array, want: Want
) -> tuple[Array, dict[str, int]]:
    """All steps: rows of positions and velocities, shape (n + 1, nq + nv)."""
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
        if switching:
            stuck, again = _follow(mujoco, model, data, scene, friction, rows[k], gravity[k] * own.dt_s, stuck)
            repeated += again
        rows[k + 1, :n], rows[k + 1, n:] = data.qpos, data.qvel
        if k % BLOCK_STEPS == 0 and _may_end(own, want, k + 1, _axis(data.qpos[3:7])):
            rows = rows[: k + 2]
            break
    return rows, {"steps_repeated": repeated}


def _may_end(own: MujocoSettings, want: Want, steps: int, axis: tuple[float, float, float]) -> bool:
    """Whether the statue has overturned, or nobody asks further."""
    if want.may_skip("stop_at_overturn") and fallen(*axis):
        return True
    return want.stop is not None and want.stop(steps * own.dt_s, math.atan2(axis[0], axis[2]))


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
    """Let the floor's coefficient follow the sliding state (harness/contact/friction.py); MuJoCo's state is its q and v."""
    rate, last = float(data.qvel[6]), float(before[model.nq + 6])
    if not stuck:
        halted = abs(rate) <= friction.stuck_below_m_s or rate * last < 0.0
        if halted:
            model.pair(FLOOR_PAIR).friction[:2] = friction.static
        return halted, 0
    pedestal_kg = scene.pedestal.mass_kg if scene.pedestal is not None else 0.0
    change = scene.statue.mass_kg * (data.qvel[:3] - before[model.nq : model.nq + 3] - gravity_step)
    change = change + pedestal_kg * (data.qvel[6:9] - before[model.nq + 6 : model.nq + 9] - gravity_step)
    if abs(change[0]) < friction.static * change[2] * SOFT_LIMIT:
        return True, 0
    model.pair(FLOOR_PAIR).friction[:2] = friction.kinetic
    data.qpos[:], data.qvel[:] = before[: model.nq], before[model.nq :]
    mujoco.mj_step(model, data)
    return False, 1


def _back(quaternion: Array, rate: Array, half_s: float) -> tuple[Array, Array]:
    """Rotations (n, 3, 3) taken back by half a step, and angular velocities (n, 3) in the world; `rate` is the body's own."""
    turn = matrices(quaternion[:, [1, 2, 3, 0]])
    nothing = np.zeros(len(rate))
    x, y, z = rate.T
    cross = np.moveaxis(np.array([[nothing, -z, y], [z, nothing, -x], [-y, x, nothing]]), -1, 0)
    return turn - half_s * turn @ cross, np.einsum("nij,nj->ni", turn, rate)


def _tilt(turn: Array, spin: Array) -> Array:
    """Planar rotation of a body from its rotations and angular velocities."""
    return planar(turn[:, :, 2], spin)[0]


def _trajectory(scene: Scene, own: MujocoSettings, t_s: Array, gravity_xz: Array, rows: Array) -> Trajectory:
    """Rows as samples in the table's frame, positions taken back by their half step."""
    pedestal = scene.pedestal is not None
    nq = 14 if pedestal else 7
    q, v, half = rows[:, :nq], rows[:, nq:], 0.5 * own.dt_s
    zero = np.zeros(t_s.size)
    turn, spin = _back(q[:, 3:7], v[:, 3:6], half)
    centroid = q[:, :3] - half * v[:, :3]
    theta, theta_rate = planar(turn[:, :, 2], spin)
    extra = statue_columns(scene.statue, turn, centroid)
    place, rate, slip, slip_rate = None, None, zero, zero
    if pedestal:
        place, rate = q[:, [7, 9]] - half * v[:, [6, 8]], v[:, [6, 8]]
        slip, slip_rate = place[:, 0] - place[0, 0], rate[:, 0]
        extra["pedestal_tilt_rad"] = _tilt(*_back(q[:, 10:14], v[:, 9:12], half))
    return Trajectory(
        t_s,
        theta,
        theta_rate,
        slip,
        slip_rate,
        gravity_xz,
        centroid[:, [0, 2]],
        v[:, [0, 2]],
        place,
        rate,
        extra,
    )
