"""How a run ends whose statue still moves over still ground: by the rule of the analytic model, from the state in which it ends.

Once the floor is at rest the energy decides (docs/model.md, section 7), in the model and in an engine alike: the engine's last
state, in the rocking plane and on a vertex of its base, is asked of the same compiled rule by which the model ends its own runs.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from harness.engines.stepping.support import Corners
from harness.engines.stepping.trajectory import Trajectory
from harness.model.history import Outcome
from harness.model.scene import Scene
from harness.model.two_block import block_of, keywords

if TYPE_CHECKING:
    from analytic import Block

IN_PLANE_RAD: Final = 0.01
"""A body that leaves the plane, has turned about the vertical or stands on a support that tilts by less rocks as the model's."""
ON_SUPPORT: Final = 1e-3
"""Share of the centroid's height by which the vertex it stands on may be off its support: more than a contact's depth or slop."""
NO_TIME_S: Final = 1e-9
"""Length of a run in which nothing but the rule is asked, and what rounding leaves of a duration."""


def by_energy(scene: Scene, motion: Trajectory, at: Corners, still_m_s: float) -> tuple[Outcome, float] | None:
    """Outcome and largest rotation, rad, of what follows the last sample; None for an end that is not the model's.

    The model's: over still ground, in the plane, on a vertex of the base. `at`: where the statue is on its support; `still_m_s`:
    the velocity below which the pedestal rests. One that slides drains energy: what leans beyond its balance then is `undecided`.
    """
    from analytic import AnalyticInputError, Rest, simulate

    lean, rate, block = float(at.lean_rad[-1]), float(motion.theta_rate_rad_s[-1]), block_of(scene)
    if not (_ends_in_plane(scene, motion) and _stands(block, at)):
        return None
    if abs(float(motion.slip_rate_m_s[-1])) > still_m_s:
        over = abs(lean) > block.alpha_rad(1 if lean > 0.0 else -1)
        return Outcome.UNDECIDED if over else Outcome.STANDS, 0.0
    given = keywords(scene)
    wall = given.get("wall")
    if wall is not None:
        given["wall"] = replace(wall, distance_m=wall.distance_m - wall.sign * float(motion.slip_m[-1]))
    given |= {"theta0_rad": lean, "theta_rate0_rad_s": rate, "duration_s": NO_TIME_S, "dt_s": None, "events": False}
    try:
        found = simulate(block, Rest(), **given)
    except AnalyticInputError:  # at the overturning limit already
        return None
    return Outcome(found.outcome.value), found.peak_theta_rad


def _ends_in_plane(scene: Scene, motion: Trajectory) -> bool:
    """Whether the scene's end was reached over still ground, with nothing turned out of the plane."""
    last_s = float(motion.t_s[-1])
    if scene.initial.pose is not None or not scene.base_excitation.end_s <= last_s >= scene.duration_s - NO_TIME_S:
        return False
    turned = [motion.extra[name] for name in ("out_of_plane_rad", "yaw_rad") if name in motion.extra]
    return max(abs(float(each[-1])) for each in (*turned, motion.tilt_rad)) <= IN_PLANE_RAD


def _stands(block: Block, at: Corners) -> bool:
    """Whether the vertex of the base about which the model would turn is on the support."""
    lean, height = float(at.lean_rad[-1]), block.centroid_height_m
    x, z, facets = block.arrays
    k = int(np.searchsorted(facets, lean))
    off_m = float(at.centroid_z[-1]) + float(z[k] - height) * math.cos(lean) - float(x[k]) * math.sin(lean)
    return abs(off_m) <= ON_SUPPORT * height
