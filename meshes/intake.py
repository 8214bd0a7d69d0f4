"""A mesh file read into metres with z up: formats, units, up axis. What it cannot use it refuses; it repairs nothing.

PLY and OBJ are read here as they are written: polygons, triangle strips, vertices between faces, indices from the end.
"""

import json
import logging
import re
import warnings
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from meshes.mesh import Array, Faces, MeshError, RawMesh, area_vector, fan, require, triangulated, weld
from meshes.orientation import turn_axis
from meshes.processing_log import EdgeCount, by_part
from meshes.solid import CONTACT_TOLERANCE_M, Solid, mass_properties, solid_from_mesh, turn_about_z

MOST_CORNERS: Final = 50_000
"""Of a polygon cut in its plane, whose time may grow with their square; a larger one is a fan."""
_CONTINUED: Final = re.compile(r"\\[ \t]*\r?\n")
_TYPES: Final = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_STRIP_END: Final = -1
Lists = tuple[Faces, Faces]
"""Entries of all lists one after the other, and how many each list has."""


@dataclass(frozen=True)
class _Property:
    name: str
    kind: str
    count_kind: str = ""


@dataclass(frozen=True)
class _Element:
    name: str
    rows: int
    properties: list[_Property]


def read_obj(data: bytes) -> tuple[Array, Faces]:
    """Vertices (n, 3) and triangles (m, 3) of an OBJ; −1 is the last vertex above the face. ValueError for what is none."""
    coordinates, entries, counts = array("d"), list[int](), list[int]()
    for number, line in enumerate(_CONTINUED.sub(" ", data.decode("utf-8-sig", "replace")).split("\n"), 1):
        row = line.partition("#")[0].split()
        if not row:
            continue
        if row[0] == "v":
            if len(row) < 4:
                raise ValueError(f"line {number}: a vertex of {len(row) - 1} coordinates")
            coordinates.extend(map(float, row[1:4]))
        elif row[0] == "f":
            face, count = [int(corner.partition("/")[0]) for corner in row[1:]], len(coordinates) // 3
            if len(face) < 3 or 0 in face or min(face) < -count:
                raise ValueError(
                    f"line {number}: a face of {len(face)} corner{'s' * (len(face) != 1)}"
                    if len(face) < 3
                    else f"line {number}: a face with vertex {min(face, key=abs)}, where the first is 1"
                    if 0 in face
                    else f"line {number}: a face with vertex {min(face)}, where {count} vertices stand above it"
                )
            entries.extend(index - 1 if index > 0 else count + index for index in face)
            counts.append(len(face))
    vertices = np.array(coordinates).reshape(-1, 3)
    return vertices, _triangulated(vertices, (np.array(entries, dtype=np.int64), np.array(counts, dtype=np.int64)))


def read_ply(data: bytes) -> tuple[NDArray[Any], Faces]:
    """Vertices (n, 3), in single precision where the file's are, and triangles (m, 3). ValueError for what is no PLY."""
    form, elements, body = _header(data)
    if form == "ascii":
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # numpy's word for text that is not a number
            numbers = np.fromstring(data[body:].decode("ascii", "replace"), dtype="<f8", sep=" ")
        data, body = numbers.tobytes(), 0
    vertices, faces = np.empty((0, 3)), [np.empty((0, 3), dtype=np.int64)]
    for element in elements:
        columns, body = _columns(data, body, element)
        if element.name == "vertex":
            missing = [axis for axis in "xyz" if axis not in columns]
            if missing:
                raise ValueError(f"vertices without {', '.join(missing)}")
            vertices = np.column_stack([np.asarray(columns[axis]) for axis in "xyz"])
        for name in ("vertex_indices", "vertex_index"):
            if name in columns and element.name in ("face", "tristrips"):
                lists = columns[name]
                if element.name == "face":
                    faces.append(_triangulated(vertices, lists))
                else:
                    faces.extend(_of_strip(strip) for strip in np.split(lists[0], np.cumsum(lists[1])[:-1]))
    return vertices.astype(np.float32 if vertices.dtype.itemsize == 4 else np.float64), np.vstack(faces)


