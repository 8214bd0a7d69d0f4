"""What of the statue meets a pedestal's edge: convex bodies in its place, its hull or the parts of a decomposition."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from harness.engines.pybullet import feet
from harness.engines.pybullet.feet import CACHED_STATUES
from harness.engines.pybullet.shapes import inset
from harness.model.scene import Scene, Statue
from harness.statics.plan import shape_needed
from meshes.collision import thinned

Array = NDArray[np.float64]
Kind = Literal["hull", "parts"]

HULL_VERTICES: Final = 256
"""Budget of the hull drawn inside: of a scan's several hundred corners those left out stand out by about a millimetre at most."""


@dataclass(frozen=True, eq=False)
class FullShape:
    """Convex bodies (k, 3) each, statue frame, drawn inside the statue; `no_parts` says why they are its hull where it
    needs convex parts."""

    kind: Kind
    bodies_m: tuple[Array, ...]
    no_parts: str = ""

    @property
    def note(self) -> str:
        """What it is, for the record."""
        return "hull" if self.kind == "hull" else f"{len(self.bodies_m)} convex parts"

    def turned(self, statue: Statue, axes: Array) -> tuple[Array, ...]:
        """The bodies about the statue's centroid along `axes` (3, 3), given as columns."""
        centroid_m = np.array([0.0, 0.0, statue.centroid_height_m])
        return tuple((points - centroid_m) @ axes for points in self.bodies_m)


def full_shape(scene: Scene, wish: Literal["needed", "hull", "parts"] = "needed") -> FullShape:
    """The shape that the scene needs, or the one wished; the hull, with the reason, where parts cannot be made."""
    from meshes import MeshError

    need = shape_needed(scene)
    wanted = need.shape if wish == "needed" else wish
    if wanted != "parts" or scene.statue.solid is None:
        return FullShape("hull", _hull(scene.statue))
    try:
        return FullShape("parts", _parts(scene.statue))
    except MeshError as error:
        return FullShape("hull", _hull(scene.statue), str(error))


@lru_cache(maxsize=CACHED_STATUES)
def _hull(statue: Statue) -> tuple[Array, ...]:
    # Moving the faces makes corners anew: more of them than there were.
    return tuple(thinned(points, HULL_VERTICES)[0] for points in _drawn_inside((feet.hull_vertices(statue),)))


@lru_cache(maxsize=CACHED_STATUES)
def _parts(statue: Statue) -> tuple[Array, ...]:
    from meshes.decomposition import parts_of

    return () if statue.solid is None else _drawn_inside(parts_of(statue.solid).parts)


def _drawn_inside(bodies_m: tuple[Array, ...]) -> tuple[Array, ...]:
    return tuple(body for points in bodies_m if len(body := inset(points)))
