"""What makes a closed surface no single statue: it passes through itself, hangs by a point, or a floor hangs on it."""

from typing import Final

import numpy as np

from meshes.beside import Floor, attached_beside, attached_floor
from meshes.mesh import Array, Doubt, Faces, MeshError, RawMesh
from meshes.orientation import up_doubted
from meshes.processing_log import by_part
from meshes.self_intersection import crossings, pinched, wrongly_sided
from meshes.solid import mass_properties

MOST_PINCHED: Final = 0.05
"""Share of the area beyond a pinch from which it is a second body; slivers that a Boolean union leaves have 0.2 %."""
MOST_WRONG: Final = 0.02
"""Share of the area inside out or buried that a scan may have: the mass is wrong by about as much."""


def not_one_body(vertices: Array, faces: Faces) -> MeshError | None:
    """Why a closed surface bounds no single body; None where it does."""
    share, wrong = pinched(vertices, faces), wrongly_sided(vertices, faces)
    advice = "look at it there, and remesh (Blender: Voxel Remesh) or cut it in two"
    if share > MOST_PINCHED:
        got = f"one with {100 * share:.0f} % of its area beyond a neck that crosses itself or is a single point"
        return MeshError("one solid body", got, advice, doubt=Doubt("scan_pinched", {"share": share}))
    if wrong > MOST_WRONG:
        got = f"one with {100 * wrong:.0f} % of its area inside out or buried in itself"
        doubt = Doubt("scan_wrongly_sided", {"share": wrong})
        return MeshError("a surface that does not pass through itself", got, advice, doubt=doubt)
    return None


def floor_refused(floor: Floor | None, how: str) -> MeshError | None:
    """Why a body with this lowest layer seems to stand on a floor of its own; None where it does not.

    `how` is the command that cuts, without its option.
    """
    if floor is None or not floor.certain:
        return None
    cut = f"--cut-below {floor.cut_m:.3g}"
    doubt = Doubt("scan_floor", {"cut_m": floor.cut_m, "times": floor.times, "command": f"{how} {cut}"})
    return _not_alone(f"of which {floor}", how, cut, "--cut-below 0", doubt)


def other_attached(vertices: Array, faces: Faces, how: str) -> MeshError | None:
    """Why a body with z up, in metres, seems to have a wall or a second body on it; None where it does not (`how` as above)."""
    shells = by_part(faces)
    if len(shells) > 1:  # the section of a hollow body is narrow, and no neck
        faces = np.vstack([each for each in shells if mass_properties(vertices, each).volume_m3 > 0.0])
    other = attached_beside(vertices, faces)
    if other is None:
        return None
    cut = f"--cut-beyond {other.azimuth_deg:.5g},{other.distance_m:.3g}"
    lies = "; a figure that lies looks so too: then another up axis makes it a statue that stands"
    doubt = Doubt(other.doubt.code, {**other.doubt.values, "azimuth_deg": other.azimuth_deg, "command": f"{how} {cut}"})
    return _not_alone(f"with {other}", how, cut, "--cut-beyond none", doubt, lies)


def _not_alone(what: str, how: str, cut: str, keep: str, doubt: Doubt, more: str = "") -> MeshError:
    advice = f"cut it off: {f'{how} {cut}'.strip()} ({keep} says that it is the statue's own){more}"
    return MeshError("a statue alone", f"one {what}", advice, doubt=doubt)


def doubts(vertices: Array, faces: Faces, how: str) -> tuple[Doubt, ...]:
    """All of this and what passes through itself elsewhere (`how` as for `floor_refused`)."""
    attached = floor_refused(attached_floor(vertices, faces), how) or other_attached(vertices, faces, how)
    refusals = attached, not_one_body(vertices, faces)
    told = [each.doubt for each in refusals if each is not None and each.doubt is not None]
    return (*told, *up_doubted(RawMesh(vertices, faces, "")), *crossings(vertices, faces))
