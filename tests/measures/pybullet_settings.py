"""The base contact and the solver's settings, settled by measurement: the tables of docs/measured/pybullet_settings.md.

`python -m tests.measures.pybullet_settings [TABLE...]` computes them again, or those named. Errors are against the analytic model
over the first second of the surveyed statue, given by its numbers, under the paper's cases; costs are processor time.
"""

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

import numpy as np
import pybullet

from harness.engines import load
from harness.engines.pybullet import run_phases
from harness.engines.pybullet import statue as body
from harness.engines.pybullet.settings import BulletSettings
from harness.engines.pybullet.world import BulletBackend, World
from harness.engines.stepping.loop import Watch, integrate
from harness.engines.stepping.step_state import Stepper, StepState
from harness.engines.stepping.trajectory import Schedule, StepLog, Trajectory, trajectory
from harness.model import Array, History, Pedestal, RunOptions, Scene
from tests.measures.contact_engines import PAPER, paper_scene
from tests.measures.pages import renew_tables
from tests.measures.pages import table as page_table

Build = Callable[[World, Scene, body.Setup], None]
Cells = list[str]

CLEARANCE_M: Final = 1e-4
"""A box stands this much above the pedestal's own feet, so that only they touch the floor."""
CHOSEN: Final = BulletSettings(dt_s=2.5e-4, expected_error_rad=4e-5)


def _ours(world: World, scene: Scene, setup: body.Setup) -> None:
    world.build(scene)


def _other(statue_box: bool, pedestal_shape: str) -> Build:
    """The statue as a box or on feet, on a pedestal that is a plain box or has feet of its own under a box."""

    def build(world: World, scene: Scene, setup: body.Setup) -> None:
        _ours(world, scene, setup)
        client, radius = world.client, world.settings.foot_radius_m
        # Points that are sought anew in each step are no place to come back to.
        world.edges = True
        p, s, pedestal = scene.pedestal, scene.statue, world.pedestal
        if p is None or pedestal is None:
            raise ValueError("these contacts are compared on a pedestal")
        half = [0.5 * p.width_m, 0.5 * p.depth_m, 0.5 * p.height_m]
        pybullet.removeBody(world.statue, client)
        pybullet.removeBody(pedestal, client)
        # The floor's plane lies a radius lower: what stands on it with a face, not on spheres, stands that much lower.
        if pedestal_shape == "box":
            shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client)
            place = [s.base_centre_m, 0.0, half[2] - radius]
        else:
            shape = _on_feet(half, radius, client)
            place = [s.base_centre_m, 0.0, half[2]]
        world.pedestal = world.add(shape, p.mass_kg, _box_moments(p), place)
        if statue_box:
            size = [0.5 * (s.corner_left_m + s.corner_right_m), 0.5 * s.depth_m, 0.5 * s.height_m]
            shift = [s.base_centre_m, 0.0, size[2] - s.centroid_height_m]
            shape = pybullet.createCollisionShape(
                pybullet.GEOM_BOX, halfExtents=size, collisionFramePosition=shift, physicsClientId=client
            )
        else:
            shape = body.compound(setup.feet_m, radius, client)
        top = 2.0 * half[2] - radius
        height = top + s.centroid_height_m + (0.0 if statue_box else radius)
        world.statue = world.add(shape, s.mass_kg, setup.moments, [0.0, 0.0, height])
        world.surface(world.statue, scene.contact.statue)
        world.surface(world.pedestal, 1.0)

    return build


def _on_feet(half_m: list[float], radius_m: float, client: int) -> int:
    """Spheres at a pedestal's four lower corners under a box that ends a radius below its top."""
    x, y, z = half_m
    corners = [[sx * x, sy * y, -z] for sx in (1.0, -1.0) for sy in (1.0, -1.0)]
    low, high = -z + CLEARANCE_M, z - radius_m
    return int(
        pybullet.createCollisionShapeArray(
            shapeTypes=[pybullet.GEOM_SPHERE] * 4 + [pybullet.GEOM_BOX],
            radii=[radius_m] * 4 + [0.0],
            halfExtents=[[0.0, 0.0, 0.0]] * 4 + [[x, y, 0.5 * (high - low)]],
            collisionFramePositions=[*corners, [0.0, 0.0, 0.5 * (high + low)]],
            physicsClientId=client,
        )
    )


def _box_moments(p: Pedestal) -> Array:
    squares = np.array([p.width_m**2, p.depth_m**2, p.height_m**2])
    return np.asarray(p.mass_kg / 12.0 * (np.sum(squares) - squares))


