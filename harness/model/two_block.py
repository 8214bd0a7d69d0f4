"""A scene as the analytic two-block model reads it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from analytic.block import Block, Form, Pedestal, Wall
from harness.model.scene import OVERTURN_RAD, Scene, Statue
from harness.model.scene import Pedestal as Support

if TYPE_CHECKING:
    from analytic import CommonKeywords


_BLOCKS: Final[WeakKeyDictionary[Statue, Block]] = WeakKeyDictionary()
"""The blocks of statues that are in use, as on a floor: many runs of one statue need one."""
SAME_M: Final = 1e-9
"""A vertex of the silhouette no further out than this is the base's own."""


def block_of(scene: Scene) -> Block:
    """The scene's statue in its rocking plane: the base profile of its mesh, two corners without one, and where that ends."""
    statue = scene.statue
    if (found := _BLOCKS.get(statue)) is None:
        found = Block(statue.mass_kg, statue.centroid_height_m, statue.inertia_kg_m2, statue.profile_m)
        found = _BLOCKS[statue] = _with_ends(found, statue, None)
    if scene.pedestal is None or min(found.base_ends_rad) == math.inf:
        return found
    return _with_ends(found, statue, scene.pedestal)


def _with_ends(block: Block, statue: Statue, support: Support | None) -> Block:
    left, right = (base_end(statue, support, block, side).lean_rad for side in (-1, 1))
    return replace(block, base_ends_rad=(left, right))


class BaseEnd(NamedTuple):
    """A part of a statue beyond its base: the lean with which it comes down, and its height above the base plane."""

    lean_rad: float = math.inf
    height_m: float = math.nan


def base_end(statue: Statue, support: Support | None, block: Block, side: int) -> BaseEnd:
    """What comes down first as the statue leans to that side (1 right, −1 left) on the outer vertex of its base; infinite where
    nothing does before its balance. Beside the top of the pedestal that is its support, if any, nothing comes down.
    """
    outer_m, height_m = block.profile_m[-1 if side > 0 else 0]
    x, z = statue.section_m.T
    beyond = side * (x - outer_m) > SAME_M
    if support is not None:
        centre_m = statue.base_centre_m + support.offset_m
        beyond &= side * (x - centre_m) <= 0.5 * support.width_m
    leans = np.where(beyond, np.arctan2(z - height_m, side * (x - outer_m)), math.inf)
    first = int(np.argmin(leans))
    return BaseEnd(float(leans[first]), float(z[first])) if leans[first] < block.alpha_rad(side) else BaseEnd()


def pedestal_of(scene: Scene) -> Pedestal | None:
    """The scene's pedestal in its rocking plane."""
    given = scene.pedestal
    return None if given is None else Pedestal(given.mass_kg, given.width_m, given.height_m, given.offset_m)


def wall_of(scene: Scene) -> Wall | None:
    """The scene's wall, and the silhouette that can touch it."""
    if scene.wall is None:
        return None
    return Wall(scene.wall.side, scene.wall.distance_m, tuple((float(x), float(z)) for x, z in scene.statue.section_m))


def keywords(scene: Scene) -> CommonKeywords:
    """The keywords of ``analytic.simulate`` that a scene decides."""
    return {
        "pedestal": pedestal_of(scene),
        "floor_static": scene.contact.floor_static,
        "floor_kinetic": scene.contact.floor_kinetic,
        "floor_impact": scene.contact.floor_impact,
        "statue_friction": scene.contact.statue,
        "form": Form(scene.form.friction_normal, scene.contact.restitution, scene.form.pedestal_at_impact),
        "theta0_rad": scene.initial.theta_rad,
        "theta_rate0_rad_s": scene.initial.theta_rate_rad_s,
        "duration_s": scene.duration_s,
        "gravity_m_s2": scene.gravity_m_s2,
        "wall": wall_of(scene),
        "overturn_rad": OVERTURN_RAD,
        # A run that its energy ends does not say what leaves the model's domain later.
        "skip_energy": False,
    }