def _header(data: bytes) -> tuple[str, list[_Element], int]:
    """Format, elements and where the header ends; of text every number is told as it will be held, in double precision."""
    end = re.search(rb"(?:^|\n)[ \t]*end_header[ \t]*\r?\n?", data)
    if end is None or not data.startswith(b"ply"):
        raise ValueError("no header of a PLY")
    lines = [line.split() for line in data[: end.start()].decode("ascii", "replace").splitlines()]
    form = next((words[1] for words in lines if words[:1] == ["format"] and len(words) > 1), "")
    order = ">" if form == "binary_big_endian" else "<"
    kinds = {name: "<f8" if form == "ascii" else order + kind for name, kind in _TYPES.items()}
    elements = list[_Element]()
    for words in lines:
        match words:
            case ["element", name, rows]:
                elements.append(_Element(name, int(rows), []))
            case ["property", "list", counts, kind, name]:
                elements[-1].properties.append(_Property(name, kinds[kind], kinds[counts]))
            case ["property", kind, name]:
                elements[-1].properties.append(_Property(name, kinds[kind]))
    if form not in ("ascii", "binary_little_endian", "binary_big_endian") or any(e.rows < 0 for e in elements):
        raise ValueError(f"format {form!r}")
    return form, elements, end.end()


def _columns(data: bytes, begin: int, element: _Element) -> tuple[dict[str, Any], int]:
    """The columns of an element by name, lists as `Lists`, and where the next element begins."""
    lengths = [0 if each.count_kind else 1 for each in element.properties]
    if element.rows and 0 in lengths:
        lengths = _lengths(data, begin, element.properties)
    dtype = _row(element.properties, lengths)
    size = element.rows * dtype.itemsize
    table = np.frombuffer(data, dtype, element.rows, begin) if begin + size <= len(data) else None
    lists = {k: length for k, length in enumerate(lengths) if element.properties[k].count_kind}
    if table is not None and all((table[f"n{k}"] == length).all() for k, length in lists.items()):
        columns = {each.name: table[f"p{k}"] for k, each in enumerate(element.properties)}
        return columns | {
            element.properties[k].name: (table[f"p{k}"].astype(np.int64).ravel(), np.full(element.rows, length))
            for k, length in lists.items()
        }, begin + size
    if not lists:
        raise ValueError(f"{len(data) - begin} bytes where {element.rows} rows of {element.name} take {size}")
    return _ragged(data, begin, element)


def _row(properties: Sequence[_Property], lengths: Sequence[int]) -> np.dtype[Any]:
    """A row whose lists have these lengths."""
    fields: list[Any] = []
    for k, (each, length) in enumerate(zip(properties, lengths, strict=True)):
        fields += [(f"n{k}", each.count_kind)] if each.count_kind else []
        fields += [(f"p{k}", each.kind, (length,)) if each.count_kind else (f"p{k}", each.kind)]
    return np.dtype(fields)


def _lengths(data: bytes, at: int, properties: Sequence[_Property]) -> list[int]:
    """How long each property of the row that begins at `at` is: 1, or the length of its list."""
    lengths = []
    for each in properties:
        length = 1
        if each.count_kind:
            counted = np.dtype(each.count_kind)
            if at + counted.itemsize > len(data):
                raise ValueError("an end in the middle of a list")
            length = int(np.frombuffer(data, counted, 1, at)[0])
            at += counted.itemsize
        at += length * np.dtype(each.kind).itemsize
        if length < 0 or at > len(data):
            raise ValueError(f"a list of {length} entries")
        lengths.append(length)
    return lengths


