"""A mesh file read into metres with z up: formats, units, up axis. What it cannot use it refuses; it repairs
nothing."""

import json
import logging
import re
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from meshes.mesh import Array, Faces, MeshError, RawMesh, require, weld
from meshes.orientation import turn_axis
from meshes.processing_log import EdgeCount, by_part
from meshes.solid import CONTACT_TOLERANCE_M, Solid, mass_properties, solid_from_mesh, turn_about_z

# What a glTF file says of itself: a kilobyte may ask for gigabytes of zeros, or for one mesh ten thousand times; how it is
# packed.

MOST_ELEMENTS: Final = 100_000_000
"""Vertices and indices of all nodes together: a scan of ten million faces has 35 million."""
_GLB_MARK: Final = b"glTF"
_LOOKS: Final = re.compile("material|texture|light|variant|xmp", re.IGNORECASE)
"""Extensions that change how a surface looks, not where it is."""
_FAN: Final = 6
_FLOAT: Final = 5126
_HEADER: Final = 20
"""Bytes of a GLB before its JSON: mark, version, length; the chunk's length and kind."""


def must_be_readable(file: Path) -> None:
    """Refuse a glTF or GLB whose nodes unfold to more than MOST_ELEMENTS, or whose geometry is packed in a way that is not read;
    what does not parse is left to the reader.
    """
    data = file.read_bytes()
    if data.startswith(_GLB_MARK):
        data = data[_HEADER : _HEADER + int.from_bytes(data[12:16], "little")]
    try:
        document = json.loads(data)
        total, packed = _elements(document), _packed(document)
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return
    require(
        not packed,
        "a glTF whose geometry is plain triangles",
        packed,
        "export it again without compression (Blender reads Draco and writes a plain GLB; gltf-transform copy unpacks"
        " Draco and meshopt)",
        place=str(file),
    )
    require(
        total <= MOST_ELEMENTS,
        f"at most {MOST_ELEMENTS:,} vertices and indices in all nodes",
        f"{total:,}",
        "export the statue alone, decimated",
        place=str(file),
    )


def _packed(document: dict[str, Any]) -> str:
    """What of the geometry is written in a way that is not read; empty for nothing."""
    parts = [part for mesh in document.get("meshes", ()) for part in mesh["primitives"]]
    named = {*document.get("extensionsRequired", ()), *(name for part in parts for name in part.get("extensions", ()))}
    named |= {name for view in document.get("bufferViews", ()) for name in view.get("extensions", ())}
    packed = sorted(name for name in named if not _LOOKS.search(name))
    positions = [document["accessors"][part["attributes"]["POSITION"]] for part in parts]
    packed += ["triangle fans"] if any(part.get("mode") == _FAN for part in parts) else []
    packed += ["sparse positions"] if any("sparse" in each for each in positions) else []
    packed += ["whole numbers for positions"] if any(each["componentType"] != _FLOAT for each in positions) else []
    return ", ".join(packed)


def _elements(document: dict[str, Any]) -> int:
    """Elements of all accessors once, and of every mesh as often as a node places it."""
    counts: list[int] = [int(accessor["count"]) for accessor in document.get("accessors", ())]
    sizes: list[int] = []
    for mesh in document.get("meshes", ()):
        parts = mesh["primitives"]
        used = [part["attributes"]["POSITION"] for part in parts] + [
            part["indices"] for part in parts if "indices" in part
        ]
        sizes.append(sum(counts[index] for index in used))
    placed: list[int] = [node["mesh"] for node in document.get("nodes", ()) if "mesh" in node]
    return sum(counts) + sum(sizes[mesh] for mesh in placed)


FORMATS = (".ply", ".obj", ".stl", ".glb", ".gltf")
UNIT_M = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "km": 1000.0, "in": 0.0254, "ft": 0.3048}
"""Length of each unit in metres."""

TALLEST_M = 50.0
WIDEST = 2.0
"""No statue's diagonal exceeds the tallest's height by more."""
SHORTEST_M = 0.01
"""Heights outside these limits mean a wrong unit, not a statue."""
FINEST_SHARE = 5e-4
"""Share of the largest extent that coordinates resolve: the contact tolerance of 1 mm for a statue of 2 m."""
FAR = 100.0
MANY = 100
"""Of a text: as many vertices all on a grid, so many extents from the origin, have lost digits; a few corners may be round."""
COLLAPSED = 0.01
"""So have, wherever they are, those of which this share of the faces has two corners in one place."""
ON_GRID = 1e-4
"""Rounding of a coordinate over its step: 5e6 m over 1 mm leaves 1e-6."""


