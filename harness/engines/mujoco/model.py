"""A scene as MuJoCo's model: the statue stands on small spheres at the vertices that can touch, and touches with nothing else."""

from __future__ import annotations

from typing import Final

from harness.model.scene import Scene

FOOT_M: Final = 1e-4
"""Radius of the spheres at the base's vertices."""
FLOOR_PAIR: Final = "pedestal on floor"


def model_xml(scene: Scene, dt_s: float, stiff_steps: float, impedance_ratio: float) -> str:
    """The model's text: a free statue on its feet, a free pedestal, the floor, and a pair for each contact that can occur.

    stiff_steps: the contact's time constant in steps of dt_s; impedance_ratio: friction's over the normal's.
    """
    statue, pedestal, h = scene.statue, scene.pedestal, scene.statue.centroid_height_m
    stiff = f'solref="{stiff_steps * dt_s:.9g} 1" solimp="0.9999 0.9999 0.001 0.5 2"'
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
        f'<mujoco><option timestep="{dt_s:.17g}" cone="elliptic" solver="Newton" iterations="200" tolerance="1e-14" '
        f'impratio="{impedance_ratio:g}"/><worldbody>'
        f'<geom name="floor" type="plane" size="100 100 1" contype="0" conaffinity="0"/>{bodies}</worldbody>'
        f"<contact>{''.join(pairs)}</contact></mujoco>"
    )


def _pair(first: str, second: str, friction: float, stiff: str, name: str = "") -> str:
    named = f'name="{name}" ' if name else ""
    return (
        f'<pair {named}geom1="{first}" geom2="{second}" condim="3" friction="{friction:.17g} {friction:.17g}" {stiff}/>'
    )
