"""Which collision shape of the statue a 3D run needs, and why: a pure function of the scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from harness.model.scene import Pedestal, Scene, Statue

HULL_EXCESS_LIMIT: Final = 0.12
"""What a hull may add to the volume near an edge: about what the convex parts themselves add to a statue (docs/meshes.md)."""


@dataclass(frozen=True)
class Need:
    """The shape that meets a pedestal's edge: `base` (vertices alone), `hull` or `parts`.

    `hull_excess_rel` is what the hull adds to the volume of the mesh below `below_m`, the highest that an edge can meet.
    """

    shape: Literal["base", "hull", "parts"]
    hull_excess_rel: float = 0.0
    below_m: float = 0.0


def shape_needed(scene: Scene) -> Need:
    """The cheapest shape that is right: planes touch vertices of the hull, an edge touches what lies between them.

    A level floor and a wall are planes; a statue given by numbers is convex.
    """
    from meshes.collision import hull_excess_rel

    if scene.pedestal is None:
        return Need("base")
    if scene.statue.solid is None:
        return Need("hull")
    below_m = min(edge_reach_m(scene.statue, scene.pedestal), scene.statue.height_m)
    excess = hull_excess_rel(scene.statue.solid, below_m)
    return Need("hull" if excess <= HULL_EXCESS_LIMIT else "parts", excess, below_m)


def edge_reach_m(statue: Statue, pedestal: Pedestal) -> float:
    """Greatest distance from a foot to the pedestal's edge: a body turning on that foot meets the edge with points as far
    from it, hence no higher above the base (while the foot has not slipped).
    """
    centre = statue.base_centre_m + pedestal.offset_m
    far = np.abs(statue.feet_m[:, :2] - np.array([centre, 0.0])) + 0.5 * np.array([pedestal.width_m, pedestal.depth_m])
    return float(np.hypot(far[:, 0], far[:, 1]).max())