def read_mesh(path: str | Path) -> RawMesh:
    """The triangles of a PLY, OBJ, STL, GLB or GLTF file, all its parts in one; raises MeshError if it is not a
    usable mesh."""
    file = Path(path)
    require(
        file.suffix.lower() in FORMATS,
        f"one of {', '.join(FORMATS)}",
        str(file.suffix or "no suffix"),
        "export the scan as PLY or OBJ",
        place=str(file),
    )
    _must_be_there(file)
    if file.suffix.lower() == ".stl":
        _must_be_stl(file)
    if file.suffix.lower() in (".glb", ".gltf"):
        must_be_readable(file)
    vertices, faces = _triangles(file)
    finite = np.isfinite(vertices).all(axis=1)
    count, first = len(vertices) - int(finite.sum()), int(np.argmin(finite)) + 1
    require(
        count == 0,
        "finite coordinates",
        f"NaN or infinite ones ({count} of {len(vertices)} vertices, the first is number {first})",
        "remove them in the scanning software and export again",
        place=str(file),
    )
    return weld(RawMesh(vertices, faces, str(file)))


def _must_be_there(file: Path) -> None:
    """Refuse a name that is no text or too long, and what is no file or an empty one."""
    try:
        str(file).encode("utf-8")
    except UnicodeEncodeError:
        shown = ascii(str(file).encode("utf-8", "surrogateescape"))[2:-1]
        raise MeshError("a file name in UTF-8", "other bytes", "rename the file", place=shown) from None
    try:
        there = file.is_file()
    except OSError as error:
        raise MeshError("a mesh file", str(error.strerror), "check the path", place=str(file)) from error
    require(there, "a mesh file", "none of that name", "check the path", place=str(file))
    require(file.stat().st_size != 0, "a mesh", "an empty file", "export it again", place=str(file))


def _triangles(file: Path) -> tuple[Array, Faces]:
    """Vertices in metres' precision and triangles; what a reader stumbles over becomes one MeshError here."""
    suffix = file.suffix.lower()
    try:
        if suffix in (".ply", ".obj"):
            from meshes.polygon_files import read_obj, read_ply  # else not loaded

            vertices, faces = (read_ply if suffix == ".ply" else read_obj)(file.read_bytes())
        else:
            vertices, faces = _by_trimesh(file)
    except MeshError as error:
        raise error.at(str(file)) from error
    except Exception as error:
        raise MeshError(
            f"a {suffix} mesh", f"a file that does not parse ({_reason(error)})", "export it again", place=str(file)
        ) from error
    require(
        len(faces),
        "a surface of triangles",
        "no face (a point cloud?)",
        "mesh it first, for example by Poisson reconstruction",
        place=str(file),
    )
    require(
        faces.min() >= 0 and faces.max() < len(vertices),
        f"faces of vertices 0 to {len(vertices) - 1}",
        f"{int(faces.min())} to {int(faces.max())}",
        "the file is damaged: export it again",
        place=str(file),
    )
    _must_resolve(vertices, faces, str(file))
    return vertices.astype(np.float64), faces


def _by_trimesh(file: Path) -> tuple[NDArray[Any], Faces]:
    """STL, GLB and glTF, whose coordinates are of single precision (binary STL, glTF) before their nodes place them."""
    import trimesh

    logging.getLogger("trimesh").setLevel(logging.CRITICAL)
    scene = trimesh.load_scene(file, process=False, maintain_order=True, skip_materials=True)
    placed = [part for part in scene.dump() if isinstance(part, trimesh.Trimesh) and len(part.faces)]
    if not placed:
        return np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    offsets = np.cumsum([0, *(len(part.vertices) for part in placed[:-1])])
    vertices = np.vstack([np.asarray(part.vertices, dtype=np.float64) for part in placed])
    faces = np.vstack([np.asarray(part.faces) + offset for part, offset in zip(placed, offsets, strict=True)])
    if vertices.shape[1] != 3:
        raise ValueError("vertices of other than three coordinates")
    own = np.vstack([np.asarray(each.vertices) for each in scene.geometry.values()]).astype(np.float32)
    _must_resolve(own, faces, str(file))
    return vertices, faces.astype(np.int64)


