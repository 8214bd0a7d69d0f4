"""What is changed of a scene, one thing at a time: components of the motion, base, inertia, survey, friction, time step."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from analytic.excitation import ZeroExcitation
from harness.input.mesh_statue import statue_of
from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene
from harness.records.effects3d import BASELINE, Group
from meshes import MeshError, Solid
from meshes.roughening import ragged
from meshes.survey import adjusted

GEOMETRY_REL: Final = 0.03
"""Uncertainty of centroid height, corners and inertia: a few per cent, as surveys of one statue differ."""
FRICTION_REL: Final = 0.10
"""Uncertainty of a friction coefficient of stone on stone."""
RAGGED_M: Final = 1e-3
"""Unevenness given to a flat base: what a photogrammetric scan of a real one shows."""
RAGGED_SPACING_M: Final = 0.05
RAGGED_SEED: Final = 1
FLAT_M: Final = 1e-6
"""A base that is more even than this is flat."""


@dataclass(frozen=True)
class Condition:
    """One thing changed: its group, how the scene is changed, whether planar models see it, and its share of the time step."""

    group: Group
    change: Callable[[Scene], Scene]
    planar: bool = True
    step_share: float = 1.0


def solid_of(scene: Scene) -> Solid:
    """The scene's mesh; raises `InputError` for a statue given by numbers alone."""
    if scene.statue.solid is None:
        advice = "a block given by numbers has no azimuth"
        raise InputError(Mistake(str(scene.source or "scene"), "statue.mesh", "a mesh", "numbers alone", advice))
    return scene.statue.solid


def with_solid(scene: Scene, solid: Solid) -> Scene:
    """The same scene with another solid, every number of the statue taken from it."""
    return replace(scene, statue=statue_of(solid))


def turned(scene: Scene, azimuth_deg: float) -> Scene:
    """The scene with the statue turned so that the floor shakes along `azimuth_deg` of the statue's own frame."""
    return with_solid(scene, solid_of(scene).rotated(-azimuth_deg))


def amplified(scene: Scene, factor: float) -> Scene:
    """The scene with all components of the motion scaled alike."""
    return replace(scene, base_excitation=scene.base_excitation.scaled(factor))


def _along(scene: Scene, axes: str) -> Scene:
    """The scene shaken along these axes only."""
    return replace(
        scene,
        base_excitation=replace(
            scene.base_excitation, **{axis: ZeroExcitation() for axis in "xyz" if axis not in axes}
        ),
    )


def _adjusted(**shares: Any) -> Callable[[Scene], Scene]:
    return lambda scene: with_solid(_along(scene, "x"), adjusted(solid_of(scene), **shares))


def _ragged(scene: Scene) -> Scene:
    rough = ragged(solid_of(scene), RAGGED_M, spacing_m=RAGGED_SPACING_M, seed=RAGGED_SEED)
    return with_solid(_along(scene, "x"), rough)


def _rougher(relative: float) -> Callable[[Scene], Scene]:
    def change(scene: Scene) -> Scene:
        scene = _along(scene, "x")
        return replace(scene, contact=replace(scene.contact, statue=(1.0 + relative) * scene.contact.statue))

    return change


CONDITIONS: Final[Mapping[str, Condition]] = {
    BASELINE: Condition("baseline", lambda scene: _along(scene, "x")),
    "with the vertical component": Condition("components", lambda scene: _along(scene, "xz")),
    "with the second horizontal component": Condition("components", lambda scene: _along(scene, "xy"), planar=False),
    "with all three components": Condition("components", lambda scene: scene, planar=False),
    "base ragged by 1 mm": Condition("base", _ragged),
    "base planed flat": Condition("base", _adjusted(flat_base=True)),
    "products of inertia left out": Condition("inertia", _adjusted(products=False), planar=False),
    "centroid 3 % higher": Condition("uncertainty", _adjusted(centroid_rel=GEOMETRY_REL)),
    "centroid 3 % lower": Condition("uncertainty", _adjusted(centroid_rel=-GEOMETRY_REL)),
    "base 3 % wider": Condition("uncertainty", _adjusted(base_rel=GEOMETRY_REL)),
    "base 3 % narrower": Condition("uncertainty", _adjusted(base_rel=-GEOMETRY_REL)),
    "inertia 3 % larger": Condition("uncertainty", _adjusted(inertia_rel=GEOMETRY_REL)),
    "inertia 3 % smaller": Condition("uncertainty", _adjusted(inertia_rel=-GEOMETRY_REL)),
    "friction 10 % larger": Condition("uncertainty", _rougher(FRICTION_REL), planar=False),
    "friction 10 % smaller": Condition("uncertainty", _rougher(-FRICTION_REL), planar=False),
    "half the time step": Condition("numerical", lambda scene: _along(scene, "x"), planar=False, step_share=0.5),
}
"""Every condition by name, the baseline first. `planar` says that the planar models see the change."""


def changed_scene(scene: Scene, condition: str, azimuth_deg: float) -> Scene:
    """The scene under a condition with the statue turned.

    Raises `InputError` for an unknown condition, or where the changed statue does not stand.
    """
    if condition not in CONDITIONS:
        raise InputError(Mistake("conditions", condition, f"one of {', '.join(CONDITIONS)}", repr(condition)))
    try:
        return turned(CONDITIONS[condition].change(scene), azimuth_deg)
    except MeshError as error:
        raise InputError(Mistake(str(scene.source or "scene"), "statue", "a statue that stands", str(error))) from error


def without_meaning(scene: Scene) -> dict[str, str]:
    """The conditions that change nothing of this scene, each with the code of its reason."""
    y, z = (isinstance(item, ZeroExcitation) for item in (scene.base_excitation.y, scene.base_excitation.z))
    flat = float(np.ptp(solid_of(scene).feet_m[:, 2])) < FLAT_M
    reasons = {}
    if z:
        reasons["with the vertical component"] = "motion_has_none"
    if y:
        reasons["with the second horizontal component"] = "motion_has_none"
    if y or z:
        reasons["with all three components"] = "motion_has_fewer"
    if flat:
        reasons["base planed flat"] = "base_flat"
    else:
        reasons["base ragged by 1 mm"] = "base_uneven"
    return reasons
