"""Half of a scene that is its own mirror image: each pair of feet across the rocking plane as one, turning in the plane alone.

The two feet of a pair always bear the same there, so that one in the plane bears for both: the same motion from half the
equations, without the freedom in which a solver's remainder could leave the plane. What a small asymmetry would grow to is not
asked then; without the skip `mirror` it is. Bullet's rigid bodies serve in place of its multibodies: their solver starts each
step from the impulses of the last, and their friction, a pyramid along the sliding, is in the plane the same as a cone.
"""

import math
from dataclasses import replace
from typing import Final, Literal

import numpy as np

from harness.engines.pybullet.settings import BulletSettings
from harness.model import Array, Scene
from harness.statics.plan import SAME, asymmetry

TURN_RAD: Final = 0.25 * math.pi
"""The other heading: half-way between Bullet's axes, where its friction leans to neither."""
LOCKED_KG_M2: Final = 1e20
"""A moment of inertia that nothing turns: across the plane."""


def halves(scene: Scene) -> bool:
    """Whether half of the scene tells the whole. A moving table is not one: Bullet's rigid bodies do not feel its velocity."""
    return scene.table == "frame" and asymmetry(scene) is None


def axes(scene: Scene) -> Literal["along", "fixed"]:
    """Whether Bullet's axes follow what slides: not where that does so along one of them, as a scene mirrors itself or its
    pedestal is shaken in the plane alone.
    """
    in_line = scene.pedestal is not None and scene.base_excitation.y.peak_m_s2 == 0.0
    return "fixed" if in_line or asymmetry(scene) is None else "along"


def other_axes(scene: Scene, settings: BulletSettings) -> BulletSettings:
    """Bullet's axes otherwise than with `settings`, where something slides askew."""
    if axes(scene) == "fixed":
        return settings
    if scene.pedestal is None:
        return replace(settings, axes="fixed", turn_rad=TURN_RAD - settings.turn_rad)
    # A pedestal slides as one: askew to its sides its feet would each lean another way and yaw it, as along them they do not.
    return replace(settings, axes="along" if settings.axes == "fixed" else "fixed")


def halved(feet_m: Array) -> Array:
    """Feet (n, 3) in the plane: one for each pair of `feet_m` (k, 3), one for each foot that lies in it."""
    # The two feet of a pair agree to rounding only.
    first = np.unique(np.round(feet_m[:, [0, 2]] / SAME), axis=0, return_index=True)[1]
    return np.asarray(feet_m[np.sort(first)] * np.array([1.0, 0.0, 1.0]))


def locked(moments_kg_m2: Array) -> Array:
    """Principal moments (3,) of a body that turns in the plane alone."""
    return np.array([LOCKED_KG_M2, moments_kg_m2[1], LOCKED_KG_M2])