def _must_resolve(vertices: NDArray[Any], faces: Faces, place: str) -> None:
    """Refuse coordinates too coarse for the body: of single precision far from their origin, or written with too few digits."""
    low, high = vertices.min(axis=0).astype(np.float64), vertices.max(axis=0).astype(np.float64)
    extent, offset = float((high - low).max()), float(np.abs([low, high]).max())
    if not np.isfinite(offset) or extent == 0.0:
        return
    step = float(np.spacing(np.float32(offset) if vertices.dtype == np.float32 else offset))
    if vertices.dtype != np.float32 and step <= FINEST_SHARE * extent:
        step = _grid(vertices, FINEST_SHARE * extent)
        collapsed = float((vertices[faces] == vertices[np.roll(faces, 1, axis=1)]).all(axis=2).any(axis=1).mean())
        if collapsed < COLLAPSED and (offset < FAR * extent or len(vertices) < MANY):
            return
    require(
        step <= FINEST_SHARE * extent,
        f"coordinates that resolve a {1.0 / FINEST_SHARE:.0f}th of the body's {extent:.4g} units",
        f"coordinates that resolve only {step:.3g} units, at {offset:.7g} units from their origin",
        "subtract the offset in the scanning software (CloudCompare: Global Shift) before it writes single"
        " precision, or export in double precision with more digits",
        place=place,
    )


