"""What a mesh file may be written like: each form read with the right volume, or refused by its name."""

import json
import resource
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes import MeshError
from meshes.intake import FINEST_SHARE, read_mesh
from meshes.mesh import RawMesh
from meshes.processing_log import measure
from tests.budgets_meshes import FLOAT32_ROUNDING_M, ROUND_OFF_REL
from tests.meshes.shapes import box, cylinder

CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 2))
SIDES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
VOLUME = 1.0 / 3.0


def volume(path: Path) -> float:
    return measure(read_mesh(path)).volume_m3


def soup(index: str) -> str:
    """The tetrahedron with each face straight after its own three vertices."""
    rows = []
    for number, side in enumerate(SIDES):
        rows += ["v {} {} {}".format(*CORNERS[corner]) for corner in side]
        rows.append("f " + " ".join(index.format(k - 3, 3 * number + k + 1) for k in range(3)))
    return "\n".join(rows)


VERTICES = "\n".join("v\t{}\t{} {} 0.5 0.5 0.5".format(*corner) for corner in CORNERS)


@pytest.mark.parametrize(
    "text",
    [
        soup("{0}"),
        soup("{1}"),
        soup("{0}/{0}/{0}"),
        soup("{1}//7"),
        VERTICES + "".join("\nf\t{}/1\t{}\\\n {}".format(*(k + 1 for k in side)) for side in SIDES),
        VERTICES.replace("\n", "\r\n")
        + "".join("\r\nf {} {} {} # side".format(*(k - 4 for k in side)) for side in SIDES),
        "\ufeff" + soup("{0}"),
    ],
)
def test_objs_of_every_form(text: str, tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_bytes(text.encode())
    assert volume(tmp_path / "a.obj") == pytest.approx(VOLUME, rel=ROUND_OFF_REL)


@pytest.mark.parametrize("face", ["f 0 1 2", "f 1 2", "f -5 1 2", "f 1 2 9", "f 1 2 x", "v 1 2"])
def test_an_obj_s_wrong_line_is_refused(face: str, tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(f"{VERTICES}\nf 1 2 3\n{face}\n")
    with pytest.raises(MeshError) as caught:
        read_mesh(tmp_path / "a.obj")
    assert caught.value.place == str(tmp_path / "a.obj")


def ply(
    path: Path, form: str, vertices: Any, lists: list[list[int]], element: str = "face", kind: str = "double"
) -> Path:
    header = (
        f"ply\nformat {form} 1.0\ncomment x\nelement vertex {len(vertices)}\nproperty uchar red\n"
        + "".join(f"property {kind} {axis}\n" for axis in "xyz")
        + f"element {element} {len(lists)}\nproperty uchar flags\nproperty list int int vertex_indices\nend_header\n"
    )
    order, letter = "<" if "little" in form else ">", "d" if kind == "double" else "f"
    if form == "ascii":
        rows = [f"1 {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices, dtype=np.float64).tolist()]
        body = "\n".join([*rows, *(f"0 {len(each)} {' '.join(map(str, each))}" for each in lists)]).encode()
    else:
        body = b"".join(struct.pack(f"{order}B3{letter}", 1, *row) for row in np.asarray(vertices).tolist())
        body += b"".join(struct.pack(f"{order}Bi{len(each)}i", 0, len(each), *each) for each in lists)
    path.write_bytes(header.encode() + body)
    return path


FORMS = ["ascii", "binary_little_endian", "binary_big_endian"]


@pytest.mark.parametrize("form", FORMS)
def test_plys_of_mixed_polygons_and_of_strips(form: str, tmp_path: Path) -> None:
    vertices, _ = cylinder(0.5, 2.0, around=5)
    ring = list(range(5))
    lists = [ring[::-1], [k + 5 for k in ring], *([k, (k + 1) % 5, (k + 1) % 5 + 5, k + 5] for k in ring)]
    area = 0.5 * 5 * 0.25 * np.sin(2.0 * np.pi / 5)
    assert volume(ply(tmp_path / "a.ply", form, vertices, lists)) == pytest.approx(2.0 * area)
    strips = [[0, 2, 1, 3, -1, 2, 0, 3], [0, 1, 3]]
    mesh = read_mesh(ply(tmp_path / "b.ply", form, CORNERS, strips, "tristrips"))
    assert sorted(map(sorted, mesh.faces.tolist())) == sorted(map(sorted, [*SIDES[:1], *SIDES[2:], SIDES[1]]))
    assert measure(mesh).volume_m3 == pytest.approx(VOLUME)


@pytest.mark.parametrize("form", FORMS)
def test_a_ply_that_ends_early_is_refused(form: str, tmp_path: Path) -> None:
    whole = ply(tmp_path / "a.ply", form, CORNERS, [list(side) for side in SIDES]).read_bytes()
    for cut in (3, 30, len(whole) // 2):
        (tmp_path / "a.ply").write_bytes(whole[:-cut])
        with pytest.raises(MeshError, match="does not parse"):
            read_mesh(tmp_path / "a.ply")


def test_a_concave_polygon_is_cut_in_its_plane(tmp_path: Path) -> None:
    outline = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]])
    vertices = np.vstack([np.column_stack([outline, np.full(5, z)]) for z in (0.0, 1.0)])
    lists = [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9], *([k, (k + 1) % 5, (k + 1) % 5 + 5, k + 5] for k in range(5))]
    mesh = read_mesh(ply(tmp_path / "a.ply", "ascii", vertices, lists))
    corners = mesh.vertices[mesh.faces]
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    level = np.ptp(corners[:, :, 2], axis=1) == 0.0
    assert areas[level].sum() == pytest.approx(2.0 * 2.5)  # a fan from one corner covers 3.5
    assert measure(mesh).volume_m3 == pytest.approx(2.5)


