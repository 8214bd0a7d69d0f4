"""A scene as MuJoCo's model: the statue stands on small spheres at the vertices that can touch, and touches with nothing else."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.model.scene import Scene

Array = NDArray[np.float64]

FOOT_M: Final = 1e-4
"""Radius of the spheres at the base's vertices, on which it stands."""
POINT_M: Final = 1e-7
"""Radius of those at all outer points of what is thrown: they lie outside of it by this, whichever way is down."""
IMPEDANCE: Final = {True: 0.9999, False: 0.99}
"""Share of a contact's acceleration that its force gives, with a pedestal and without. At 0.9999 a foot lies 0.2 nm deep at
0.25 ms: rounding lifts it off while it bears load, and MuJoCo drops a contact, its friction too, where it sees a gap. At 0.99 it
lies 25 nm deep; on a pedestal, itself on soft contacts, that costs more than it cures."""
IMPEDANCE_RATIO: Final = {True: 100.0, False: 1e4}
"""Friction's impedance over the normal's: friction as firm as at 0.9999 and 100."""
FLOOR_PAIR: Final = "pedestal on floor"


def model_xml(scene: Scene, dt_s: float, stiff_steps: float) -> str:
    """The model's text: a free statue on its feet, a free pedestal, the floor, and a pair for each contact that can occur.

    stiff_steps: the contact's time constant in steps of dt_s.
    """
    statue, pedestal = scene.statue, scene.pedestal
    impedance = IMPEDANCE[pedestal is not None]
    stiff = f'solref="{stiff_steps * dt_s:.9g} 1" solimp="{impedance} {impedance} 0.001 0.5 2"'
    i = statue.inertia_tensor_kg_m2
    # 17 digits keep every bit of a number on its way through the text.
    inertia = " ".join(f"{value:.17g}" for value in (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]))
    feet, pairs = [], []
    support = "floor" if pedestal is None else "pedestal"
    radius = FOOT_M if scene.initial.pose is None else POINT_M
    for k, (x, y, z) in enumerate(_feet(scene)):
        place = f"{x:.17g} {y:.17g} {z:.17g}"
        feet.append(f'<geom name="foot{k}" type="sphere" size="{radius}" pos="{place}" contype="0" conaffinity="0"/>')
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
        f'<mujoco><option timestep="{dt_s:.17g}" integrator="{integrator(scene)}" cone="elliptic" solver="Newton" '
        f'iterations="200" tolerance="1e-14" impratio="{IMPEDANCE_RATIO[pedestal is not None]:g}"/><worldbody>'
        f'<geom name="floor" type="plane" size="100 100 1" contype="0" conaffinity="0"/>{bodies}</worldbody>'
        f"<contact>{''.join(pairs)}</contact></mujoco>"
    )


def integrator(scene: Scene) -> str:
    """MuJoCo's integrator: that of order four where a body is thrown, as the Euler one's gyroscopic torque is of first order."""
    return "Euler" if scene.initial.pose is None else "RK4"


def _feet(scene: Scene) -> Array:
    """Centres of the feet from the centroid (n, 3): of the base's vertices, or of all outer points of what is thrown."""
    statue = scene.statue
    if scene.initial.pose is not None:
        return statue.outer_points_m
    return np.asarray(statue.feet_m + np.array([0.0, 0.0, FOOT_M - statue.centroid_height_m]))


def _pair(first: str, second: str, friction: float, stiff: str, name: str = "") -> str:
    named = f'name="{name}" ' if name else ""
    return (
        f'<pair {named}geom1="{first}" geom2="{second}" condim="3" friction="{friction:.17g} {friction:.17g}" {stiff}/>'
    )
