"""What makes a closed surface no single statue: it passes through itself, hangs by a point, or a floor hangs on it."""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from meshes.beside import Floor, attached_beside, attached_floor
from meshes.mesh import Array, Doubt, Faces, MeshError, RawMesh, double_areas
from meshes.orientation import up_doubted
from meshes.processing_log import Edges, by_part, connected, parts
from meshes.solid import mass_properties

# Where a surface passes through itself: triangles pierced by another's edge, parts turned inside out by it.


PAIRS = 2_000_000
"""Pairs of faces looked at in one go, about: 200 MB."""
MOST_PAIRS = 50_000_000
"""Pairs after which no more faces are looked at: 30 for each face of a scan, but the square of their number in a fan."""
SHIFT = 1e-9
"""Of the extent: a million times finer than a scan, a million times coarser than rounding."""
SAMPLES = 400
"""Faces drawn to see on which side the body lies: a wrong share of 2 % is missed once in 3000 bodies."""


def crossings(vertices: Array, faces: Faces, most: int = 50_000) -> tuple[Doubt, ...]:
    """That a surface passes through itself: how many of its faces pierce, or are pierced by, one without a common vertex.

    A fixed random choice of at most `most` faces is held against all others; empty where none does.
    """
    chosen = np.random.default_rng(0).permutation(len(faces))[:most]
    piercing, looked_at = _piercing(vertices, faces, chosen, shared=0)
    if not len(piercing):
        return ()
    share = len(piercing) / looked_at
    return (Doubt("scan_crosses_itself", {"faces": len(piercing), "looked_at": looked_at, "share": share}),)


def _piercing(vertices: Array, faces: Faces, chosen: Faces, shared: int) -> tuple[Faces, int]:
    """Those of the faces `chosen` that pierce, or are pierced by, a face with at most `shared` corners in common, and how many of
    them were looked at.
    """
    piercing, looked_at = np.zeros(len(faces), dtype=bool), 0
    # One row for each coordinate and each corner: rows are worked through three times as fast as triples.
    places, corners = np.ascontiguousarray(vertices.T), np.ascontiguousarray(faces.T)
    for one, other, begun in _close_pairs(vertices, faces, chosen):
        looked_at = begun
        common = np.zeros(len(one), dtype=np.int8)
        for ours, theirs in product(corners, corners):
            common += ours[one] == theirs[other]
        one, other = one[common <= shared], other[common <= shared]
        first = [places[:, corner[one]] for corner in corners]
        second = [places[:, corner[other]] for corner in corners]
        through = _pierced(first, second) | _pierced(second, first)
        piercing[one[through]] = True
    return np.flatnonzero(piercing), looked_at