def test_a_polygon_of_20_000_corners_takes_little(tmp_path: Path) -> None:
    vertices, _ = cylinder(0.3, 1.0, around=20_000)
    ring = list(range(20_000))
    sides = [[k, (k + 1) % 20_000, (k + 1) % 20_000 + 20_000, k + 20_000] for k in ring]
    file = ply(tmp_path / "a.ply", "ascii", vertices, [ring[::-1], [k + 20_000 for k in ring], *sides])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert len(read_mesh(file).faces) == 2 * 19_998 + 40_000
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # KiB


@pytest.mark.parametrize("form", FORMS[1:])
def test_single_precision_far_from_its_origin_is_refused(form: str, tmp_path: Path) -> None:
    vertices, faces = box(1.0, 1.0, 2.0)
    far = np.float32(vertices + np.array([5e5, 4.5e6, 0.0]))
    for kind, seen in (("float", True), ("double", False)):
        file = ply(tmp_path / "a.ply", form, far, faces.tolist(), kind=kind)
        if seen:
            with pytest.raises(MeshError, match=r"resolve only 0\.5 units"):
                read_mesh(file)
        else:  # whole numbers as they may be meant
            assert volume(file) == pytest.approx(2.0)
    near = ply(tmp_path / "a.ply", form, np.float32(vertices + 1000.0), faces.tolist(), kind="float")
    assert volume(near) == pytest.approx(2.0, rel=1e3 * FLOAT32_ROUNDING_M)


