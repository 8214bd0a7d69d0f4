"""PLY and OBJ as they are written: polygons, triangle strips, vertices between faces, indices from the end."""

import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from meshes.mesh import Array, Faces, MeshError, area_vector, fan, triangulated

CHUNK: Final = 100_000
"""Vertices held as text in one go."""
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
    vertices, rows, count = [np.empty((0, 3))], list[list[str]](), 0
    entries, counts = list[int](), list[int]()
    for number, line in enumerate(_CONTINUED.sub(" ", data.decode("utf-8-sig", "replace")).split("\n"), 1):
        row = line.partition("#")[0].split()
        if not row:
            continue
        if row[0] == "v":
            if len(row) < 4:
                raise ValueError(f"line {number}: a vertex of {len(row) - 1} coordinates")
            rows.append(row[1:4])
            count += 1
            if len(rows) == CHUNK:
                vertices.append(np.array(rows, dtype=np.float64))
                rows = []
        elif row[0] == "f":
            face = [int(corner.partition("/")[0]) for corner in row[1:]]
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
    if rows:
        vertices.append(np.array(rows, dtype=np.float64))
    return _triangulated(np.vstack(vertices), (np.array(entries, dtype=np.int64), np.array(counts, dtype=np.int64)))


def read_ply(data: bytes) -> tuple[NDArray[Any], Faces]:
    """Vertices (n, 3), in single precision where the file's are, and triangles (m, 3). ValueError for what is no PLY."""
    form, elements, body = _header(data)
    if form == "ascii":
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # numpy's word for text that is not a number
            numbers = np.fromstring(data[body:].decode("ascii", "replace"), dtype="<f8", sep=" ")
        data, body = numbers.tobytes(), 0
        plain = [_Property(each.name, "<f8", each.count_kind and "<f8") for e in elements for each in e.properties]
        kinds = iter(plain)
        elements = [_Element(e.name, e.rows, [next(kinds) for _ in e.properties]) for e in elements]
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
                    faces.append(_triangulated(vertices, lists)[1])
                else:
                    faces.extend(_of_strip(strip) for strip in np.split(lists[0], np.cumsum(lists[1])[:-1]))
    kind = np.float32 if vertices.dtype.itemsize == 4 else np.float64
    return vertices.astype(kind), np.vstack(faces)


def _header(data: bytes) -> tuple[str, list[_Element], int]:
    """Format, elements and where the header ends."""
    end = re.search(rb"(?:^|\n)[ \t]*end_header[ \t]*\r?\n?", data)
    if end is None or not data.startswith(b"ply"):
        raise ValueError("no header of a PLY")
    form, elements = "", list[_Element]()
    for line in data[: end.start()].decode("ascii", "replace").splitlines():
        match line.split():
            case ["format", form, *_]:
                pass
            case ["element", name, rows]:
                elements.append(_Element(name, int(rows), []))
            case ["property", "list", counts, kind, name]:
                elements[-1].properties.append(_Property(name, _TYPES[kind], _TYPES[counts]))
            case ["property", kind, name]:
                elements[-1].properties.append(_Property(name, _TYPES[kind]))
    if form not in ("ascii", "binary_little_endian", "binary_big_endian") or any(e.rows < 0 for e in elements):
        raise ValueError(f"format {form!r}")
    order = ">" if form == "binary_big_endian" else "<"
    for element in elements:
        element.properties[:] = [
            _Property(each.name, order + each.kind, each.count_kind and order + each.count_kind)
            for each in element.properties
        ]
    return form, elements, end.end()


def _columns(data: bytes, begin: int, element: _Element) -> tuple[dict[str, Any], int]:
    """The columns of an element by name, lists as `Lists`, and where the next element begins."""
    lengths = [0 if each.count_kind else 1 for each in element.properties]
    if element.rows and 0 in lengths:
        lengths = _lengths(data, begin, element.properties)
    dtype = _row(element.properties, lengths)
    size = element.rows * dtype.itemsize
    table = np.frombuffer(data, dtype, element.rows, begin) if begin + size <= len(data) else None
    if table is not None and all(
        (table[f"n{k}"] == length).all()
        for k, (each, length) in enumerate(zip(element.properties, lengths, strict=True))
        if each.count_kind
    ):
        columns: dict[str, Any] = {}
        for k, (each, length) in enumerate(zip(element.properties, lengths, strict=True)):
            column = table[f"p{k}"]
            counts = np.full(element.rows, length, dtype=np.int64)
            columns[each.name] = (column.astype(np.int64).ravel(), counts) if each.count_kind else column
        return columns, begin + size
    if all(not each.count_kind for each in element.properties):
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
    ends = np.flatnonzero(strip == _STRIP_END)
    for piece in np.split(strip, ends):
        run = piece[piece != _STRIP_END]
        if len(run) > 2:
            each = np.column_stack([run[:-2], run[1:-1], run[2:]])
            each[1::2] = each[1::2, [1, 0, 2]]
            triangles.append(each)
    return np.vstack(triangles)


def _triangulated(vertices: NDArray[Any], lists: Lists) -> tuple[Array, Faces]:
    """The vertices, and polygons cut into triangles (m, 3): up to four corners as a fan, larger ones in their plane."""
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
    return np.asarray(vertices), np.vstack(faces)


def _in_plane(points: Array) -> Faces:
    """Triangles (n − 2, 3) of a polygon's corners (n, 3), concave ones too, seen along its mean normal."""
    centred = points - points.mean(axis=0)
    normal = area_vector(centred)
    if np.linalg.norm(normal) > 0.0 and len(points) <= MOST_CORNERS:
        triangles = triangulated(centred / np.abs(centred).max(), normal)
        if len(triangles) == len(points) - 2:
            return triangles
    return fan(len(points))
