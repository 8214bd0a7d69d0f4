"""When a run's steps were Chipmunk's own: what the layer that meets events assumes did not hold.

The layer takes a statue that stands on one vertex which holds, on a level support that goes on under it. Where that is not so,
steps are plain, converge at first order as those of any loop do, and events inside them are not located.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.pymunk.drive import RunState
from harness.engines.pymunk.standing import HELD_SHARE, RISES, TIPPED_RAD, SupportVertex
from harness.model.scene import OVERTURN_RAD

Array = NDArray[np.float64]

SLIDE_M_S: Final = 1e-3
"""Velocity of a vertex along its support that is a slip: a solver's remainder at rest is less than 1e-5 m/s."""
REASONS: Final = {
    "tips": "the pedestal tips",
    "slides": "the statue slides on its support",
    "flies": "the statue has left its support",
    "edge": "the statue stands beyond its pedestal's edge",
}


def plain_spells(drive: RunState, standing: SupportVertex) -> Mapping[str, Any]:
    """`plain_from_s`, the first instant at which the steps were plain (None: never), `plain_for_s`, for how long altogether,
    and `plain_because`, the reasons in the order in which they came.
    """
    if not drive.aligned:
        return {
            "plain_from_s": drive.times_s[0],
            "plain_for_s": drive.times_s[-1] - drive.times_s[0],
            "plain_because": ["asked for"],
        }
    # Block by block: a long run asked for its outcome alone keeps no arrays of its length for this.
    with np.errstate(invalid="ignore", over="ignore"):  # a run that diverged holds numbers that are not finite
        blocks = [_causes(drive, standing, states) for states in drive.states if len(states)]
    causes = {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}
    t_s, over = np.array(drive.times_s), causes.pop("over")
    if over.any():
        t_s = t_s[: over.argmax() + 1]
        causes = {name: spell[: t_s.size] for name, spell in causes.items()}
    left = np.any(list(causes.values()), axis=0)
    if not left.any():
        return {"plain_from_s": None, "plain_for_s": 0.0, "plain_because": []}
    # A sample is the end of its step.
    lengths = np.diff(t_s, prepend=t_s[0])
    first = {name: float(t_s[spell.argmax()]) for name, spell in causes.items() if spell.any()}
    return {
        "plain_from_s": min(first.values()),
        "plain_for_s": float(lengths[left].sum()),
        "plain_because": [REASONS[name] for name in sorted(first, key=lambda name: first[name])],
    }


def _causes(drive: RunState, standing: SupportVertex, states: Array) -> dict[str, Array]:
    """By reason, whether it held at each recorded state, shape (n,); `over`: whether the statue had overturned."""
    world, pedestal = drive.world, drive.scene.pedestal
    place_x, place_z, angle, rate_x, _, spin = states[:, world.statue_slice].T
    below = np.zeros((len(states), 6))
    if pedestal is not None:
        below = states[:, world.pedestal_slice]
    elif drive.moving:
        below = states[:, -6:]
    tilt = below[:, 2] if pedestal is not None else np.zeros(len(states))
    points = np.array(standing.points)
    x, z = points[np.searchsorted(standing.level_rad, angle - tilt)].T
    arm_x, arm_z = x * np.cos(angle) - z * np.sin(angle), x * np.sin(angle) + z * np.cos(angle)
    # A velocity may be the tangent of a part of a step further on.
    turn = np.abs(spin) * drive.settings.dt_s
    slide = np.abs(rate_x - spin * arm_z - below[:, 3])
    off = np.maximum(SLIDE_M_S, (HELD_SHARE + 2.0 * turn) * np.abs(spin) * standing.height_m)
    gap = place_z + arm_z - below[:, 1] - standing.half_m - (place_x + arm_x - below[:, 0]) * tilt
    near = RISES * (drive.settings.depth_m + standing.height_m * turn**2)
    causes = {"slides": (slide > off) & (gap <= near), "flies": gap > near, "over": np.abs(angle) >= OVERTURN_RAD}
    if pedestal is not None:
        causes["tips"] = np.abs(tilt) > TIPPED_RAD
        causes["edge"] = np.abs(place_x + arm_x - below[:, 0]) > 0.5 * pedestal.width_m
    return causes