def _grid(vertices: Array, finest: float) -> float:
    """The coarsest step, decimal or binary, of which all coordinates of some axis that varies are multiples; 0 if finer than
    `finest`.
    """
    some = vertices[:: max(1, len(vertices) // 10_000)]
    steps = 10.0 ** np.arange(np.ceil(np.log10(finest)), 9.0), 2.0 ** np.arange(np.ceil(np.log2(finest)), 30.0)
    found = 0.0
    for axis in some.T[np.ptp(some, axis=0) > finest]:
        for step in np.concatenate(steps):
            if found < step <= np.ptp(axis) and np.abs(axis / step - np.round(axis / step)).max() < ON_GRID:
                found = float(step)
    return found


def _must_be_stl(file: Path) -> None:
    """Refuse a file that is neither of the two forms of STL before a reader guesses at its encoding."""
    size = file.stat().st_size
    with file.open("rb") as stream:
        head = stream.read(1024)
    count = int.from_bytes(head[80:84], "little")
    text = head.lstrip().startswith(b"solid") and b"facet" in head
    require(
        text or (len(head) >= 84 and size == 84 + 50 * count),
        "an STL",
        f"{size} bytes that are neither a binary one (84, and 50 for each triangle) nor one in text (solid … facet …)",
        "export it again",
        place=str(file),
    )


def _reason(error: Exception) -> str:
    """What the reader stumbled over, in a few words; its own errors are often those of an array that did not fit."""
    if isinstance(error, NameError | AttributeError):
        # The reader's own mistake on what it did not expect tells nothing of the file.
        return "its content is not that of such a file"
    text = " ".join(str(error).split())
    plain = isinstance(error, ValueError | LookupError | TypeError | ImportError) or not text
    return f"its content is not that of such a file: {text[:80] or type(error).__name__}" if plain else text[:160]


def unit_length_m(unit: str | float) -> float:
    """Metres per unit of the file, from a unit's name or a number of metres; raises MeshError for anything else."""
    if isinstance(unit, str) and unit in UNIT_M:
        return UNIT_M[unit]
    if isinstance(unit, int | float) and not isinstance(unit, bool) and np.isfinite(unit) and unit > 0.0:
        return float(unit)
    raise MeshError(f"a unit out of {', '.join(UNIT_M)} or its length in metres", f"{unit!r}")


def to_metres_z_up(mesh: RawMesh, unit: str | float, up: str) -> RawMesh:
    """The mesh in metres with `up` turned to +z; raises MeshError for an unknown unit or axis, or an absurd height."""
    vertices = unit_length_m(unit) * mesh.vertices @ turn_axis(up).T
    height = float(np.ptp(vertices[:, 2]))
    must_have_size(height, f"{height:.4g} m with unit {unit!r} and up {up!r}", mesh.source)
    return mesh.moved(vertices)


def load_solid(
    path: str | Path,
    *,
    unit: str | float,
    up: str = "z",
    azimuth_deg: float = 0.0,
    density_kg_m3: float | None = None,
    mass_kg: float | None = None,
    contact_tolerance_m: float = CONTACT_TOLERANCE_M,
) -> Solid:
    """The solid of a clean mesh file, turned by `azimuth_deg` about the vertical (counter-clockwise from above).

    Nothing is repaired: a mesh with holes, with edges of more than two faces, of several bodies, inside out, or that does not
    stand raises MeshError with what to do.
    """
    mesh = closed_mesh(path, unit, up)
    if azimuth_deg != 0.0:
        mesh = mesh.moved(mesh.vertices @ turn_about_z(azimuth_deg).T)
    try:
        return solid_from_mesh(
            mesh.vertices,
            mesh.faces,
            density_kg_m3=density_kg_m3,
            mass_kg=mass_kg,
            contact_tolerance_m=contact_tolerance_m,
        )
    except MeshError as error:
        raise error.at(mesh.source) from error


def closed_mesh(path: str | Path, unit: str | float, up: str) -> RawMesh:
    """The one closed surface of a file, in metres, z up, not to be written to; raises MeshError where it is none."""
    file = Path(path)
    _must_be_there(file)
    state = file.stat()
    return _closed(file, unit, up, (state.st_mtime_ns, state.st_size))


@lru_cache(maxsize=2)
def _closed(path: Path, unit: str | float, up: str, _state: tuple[int, int]) -> RawMesh:
    """The one closed surface of a file as it is now, in metres and upright: hundreds of draws read it, each with another mass or
    base.
    """
    mesh = to_metres_z_up(read_mesh(path), unit, up)
    must_be_closed(mesh)
    must_be_one(mesh)
    for array in (mesh.vertices, mesh.faces):
        array.setflags(write=False)
    return mesh


def must_be_closed(mesh: RawMesh) -> None:
    """Refuse a surface that does not bound a volume: open, inconsistently wound or branching edges."""
    count = EdgeCount.of(mesh.faces)
    require(
        count.closed,
        "a closed surface",
        f"{count.boundary} edges with one face, {count.branching} with more than two and {count.misoriented}"
        " between faces of opposite orientation",
        "close it with rockcheck mesh prepare, which writes what it changed",
        place=mesh.source,
    )


def must_be_one(mesh: RawMesh) -> None:
    """Refuse several bodies in one file; a closed shell with its faces inward, inside the body, is a hollow in it."""
    shells = by_part(mesh.faces)
    if len(shells) == 1:
        return
    volumes = [mass_properties(mesh.vertices, shell).volume_m3 for shell in shells]
    bodies = sum(volume > 0.0 for volume in volumes)
    sizes = ", ".join(f"{volume:.3g} m³" for volume in sorted(volumes, reverse=True)[:4])
    require(
        bodies <= 1,
        "one body",
        f"{bodies} of {sizes}",
        "export each to a file of its own, or join those that overlap and drop debris with rockcheck"
        " mesh prepare, which writes what it changed",
        place=mesh.source,
    )


def must_have_thickness(mesh: RawMesh) -> None:
    """Refuse a flat sheet before anything is made of it."""
    extent = np.ptp(mesh.vertices, axis=0)
    flat = f"a flat sheet of {' × '.join(f'{each:.4g}' for each in extent)} units"
    require(extent.min() >= 0.01 * extent.max(), "a body", flat, "scan it from all sides", place=mesh.source)


def must_be_of_a_statue_s_size(mesh: RawMesh, unit: str | float | None) -> None:
    """Refuse an absurd unit before the up axis is looked for: whichever it is, no statue has such a diagonal."""
    if unit is None:
        return
    size = unit_length_m(unit) * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    got = f"a body of {size:.4g} m from corner to corner with unit {unit}"
    must_have_size(size, got, mesh.source, WIDEST * TALLEST_M)


def must_have_size(size_m: float, got: str, place: str, most_m: float = TALLEST_M) -> None:
    """Refuse what is of no statue's size; `got` tells it."""
    wanted = f"a statue between {SHORTEST_M:g} and {TALLEST_M:g} m high"
    require(SHORTEST_M <= size_m <= most_m, wanted, got, "check the unit the scan was exported in", place)