def test_an_stl_and_texts_of_single_precision_are_refused_too(tmp_path: Path) -> None:
    import trimesh

    vertices, faces = trimesh.creation.icosphere(4).vertices, trimesh.creation.icosphere(4).faces
    offset = np.array([5e5, 4.5e6, 100.0])
    trimesh.Trimesh(vertices + offset, faces, process=False).export(tmp_path / "a.stl")
    for name, form in (("six.obj", "{:.6g}"), ("seven.obj", "{:.7g}"), ("single.obj", "{!r}"), ("full.obj", "{:.12g}")):
        places = vertices + offset
        if name == "single.obj":
            places = np.float64(np.float32(places))
        rows = ["v " + " ".join(form.format(float(value)) for value in row) for row in places]
        (tmp_path / name).write_text("\n".join([*rows, *("f {} {} {}".format(*(face + 1)) for face in faces)]))
    (tmp_path / "coarse.obj").write_text(
        "\n".join(
            [
                *("v {:.1f} {:.1f} {:.1f}".format(*row) for row in vertices),
                *("f {} {} {}".format(*(face + 1)) for face in faces),
            ]
        )
    )
    # Of few vertices no grid is told; these are beyond what double precision resolves.
    box = trimesh.creation.box()
    trimesh.Trimesh(box.vertices + 1e15, box.faces, process=False).export(tmp_path / "far.obj", digits=17)
    for name in ("a.stl", "six.obj", "seven.obj", "single.obj", "coarse.obj", "far.obj"):
        with pytest.raises(MeshError, match=rf"resolve a {1.0 / FINEST_SHARE:.0f}th"):
            read_mesh(tmp_path / name)
    assert volume(tmp_path / "full.obj") == pytest.approx(measure(RawMesh(vertices, faces, "")).volume_m3, rel=1e-5)


TETRAHEDRON = struct.pack("<12f12I", *(min(k, 1) for corner in CORNERS for k in corner), *np.ravel(SIDES))


def gltf(folder: Path, uri: str = "a.bin", nodes: int = 1, **changes: dict[str, Any]) -> Path:
    """The tetrahedron of height 1 as a glTF whose buffer is `uri`, with `changes` of its document, of its primitive and
    of its positions."""
    positions = {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"} | changes.get("positions", {})
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(min(nodes, 10)))}],
        "nodes": [{"mesh": 0}] * nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1} | changes.get("part", {})]}],
        "buffers": [{"byteLength": len(TETRAHEDRON), "uri": uri}],
        "bufferViews": [{"buffer": 0, "byteOffset": 48 * k, "byteLength": 48} for k in (0, 1)],
        "accessors": [positions, {"bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR"}],
    } | changes.get("document", {})
    (folder / "a.bin").write_bytes(TETRAHEDRON)
    (folder / "a.gltf").write_text(json.dumps(document))
    return folder / "a.gltf"


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"document": {"extensionsRequired": ["KHR_draco_mesh_compression"]}}, "KHR_draco_mesh_compression"),
        ({"document": {"extensionsRequired": ["EXT_meshopt_compression"]}}, "EXT_meshopt_compression"),
        ({"document": {"extensionsRequired": ["KHR_mesh_quantization"]}}, "KHR_mesh_quantization"),
        ({"part": {"mode": 6}}, "triangle fans"),
        ({"positions": {"sparse": {}}}, "sparse"),
        ({"document": {"extensionsRequired": ["KHR_materials_unlit", "KHR_texture_transform"]}}, None),
    ],
)
def test_a_packed_gltf_is_refused_by_the_name_of_its_packing(
    change: dict[str, Any], named: str | None, tmp_path: Path
) -> None:
    file = gltf(tmp_path, **change)
    if named is None:
        assert volume(file) == pytest.approx(1.0 / 6.0)
        return
    with pytest.raises(MeshError) as caught:
        read_mesh(file)
    assert named in caught.value.got


def test_a_gltf_reads_its_own_folder_only(tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (tmp_path / "out.bin").write_bytes(TETRAHEDRON)
    (folder / "link.bin").symlink_to(tmp_path / "out.bin")
    for uri in ("../out.bin", str(tmp_path / "out.bin"), "link.bin", "file:///etc/hostname", "/etc/hostname"):
        with pytest.raises(MeshError, match="does not parse"):
            read_mesh(gltf(folder, uri))


@pytest.mark.parametrize("asked", ["positions", "nodes"])
def test_a_kilobyte_that_asks_for_gigabytes_is_refused(tmp_path: Path, asked: str) -> None:
    if asked == "positions":
        file = gltf(tmp_path, positions={"bufferView": None, "count": 2_000_000_000})
    else:
        file = gltf(tmp_path, nodes=100_000)
        file.write_text(file.read_text().replace('"count": 12', '"count": 1200'))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(MeshError, match=r"wanted .*100,000,000.*, got "):
        read_mesh(file)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2**19, "kB"