def _ragged(data: bytes, begin: int, element: _Element) -> tuple[dict[str, Any], int]:
    """The lists of an element whose rows differ in length; columns beside them are left out."""
    found: dict[str, tuple[list[NDArray[Any]], list[int]]] = {
        p.name: ([], []) for p in element.properties if p.count_kind
    }
    rows: dict[tuple[int, ...], np.dtype[Any]] = {}
    for _ in range(element.rows):
        lengths = _lengths(data, begin, element.properties)
        dtype = rows.setdefault(tuple(lengths), _row(element.properties, lengths))
        row = np.frombuffer(data, dtype, 1, begin)
        begin += dtype.itemsize
        for k, each in enumerate(element.properties):
            if each.count_kind:
                found[each.name][0].append(row[f"p{k}"][0])
                found[each.name][1].append(lengths[k])
    return {
        name: (np.concatenate(entries).astype(np.int64), np.array(counts, dtype=np.int64))
        for name, (entries, counts) in found.items()
    }, begin


def _of_strip(strip: Faces) -> Faces:
    """Triangles (m, 3) of strips that −1 ends: each vertex makes one with the two before it, every second one turned."""
    triangles = [np.empty((0, 3), dtype=np.int64)]
    for piece in np.split(strip, np.flatnonzero(strip == _STRIP_END)):
        run = piece[piece != _STRIP_END]
        if len(run) > 2:
            each = np.column_stack([run[:-2], run[1:-1], run[2:]])
            each[1::2] = each[1::2, [1, 0, 2]]
            triangles.append(each)
    return np.vstack(triangles)


def _triangulated(vertices: NDArray[Any], lists: Lists) -> Faces:
    """Polygons cut into triangles (m, 3): up to four corners as a fan, larger ones in their plane."""
    entries, counts = lists
    if len(entries) and not 0 <= int(entries.min()) <= int(entries.max()) < len(vertices):
        raise MeshError(
            f"faces of vertices 0 to {len(vertices) - 1}",
            f"{int(entries.min())} to {int(entries.max())}",
            "the file is damaged: export it again",
        )
    begins = np.cumsum(counts) - counts
    three, four = begins[counts == 3], begins[counts == 4]
    faces = [
        entries[three[:, None] + [0, 1, 2]],
        entries[four[:, None] + [0, 1, 2]],
        entries[four[:, None] + [0, 2, 3]],
    ]
    for begin, count in zip(begins[counts > 4], counts[counts > 4], strict=True):
        ring = entries[begin : begin + count]
        faces.append(ring[_in_plane(np.asarray(vertices[ring], dtype=np.float64))])
    return np.vstack(faces)


def _in_plane(points: Array) -> Faces:
    """Triangles (n − 2, 3) of a polygon's corners (n, 3), concave ones too, seen along its mean normal."""
    centred = points - points.mean(axis=0)
    normal = area_vector(centred)
    if np.linalg.norm(normal) > 0.0 and len(points) <= MOST_CORNERS:
        triangles = triangulated(centred / np.abs(centred).max(), normal)
        if len(triangles) == len(points) - 2:
            return triangles
    return fan(len(points))


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
    positions = [document["accessors"][part["attributes"]["POSITION"]] for part in parts]
    odd = {
        "triangle fans": any(part.get("mode") == _FAN for part in parts),
        "sparse positions": any("sparse" in each for each in positions),
        "whole numbers for positions": any(each["componentType"] != _FLOAT for each in positions),
    }
    packed = sorted(name for name in named if not _LOOKS.search(name))
    return ", ".join([*packed, *(name for name, there in odd.items() if there)])


def _elements(document: dict[str, Any]) -> int:
    """Elements of all accessors once, and of every mesh as often as a node places it."""
    counts: list[int] = [int(accessor["count"]) for accessor in document.get("accessors", ())]
    sizes: list[int] = [
        sum(counts[part["attributes"]["POSITION"]] + ("indices" in part and counts[part["indices"]]) for part in parts)
        for parts in (mesh["primitives"] for mesh in document.get("meshes", ()))
    ]
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
        place = ascii(str(file).encode("utf-8", "surrogateescape"))[2:-1]
        raise MeshError("a file name in UTF-8", "other bytes", "rename the file", place) from None
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
    for each in (mesh.vertices, mesh.faces):
        each.setflags(write=False)
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
