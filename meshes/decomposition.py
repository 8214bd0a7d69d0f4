"""Convex parts of a statue (CoACD): each within the statue's hull and a vertex budget, made once for a mesh and then kept."""

import hashlib
import json
import signal
import subprocess
import sys
import tempfile
from functools import lru_cache
from importlib import metadata, util
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from meshes import coacd_alone, text_cache
from meshes.mesh import Array, MeshError, RawMesh, require
from meshes.prepare import simplified
from meshes.solid import Solid, thinned

COARSE_FACES: Final = 3000
"""Triangles given to the search: its time grows with them, its parts hardly change (20-fold slower at 21 000)."""
CONCAVITY: Final = 0.05
"""Where the parts' error stops falling on generated and scanned statues alike (`python -m tests.measures.exact_shapes`)."""
MAX_PARTS: Final = 32
MAX_VERTICES: Final = 64
LONGEST_S: Final = 300.0
"""Longest wait for a decomposition: twenty times the costliest of the table (`python -m tests.measures.exact_shapes`)."""
FORM: Final = 2
"""Number of what `decompose` does: raised when the same mesh would give other parts, so that kept ones are not taken."""


Parts = tuple[Array, ...]
"""Convex parts of a statue, each by its corners (k, 3) in the statue frame."""


def missing() -> str | None:
    """Why nothing can be decomposed here, in half a sentence, or None."""
    return None if util.find_spec("coacd") else "coacd is not installed (pip install coacd)"


@lru_cache(maxsize=8)
def parts_of(
    solid: Solid, concavity: float = CONCAVITY, max_parts: int = MAX_PARTS, max_vertices: int = MAX_VERTICES
) -> Parts:
    """`decompose`, once for a mesh: kept in memory and in the user's cache folder, under the mesh and everything that counts.

    Raises `MeshError` as `decompose` does.
    """
    reason = missing()
    require(not reason, "a convex decomposition", f"none: {reason}")

    def made() -> str:
        return json.dumps([corners.tolist() for corners in decompose(solid, concavity, max_parts, max_vertices)])

    state = _state(solid, concavity, max_parts, max_vertices)
    return tuple(np.array(each) for each in json.loads(text_cache.made_once("parts", state, made)))


def decompose(
    solid: Solid,
    concavity: float = CONCAVITY,
    max_parts: int = MAX_PARTS,
    max_vertices: int = MAX_VERTICES,
    seed: int = 0,
) -> Parts:
    """Convex decomposition (Wei et al. 2022, CoACD) of the coarsened body; deterministic for a seed.

    `concavity` is CoACD's threshold, the depth left between a part and its hull relative to the body's size (0.01 to 1). Parts
    are cut off at the statue's own hull and keep at most `max_vertices` of their vertices. Raises `MeshError` for a concavity
    out of range, or where nothing is found; one whose search ended without an answer is not searched again by this process.
    """
    from manifold3d import Manifold

    require(0.01 <= concavity <= 1.0, "a concavity between 0.01 and 1", f"{concavity:g}")
    coarse = simplified(RawMesh(solid.vertices_m, solid.faces, "solid"), COARSE_FACES, solid.contact_tolerance_m)
    vertices, faces = (solid.vertices_m, solid.faces) if isinstance(coarse, dict) else (coarse.vertices, coarse.faces)
    raw = _searched(vertices, faces, (concavity, max_parts, seed))
    hull = Manifold.hull_points(np.array(solid.vertices_m))
    inside = [Manifold.hull_points(points) ^ hull for points in raw]
    points = [np.array(piece.to_mesh64().vert_properties[:, :3]) for piece in inside if not piece.is_empty()]
    require(points, "convex parts of the statue", "an empty decomposition")
    return tuple(thinned(corners, max_vertices)[0] for corners in points)


def _searched(vertices_m: Array, faces: NDArray[Any], options: tuple[float, int, int]) -> list[Array]:
    """The corners of CoACD's parts, from a process of its own. Raises `MeshError` where that ends without an answer."""
    digest = hashlib.sha256(vertices_m.tobytes() + faces.tobytes() + repr(options).encode()).digest()
    if digest in _FAILED:
        raise MeshError("convex parts of the statue", _FAILED[digest])
    with tempfile.TemporaryDirectory(prefix="rockcheck-parts-") as folder:
        given, answer = Path(folder) / "mesh.npz", Path(folder) / "parts.npz"
        np.savez(given, vertices_m=vertices_m, faces=faces.astype(np.int32), options=np.array(options))
        # -P: what stands beside the file must not be taken for packages of the same names.
        command = [sys.executable, "-P", coacd_alone.__file__, str(given), str(answer)]
        try:
            code = subprocess.run(
                command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=LONGEST_S
            ).returncode
            cause = f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended with code {code}"
        except subprocess.TimeoutExpired:
            code, cause = 1, f"gave no answer in {LONGEST_S:g} s"
        if code or not answer.is_file():
            _FAILED[digest] = f"a search for them (CoACD) that {cause}"
            raise MeshError("convex parts of the statue", _FAILED[digest])
        with np.load(answer) as arrays:
            return np.split(arrays["corners"], np.cumsum(arrays["counts"])[:-1])


_FAILED: Final[dict[bytes, str]] = {}
"""Searches that ended without an answer: every level of a climb would end so again."""


def _state(solid: Solid, *parameters: float) -> bytes:
    """The mesh, the parameters and the programs that make the parts."""
    made_by = [metadata.version(name) for name in ("coacd", "fast-simplification", "manifold3d")]
    settings = repr((FORM, COARSE_FACES, solid.contact_tolerance_m, parameters, made_by)).encode()
    return solid.vertices_m.tobytes() + solid.faces.tobytes() + settings
