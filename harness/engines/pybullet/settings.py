"""Settings of a pybullet run: every parameter is sent every time, because some outlive a client."""

from dataclasses import dataclass
from typing import Final, Literal

from harness.engines.base import Settings

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
