"""Settings of a pybullet run: every parameter is sent every time, because some outlive a client."""

import math
from dataclasses import dataclass, replace
from typing import Final, Literal

from harness.engines.base import Settings
from harness.model import Scene
from harness.statics.plan import asymmetry

REFERENCE_DT_S: Final = 2.5e-4
"""Step at which residual thresholds are quoted; they scale with dt², as the square of a step's change of velocity does."""


@dataclass(frozen=True)
class BulletSettings(Settings):
    """One level: step, whether events inside a step are met by shorter ones, and how long, over its own, the layer stays around
    one (`event_share`), solver, contact.

    `residual` is the squared change of velocity, (m/s)², at `REFERENCE_DT_S` below which solver iterations end early (0: never);
    around an event `event_residual` times that holds, with at most `event_iterations`. `foot_radius_m` is the radius of the
    spheres at the base's vertices, `reach` the gap, in radii of the body, up to which they are contacts while it turns slowly.
    `reversed_bodies` puts the statue before its pedestal: the same solution, by more solver iterations. `turn_rad` is the heading
    of the scene in Bullet's world at first, `axes` whether Bullet's are turned to lie along what slides. `full_shape` is what
    meets a pedestal's edge: what the scene needs (harness/statics/plan.py), or one of two whatever it needs.
    """

    events: bool = True
    event_share: float = 1.0
    iterations: int = 300
    residual: float = 1e-12
    reach: float = 1e-5
    event_iterations: int = 1000
    event_residual: float = 1e-3
    erp: float = 0.02
    foot_radius_m: float = 1e-9
    cone_friction: bool = True
    reversed_bodies: bool = False
    turn_rad: float = 0.0
    axes: Literal["along", "fixed"] = "fixed"
    full_shape: Literal["needed", "hull", "parts"] = "needed"


# Half of a scene that is its own mirror image: each pair of feet across the rocking plane as one, turning in the plane alone.
#
# The two feet of a pair always bear the same there, so that one in the plane bears for both: the same motion from half the
# equations, without the freedom in which a solver's remainder could leave the plane. What a small asymmetry would grow to is not
# asked then; without the skip `mirror` it is. Bullet's rigid bodies serve in place of its multibodies: their solver starts each
# step from the impulses of the last, and their friction, a pyramid along the sliding, is in the plane the same as a cone.


TURN_RAD: Final = 0.25 * math.pi
"""The other heading: half-way between Bullet's axes, where its friction leans to neither."""


def halves(scene: Scene) -> bool:
    """Whether half of the scene tells the whole. A moving table is not one: Bullet's rigid bodies do not feel its velocity."""
    return scene.table == "frame" and asymmetry(scene) is None


def axes_of(scene: Scene) -> Literal["along", "fixed"]:
    """Whether Bullet's axes follow what slides: not where that does so along one of them, as a scene mirrors itself or its
    pedestal is shaken in the plane alone.
    """
    in_line = scene.pedestal is not None and scene.base_excitation.y.peak_m_s2 == 0.0
    return "fixed" if in_line or asymmetry(scene) is None else "along"


def other_axes(scene: Scene, settings: BulletSettings) -> BulletSettings:
    """Bullet's axes otherwise than with `settings`, where something slides askew."""
    if axes_of(scene) == "fixed":
        return settings
    if scene.pedestal is None:
        return replace(settings, axes="fixed", turn_rad=TURN_RAD - settings.turn_rad)
    # A pedestal slides as one: askew to its sides its feet would each lean another way and yaw it, as along them they do not.
    return replace(settings, axes="along" if settings.axes == "fixed" else "fixed")