def _close_pairs(vertices: Array, faces: Faces, chosen: Faces) -> Iterator[tuple[Faces, Faces, int]]:
    """Pairs (chosen face, other face) whose bounding boxes overlap, and how many were looked at so far; some at a time so that
    memory stays small, and no more than `MOST_PAIRS`.
    """
    from shapely import STRtree, box

    corners = vertices[faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    first, second, third = np.argsort(np.ptp(vertices, axis=0))[::-1]
    boxes = box(low[:, first], low[:, second], high[:, first], high[:, second])
    tree = STRtree(boxes)
    begin, seen, size = 0, 0, 100
    while begin < len(chosen) and seen < MOST_PAIRS:
        some = chosen[begin : begin + size]
        place, other = tree.query(boxes[some])
        begin, seen = begin + len(some), seen + len(other)
        size = max(1, min(2 * size, PAIRS * begin // seen))
        one = some[place]
        keep = (one != other) & (low[one, third] <= high[other, third]) & (low[other, third] <= high[one, third])
        yield one[keep], other[keep], begin


def _pierced(triangle: Sequence[Array], other: Sequence[Array]) -> NDArray[np.bool_]:
    """Whether any edge of `other` passes through the inside of `triangle`, n of each by their corners (3, n) (signed volumes,
    strictly).
    """
    a, b, c = triangle
    over = [_volume(a, b, c, corner) for corner in other]
    through = np.zeros(a.shape[1], dtype=bool)
    for k, n in ((0, 1), (1, 2), (2, 0)):
        crossing = np.flatnonzero(over[k] * over[n] < 0.0)
        p, q, *corners = (each[:, crossing] for each in (other[k], other[n], a, b, c))
        turns = np.sign([_volume(p, q, corners[m - 1], corners[m]) for m in range(3)])
        through[crossing] |= np.abs(turns.sum(axis=0)) == 3
    return through


def _volume(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Six times the signed volume (n,) of tetrahedra whose corners are (3, n)."""
    return _product(b - a, c - a, d - a)


def _product(u: Array, v: Array, w: Array) -> Array:
    """The triple product (n,) of vectors (3, n)."""
    across = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
    return np.asarray(across[0] * w[0] + across[1] * w[1] + across[2] * w[2])


def pinched(vertices: Array, faces: Faces) -> float:
    """Share of a surface's area that hangs on the rest by a single point, or by faces that pass through one another, alone.

    Shells that share no vertex, such as the wall of a hollow, are looked at each on its own. An hourglass whose wall crosses
    itself all round its neck, or whose neck is one point, is two bodies and no statue. Edges that meet exactly pierce nothing, so
    the corners are first shifted by less than any scanner resolves.
    """
    extent = float(np.ptp(vertices, axis=0).max())
    shifted = vertices + SHIFT * extent * np.random.default_rng(1).uniform(-1.0, 1.0, vertices.shape)
    piercing, shell = _piercing(shifted, faces, np.arange(len(faces)), shared=1)[0], parts(faces)
    left = np.delete(faces, piercing, axis=0)
    if len(left) == 0:
        return 1.0
    edges = Edges.of(left)
    pair = edges.first[edges.faces_at == 2]
    number = connected(len(left), edges.face[pair], edges.face[pair + 1])
    areas = np.bincount(number, weights=np.linalg.norm(double_areas(vertices, left), axis=1))
    largest = np.zeros(int(shell.max()) + 1)
    np.maximum.at(largest, np.delete(shell, piercing), areas[number])
    return 1.0 - float(largest.sum() / areas.sum())


def wrongly_sided(vertices: Array, faces: Faces, samples: int = SAMPLES) -> float:
    """Share of a closed surface's area that does not have the body on its inner side and the outside on its outer one.

    Counted on `samples` faces drawn by area (fixed seed): around a point of a body's surface all other faces together wind half
    a turn; parts turned inside out by a crossing (an hourglass) wind less, parts buried in another one and a half.
    """
    areas = np.linalg.norm(double_areas(vertices, faces), axis=1)
    drawn = np.random.default_rng(0).choice(len(faces), samples, p=areas / areas.sum())
    corners = [np.ascontiguousarray(vertices[corner].T) for corner in faces.T]
    turns = [_turns(corners, int(face)) for face in drawn]
    return sum(abs(each - 0.5) > 0.25 for each in turns) / samples


def _turns(corners: Sequence[Array], own: int) -> float:
    """Winding number about the middle of one triangle of all others, by their corners (3, n) (van Oosterom and Strackee 1983:
    solid angles over 4π).
    """
    middle = np.mean([corner[:, own] for corner in corners], axis=0)
    a, b, c = (corner - middle[:, None] for corner in corners)
    la, lb, lc = (np.sqrt(x * x + y * y + z * z) for x, y, z in (a, b, c))
    under = la * lb * lc
    for one, other, length in ((a, b, lc), (b, c, la), (c, a, lb)):
        under += (one[0] * other[0] + one[1] * other[1] + one[2] * other[2]) * length
    angle = np.arctan2(_product(b, c, a), under)
    angle[own] = 0.0
    return float(angle.sum() / (2.0 * np.pi))


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
        wanted = "a surface that does not pass through itself"
        got = f"one with {100 * wrong:.0f} % of its area inside out or buried in itself"
        return MeshError(wanted, got, advice, doubt=Doubt("scan_wrongly_sided", {"share": wrong}))
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
    told = [each.doubt for each in (attached, not_one_body(vertices, faces)) if each and each.doubt]
    return (*told, *up_doubted(RawMesh(vertices, faces, "")), *crossings(vertices, faces))
