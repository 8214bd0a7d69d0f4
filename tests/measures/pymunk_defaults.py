"""pymunk without this project: a space as it comes."""

from dataclasses import dataclass

import numpy as np
import pymunk
from numpy.typing import NDArray

from harness.engines.pymunk.world import rotated
from harness.engines.stepping.trajectory import apparent_gravity, step_count
from harness.model import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EngineDefaults:
    """What is sent besides shapes, masses, inertia, friction and gravity."""

    dt_s: float = 1.0 / 240.0


def run(scene: Scene, defaults: EngineDefaults) -> tuple[Array, Array]:
    """Times, s, and rotations, rad, (n,) of the scene's silhouette on a segment, or on a box for a pedestal."""
    space = pymunk.Space()
    floor = pymunk.Segment(space.static_body, (-1000.0, -1.0), (1000.0, -1.0), 1.0)
    floor.friction = scene.contact.floor_static if scene.pedestal else 1.0
    space.add(floor)
    top = 0.0
    if scene.pedestal is not None:
        given = scene.pedestal
        w, h = 0.5 * given.width_m, 0.5 * given.height_m
        base = pymunk.Body(given.mass_kg, given.mass_kg * (w * w + h * h) / 3.0)
        base.position = (scene.statue.base_centre_m + given.offset_m, h)
        box = pymunk.Poly(base, [(-w, -h), (w, -h), (w, h), (-w, h)])
        box.friction = 1.0
        space.add(base, box)
        top = given.height_m
    body = _statue(scene, top)
    space.add(body, *body.shapes)
    edges: Array = np.arange(step_count(scene.duration_s, defaults.dt_s) + 1, dtype=np.float64) * defaults.dt_s
    theta: Array = np.empty(edges.size)
    theta[0] = scene.initial.theta_rad
    for k, (gx, _, gz) in enumerate(apparent_gravity(scene, edges).tolist()):
        space.gravity = (gx, gz)
        space.step(defaults.dt_s)
        theta[k + 1] = -body.angle
    return edges, theta


def _statue(scene: Scene, top_m: float) -> pymunk.Body:
    statue = scene.statue
    section = statue.section_m - np.array([0.0, statue.centroid_height_m])
    body = pymunk.Body(statue.mass_kg, statue.inertia_kg_m2)
    shape = pymunk.Poly(body, [(float(x), float(z)) for x, z in section])
    shape.friction = scene.contact.statue
    lowest = float(rotated(section, scene.initial.theta_rad)[:, 1].min())
    body.angle, body.position = -scene.initial.theta_rad, (0.0, top_m - lowest)
    return body
