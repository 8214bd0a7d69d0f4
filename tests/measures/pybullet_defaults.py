"""pybullet without this project's settings: its own defaults, or those of virtual_shake_robot_pybullet."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pybullet
from numpy.typing import NDArray

from harness.engines.pybullet.statue import plane
from harness.engines.stepping.trajectory import apparent_gravity, step_count
from harness.model import Scene

Array = NDArray[np.float64]

DEFAULT_BREAKING_M: Final = 0.02
"""Bullet's own threshold; it is global to the process, so it is sent although it is the default."""


@dataclass(frozen=True)
class EngineDefaults:
    """What is sent besides shapes, masses, inertia, friction and gravity; None leaves Bullet's default.

    `margin_m` collision margin of the hull; `damping` linear and angular; `stiffness_n_m`, `contact_damping` of a compliant
    contact; `rolls` also gives spinning and rolling friction the lateral one's coefficient.
    """

    dt_s: float = 1.0 / 240.0
    margin_m: float | None = None
    damping: float | None = None
    breaking_m: float = DEFAULT_BREAKING_M
    iterations: int | None = None
    stiffness_n_m: float | None = None
    contact_damping: float | None = None
    rolls: bool = False


def run(scene: Scene, defaults: EngineDefaults) -> tuple[Array, Array]:
    """Times, s, and rotations, rad, (n,) of the scene's hull on a plane, or on a box for a pedestal."""
    client = int(pybullet.connect(pybullet.DIRECT))
    try:
        pybullet.resetSimulation(physicsClientId=client)
        engine: dict[str, Any] = {"fixedTimeStep": defaults.dt_s, "contactBreakingThreshold": defaults.breaking_m}
        if defaults.iterations is not None:
            engine["numSolverIterations"] = defaults.iterations
        pybullet.setPhysicsEngineParameter(physicsClientId=client, **engine)
        return _stepped(scene, defaults, _built(scene, defaults, client), client)
    finally:
        pybullet.disconnect(client)


def _built(scene: Scene, defaults: EngineDefaults, client: int) -> int:
    """Floor, pedestal and statue; returns the statue's body."""
    floor = pybullet.createMultiBody(0.0, plane((0.0, 0.0, 1.0), client), physicsClientId=client)
    _surface(defaults, floor, scene.contact.floor_static if scene.pedestal else 1.0, client)
    top = 0.0
    if scene.pedestal is not None:
        given = scene.pedestal
        half = [0.5 * given.width_m, 0.5 * given.depth_m, 0.5 * given.height_m]
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client)
        place = [scene.statue.base_centre_m + given.offset_m, 0.0, half[2]]
        body = pybullet.createMultiBody(given.mass_kg, box, basePosition=place, physicsClientId=client)
        _surface(defaults, body, 1.0, client)
        top = given.height_m
    statue, theta = scene.statue, scene.initial.theta_rad
    hull = _hull(scene)
    shape = pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=hull.tolist(), physicsClientId=client)
    turned_z = hull[:, 2] * np.cos(theta) - hull[:, 0] * np.sin(theta)
    turn = pybullet.getQuaternionFromEuler([0.0, theta, 0.0])
    body = pybullet.createMultiBody(
        statue.mass_kg, shape, -1, [0.0, 0.0, top - float(turned_z.min())], turn, physicsClientId=client
    )
    moments = np.diag(statue.inertia_tensor_kg_m2).tolist()
    pybullet.changeDynamics(body, -1, localInertiaDiagonal=moments, physicsClientId=client)
    _surface(defaults, body, scene.contact.statue, client)
    if defaults.margin_m is not None:
        pybullet.changeDynamics(body, -1, collisionMargin=defaults.margin_m, physicsClientId=client)
    return int(body)


def _hull(scene: Scene) -> Array:
    """Vertices (n, 3) of the convex body, from its centroid: the mesh's own hull, a prism of the section without one."""
    statue = scene.statue
    centroid = np.array([0.0, 0.0, statue.centroid_height_m])
    if statue.solid is not None:
        from scipy.spatial import ConvexHull

        vertices = statue.solid.vertices_m
        hull: Array = vertices[ConvexHull(vertices).vertices] - centroid
        return hull
    half = 0.5 * statue.depth_m
    prism = np.array([[x, y, z] for y in (-half, half) for x, z in statue.section_m])
    return np.asarray(prism - centroid, dtype=np.float64)


def _surface(defaults: EngineDefaults, body: int, friction: float, client: int) -> None:
    sent: dict[str, Any] = {"lateralFriction": friction, "restitution": 0.0}
    if defaults.damping is not None:
        sent |= {"linearDamping": defaults.damping, "angularDamping": defaults.damping}
    if defaults.rolls:
        sent |= {"spinningFriction": friction, "rollingFriction": friction}
    if defaults.stiffness_n_m is not None:
        sent |= {"contactStiffness": defaults.stiffness_n_m, "contactDamping": defaults.contact_damping or 0.0}
    pybullet.changeDynamics(body, -1, physicsClientId=client, **sent)


def _stepped(scene: Scene, defaults: EngineDefaults, body: int, client: int) -> tuple[Array, Array]:
    edges: Array = np.arange(step_count(scene.duration_s, defaults.dt_s) + 1, dtype=np.float64) * defaults.dt_s
    theta: Array = np.empty(edges.size)
    theta[0] = scene.initial.theta_rad
    for k, gravity in enumerate(apparent_gravity(scene, edges).tolist()):
        pybullet.setGravity(*gravity, physicsClientId=client)
        pybullet.stepSimulation(physicsClientId=client)
        _, turn = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
        x, y, z, w = turn
        theta[k + 1] = np.arctan2(2.0 * (x * z + w * y), 1.0 - 2.0 * (x * x + y * y))
    return edges, theta