def measure(scene: Scene, level: BulletSettings, build: Build = _ours, *, half: bool = False) -> tuple[StepLog, float]:
    """Samples of a run with the given bodies, or with half of ours, and processor time per step, µs."""
    setup = body.prepare(scene).halved if half else body.prepare(scene)
    schedule = Schedule(scene, level.dt_s, 0, round(scene.duration_s / level.dt_s))
    gaps = run_phases.gaps_of(scene, setup, level) if level.events else None
    watch = Watch(axis=(0.0, 0.0, 1.0), rest=(0.0, 0.0, 1.0), quiet_from=None, gaps=gaps)
    with World(level, setup) as world:
        build(world, scene, setup)
        start = time.process_time()
        backend = BulletBackend(world, level.dt_s, scene.contact.statue)
        state = StepState(Stepper(backend, scene, schedule), StepLog.begun(backend.read(), 0.0), even=True)
        record = integrate(scene, schedule, watch, state)
        spent = time.process_time() - start
    return record, 1e6 * spent / (len(record.t_s) - 1)


def errors(scene: Scene, path: Trajectory | History) -> tuple[float, float, float]:
    """Largest error of rotation, rad, and of slip, m, and largest rotation out of the plane, rad."""
    engine = load("analytic")
    reference = engine.simulate(scene, engine.refinement_levels(scene)[-1], RunOptions()).history
    if reference is None:
        raise RuntimeError("the analytic model gave no history")
    theta = np.interp(reference.t_s, path.t_s, path.theta_rad)
    slip = np.interp(reference.t_s, path.t_s, path.slip_m)
    across = max(float(np.max(np.abs(path.extra[name]))) for name in ("out_of_plane_rad", "yaw_rad"))
    return (
        float(np.max(np.abs(theta - reference.theta_rad))),
        float(np.max(np.abs(slip - reference.slip_m))),
        across,
    )


def row(name: str, level: BulletSettings, build: Build = _ours, *, pedestal: bool = True, half: bool = False) -> Cells:
    """One line of a table: the four cases, the worst slip and lean across, the mean cost."""
    misses, costs = [], []
    for amplitude, frequency in PAPER:
        scene = paper_scene(amplitude, frequency, pedestal=pedestal)
        record, cost = measure(scene, level, build, half=half)
        misses.append(errors(scene, trajectory(scene, record, np.eye(3), level.dt_s)))
        costs.append(cost)
    return _line(name, misses, costs)


def _line(name: str, misses: Sequence[tuple[float, float, float]], costs: Sequence[float]) -> Cells:
    """A row of a table from each case's errors and cost."""
    _, slip, across = np.max(np.array(misses), axis=0)
    each = ", ".join(f"{item[0]:.1e}" for item in misses)
    return [name, each, f"{slip:.1e}", f"{across:.1e}", f"{np.mean(costs):.0f}"]


def contacts() -> Iterator[Cells]:
    """The choice of bodies."""
    yield row("a box on a box on the floor", CHOSEN, _other(True, "box"))
    yield row("spheres at the base's vertices, on a box on the floor", CHOSEN, _other(False, "box"))
    yield row("the same, the pedestal on spheres too", CHOSEN, _other(False, "feet"))
    yield row("**the same, the pedestal's top a plane (chosen)**", CHOSEN)
    yield row("**half of it, where the scene mirrors itself**", CHOSEN, half=True)


def variations() -> Iterator[Cells]:
    """One setting changed at a time."""
    changes: list[tuple[str, dict[str, Any]]] = [
        ("chosen", {}),
        ("events left inside whole steps", {"events": False}),
        ("radius of the spheres 1 cm", {"foot_radius_m": 1e-2}),
        ("0.1 mm", {"foot_radius_m": 1e-4}),
        ("residual 1e-8", {"residual": 1e-8}),
        ("residual 1e-10", {"residual": 1e-10}),
        ("residual 0, 1000 sweeps", {"residual": 0.0, "iterations": 1000}),
        ("50 sweeps", {"iterations": 50}),
        ("pyramid of friction", {"cone_friction": False}),
        ("bodies in the other order", {"reversed_bodies": True}),
    ]
    for name, change in changes:
        yield row(name, replace(CHOSEN, **change))


HEAD: Final = ("contact or setting", "error of rotation, rad (four cases)", "slip, m", "out of plane, rad", "µs/step")
TABLES: Final[Mapping[str, tuple[Sequence[str], Callable[[], Iterator[Cells]]]]] = {
    "bodies": (HEAD, contacts),
    "settings": (HEAD, variations),
}


def table(name: str) -> str:
    """One table, measured."""
    head, rows = TABLES[name]
    return page_table(head, rows())


if __name__ == "__main__":
    made = {name: partial(table, name) for name in TABLES}
    renew_tables("measured/pybullet_settings.md", "tests.measures.pybullet_settings", made, sys.argv[1:])
