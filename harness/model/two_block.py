"""A scene as the analytic two-block model reads it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final
from weakref import WeakKeyDictionary

from harness.model.scene import OVERTURN_RAD, Scene, Statue

if TYPE_CHECKING:
    from analytic import Block, CommonKeywords, Form, Pedestal, Wall


_BLOCKS: Final[WeakKeyDictionary[Statue, Block]] = WeakKeyDictionary()
"""The blocks of statues that are in use: many runs of one statue need one."""


def block_of(scene: Scene) -> Block:
    """The scene's statue in its rocking plane: the base profile of its mesh, two corners without one."""
    if (found := _BLOCKS.get(scene.statue)) is None:
        found = _BLOCKS[scene.statue] = _block_of(scene.statue)
    return found


def _block_of(statue: Statue) -> Block:
    from analytic import Block

    profile: tuple[tuple[float, float], ...] = ((-statue.corner_left_m, 0.0), (statue.corner_right_m, 0.0))
    if statue.solid is not None and len(statue.solid.base_profile_m) > 2:
        profile = tuple((float(x), float(z)) for x, z in statue.solid.base_profile_m)
    return Block(statue.mass_kg, statue.centroid_height_m, statue.inertia_kg_m2, profile)


def form_of(scene: Scene) -> Form:
    """The form of the model that the scene asks for."""
    from analytic import Form

    return Form(scene.form.friction_normal, scene.contact.restitution, scene.form.pedestal_at_impact)


def pedestal_of(scene: Scene) -> Pedestal | None:
    """The scene's pedestal in its rocking plane."""
    from analytic import Pedestal

    given = scene.pedestal
    return None if given is None else Pedestal(given.mass_kg, given.width_m, given.height_m, given.offset_m)


def wall_of(scene: Scene) -> Wall | None:
    """The scene's wall, and the silhouette that can touch it."""
    from analytic import Wall

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
        "form": form_of(scene),
        "theta0_rad": scene.initial.theta_rad,
        "theta_rate0_rad_s": scene.initial.theta_rate_rad_s,
        "duration_s": scene.duration_s,
        "gravity_m_s2": scene.gravity_m_s2,
        "wall": wall_of(scene),
        "overturn_rad": OVERTURN_RAD,
    }
