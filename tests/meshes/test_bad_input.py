"""Every bad scan gives one clear sentence or an accounted repair; none a traceback or a number from nowhere."""

import json
import os
import resource
import struct
from pathlib import Path

import numpy as np
import pytest

from meshes import MeshError, Solid, load_solid
from meshes.intake import read_mesh
from meshes.mesh import RawMesh
from meshes.prepare import Wanted, prepare, prepare_mesh
from tests.meshes.scanner import write
from tests.meshes.shapes import box, union

METRES = Wanted(unit="m", up="z")


def obj(path: Path, vertices: list[str], faces: list[str]) -> Path:
    path.write_text("\n".join([f"v {row}" for row in vertices] + [f"f {row}" for row in faces]) + "\n")
    return path


def test_missing_empty_foreign_and_broken_files(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match=r"absent\.ply: "):
        load_solid(tmp_path / "absent.ply", unit="m", density_kg_m3=2700.0)
    for name, content, said in (
        ("empty.obj", "", "empty file"),
        ("statue.txt", "x", "one of .ply"),
        ("broken.ply", "ply\nnonsense", "does not parse"),
        ("text.stl", "hello, no mesh\n" * 20, "neither a binary one"),
        ("noise.stl", "\x8f\x01\xfe" * 400, "neither a binary one"),
        ("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no face|does not parse"),
    ):
        (tmp_path / name).write_text(content)
        with pytest.raises(MeshError, match=said):
            prepare(tmp_path / name, METRES)


def test_nan_vertices_are_named(tmp_path: Path) -> None:
    vertices, faces = box(0.4, 0.7, 1.5)
    vertices[5, 1] = np.nan
    rows = [" ".join(str(value) for value in row) for row in vertices]
    file = obj(tmp_path / "nan.obj", rows, [" ".join(str(index + 1) for index in row) for row in faces])
    with pytest.raises(MeshError, match="number 6"):
        prepare(file, METRES)


def test_flat_sheet() -> None:
    vertices, faces = box(0.4, 0.7, 1.5)
    with pytest.raises(MeshError, match="flat sheet"):
        prepare_mesh(RawMesh(vertices * [1.0, 1e-6, 1.0], faces, "sheet"), METRES)


def test_two_statues_in_one_file() -> None:
    vertices, faces = box(0.4, 0.7, 1.5)
    both = RawMesh(np.vstack([vertices, vertices + np.array([2.0, 0.0, 0.0])]), np.vstack([faces, faces + 8]), "pair")
    with pytest.raises(MeshError, match="2 separate bodies"):
        prepare_mesh(both, METRES)


def test_statue_and_plinth_that_overlap_become_one() -> None:
    plinth, faces = box(0.6, 0.8, 0.2)
    figure = box(0.4, 0.5, 1.4)[0] + [0.1, 0.15, 0.1]
    both = RawMesh(np.vstack([plinth, figure]), np.vstack([faces, faces + 8]), "pair")
    prepared = prepare_mesh(both, METRES)
    assert [change.step for change in prepared.log.changes] == ["bodies"]
    expected = 0.6 * 0.8 * 0.2 + 0.4 * 0.5 * (1.4 - 0.1)
    assert prepared.solid(density_kg_m3=1.0).mass_kg == pytest.approx(expected)


INNER_M3, OUTER_M3 = 0.25, 2.0


@pytest.mark.parametrize(
    ("turned", "shift", "volume_m3"),
    [
        ((False, True), 0.25, OUTER_M3 - INNER_M3),  # a hollow
        ((True, False), 0.25, OUTER_M3 - INNER_M3),  # the same, inside out
        ((False, False), 0.25, OUTER_M3),  # nested, and solid as it faces: said
        ((False, True), 0.9, OUTER_M3 + 0.8 * INNER_M3),  # a part inside out that overlaps
        ((False, True), 0.6, None),  # neither
        ((False, True), 3.0, None),  # apart
    ],
)
def test_shells_by_where_they_lie_and_how_they_face(
    turned: tuple[bool, bool], shift: float, volume_m3: float | None, tmp_path: Path
) -> None:
    outer, faces = box(1.0, 1.0, 2.0)
    inner = box(0.5, 0.5, 1.0)[0] + [shift, 0.25, 0.5]
    sides = [each[:, ::-1] if turn else each for each, turn in zip((faces, faces + 8), turned, strict=True)]
    both = RawMesh(np.vstack([outer, inner]), np.vstack(sides), "shells")
    if volume_m3 is None:
        with pytest.raises(MeshError, match=r"inner shell|second file"):
            prepare_mesh(both, METRES)
        return
    prepared = prepare_mesh(both, METRES)
    assert prepared.solid(density_kg_m3=1.0).mass_kg == pytest.approx(volume_m3)
    assert "bodies" in [change.step for change in prepared.log.changes]
    prepared.write(tmp_path / "body.ply")
    assert load_solid(tmp_path / "body.ply", unit="m", density_kg_m3=1.0).mass_kg == pytest.approx(volume_m3)


def test_a_body_loose_in_a_hollow_is_a_second_body() -> None:
    (outer, faces), (hollow, _), (core, _) = box(1.0, 1.0, 2.0), box(0.8, 0.8, 1.6), box(0.4, 0.4, 0.4)
    vertices = np.vstack([outer, hollow + np.array([0.1, 0.1, 0.2]), core + np.array([0.3, 0.3, 0.6])])
    with pytest.raises(MeshError, match="3 separate bodies"):
        prepare_mesh(RawMesh(vertices, np.vstack([faces, faces[:, ::-1] + 8, faces + 16]), "nested"), METRES)


@pytest.mark.parametrize(("unit", "said"), [("km", "between"), ("furlong", "unit out of"), (-1.0, "unit out of")])
def test_absurd_units(unit: str | float, said: str) -> None:
    vertices, faces = box(0.4, 0.7, 1.5)
    with pytest.raises(MeshError, match=said):
        prepare_mesh(RawMesh(10.0 * vertices, faces, "block"), Wanted(unit=unit, up="z"))


def test_kilometres_are_told_before_an_up_axis_is_asked_for() -> None:
    vertices, faces = box(4e3, 7e3, 7e3)
    with pytest.raises(MeshError, match=r"^mountain: .* got .*1\.068e\+04 m .*unit m "):
        prepare_mesh(RawMesh(vertices, faces, "mountain"), Wanted(unit="m"))


def test_no_unit_is_never_guessed() -> None:
    vertices, faces = box(400.0, 700.0, 1500.0)
    with pytest.raises(MeshError, match="1\\.5 m in mm"):
        prepare_mesh(RawMesh(vertices, faces, "block"), Wanted(up="z"))


def test_unit_and_height_exclude_each_other() -> None:
    with pytest.raises(MeshError, match="got both"):
        prepare_mesh(RawMesh(*box(0.4, 0.7, 1.5), "block"), Wanted(unit="m", height_m=1.5, up="z"))


def test_an_unclear_up_axis_is_asked_for() -> None:
    with pytest.raises(MeshError, match="--up"):
        prepare_mesh(RawMesh(*box(1.0, 1.0, 1.0), "cube"), Wanted(unit="m"))


def test_a_statue_that_does_not_stand() -> None:
    low, faces = box(0.2, 0.2, 0.2)
    beam = box(2.0, 0.2, 0.2)[0] + [0.0, 0.0, 0.2]
    prepared = prepare_mesh(RawMesh(*union([(low, faces), (beam, faces)]), "crane"), METRES)
    with pytest.raises(MeshError, match="stands"):
        prepared.solid(density_kg_m3=2700.0)


def test_a_branching_edge_is_repaired_or_refused(statue: Solid) -> None:
    fin = np.vstack([statue.vertices_m, statue.vertices_m[statue.faces[100]].mean(axis=0) + np.array([0.0, 0.0, 0.02])])
    a, b, _ = statue.faces[100]
    faces = np.vstack([statue.faces, [[a, b, len(fin) - 1]]])
    prepared = prepare_mesh(RawMesh(fin, faces, "fin"), METRES)
    assert "non-manifold" in [change.step for change in prepared.log.changes]
    vertices, cube = box(0.4, 0.7, 1.5)
    stuck = RawMesh(np.vstack([vertices, [[1.0, 1.0, 1.0]]]), np.vstack([cube, [[0, 1, 8]]]), "one face on a cube")
    trimmed = prepare_mesh(stuck, METRES)
    assert [(each.code, each.values["faces"]) for each in trimmed.log.changes] == [("prepared_fins", 1)]
    assert trimmed.solid(density_kg_m3=1.0).mass_kg == pytest.approx(0.42)
    many = np.vstack([cube, [[0, 1, 6], [1, 2, 7], [2, 3, 4], [3, 0, 5]]])
    with pytest.raises(MeshError, match="non-manifold"):
        prepare_mesh(RawMesh(vertices, many, "cube"), METRES)


def test_a_surface_through_itself_is_refused(statue: Solid) -> None:
    crumpled = statue.vertices_m.copy()
    crumpled[1:] += np.random.default_rng(3).normal(0.0, 0.02, crumpled[1:].shape) * (crumpled[1:, 2:] > 0.01)
    with pytest.raises(MeshError, match=r"^crumpled: "):
        prepare_mesh(RawMesh(crumpled, statue.faces, "crumpled"), METRES)


def test_load_refuses_what_prepare_would_repair(statue: Solid, tmp_path: Path) -> None:
    file = write(RawMesh(statue.vertices_m, statue.faces[:-1], "open"), tmp_path / "open.ply")
    with pytest.raises(MeshError, match="rockcheck mesh prepare"):
        load_solid(file, unit="m", density_kg_m3=2700.0)
    for up in ("w", "Z"):
        with pytest.raises(MeshError, match="up axis"):
            load_solid(file, unit="m", up=up, density_kg_m3=2700.0)


def test_a_readers_own_mistake_is_not_shown_as_the_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import trimesh

    def stumbles(*_: object, **__: object) -> None:
        raise UnboundLocalError("cannot access local variable 'line' where it is not associated with a value")

    monkeypatch.setattr(trimesh, "load_scene", stumbles)
    file = tmp_path / "damaged.ply"
    file.write_text("ply\n")
    with pytest.raises(MeshError, match=r"damaged\.ply: .* header of a PLY") as caught:
        read_mesh(file)
    assert "local variable" not in str(caught.value)


def _gltf(uri: str, count: int = 4, nodes: int = 1, view: bool = True) -> bytes:
    """A tetrahedron whose buffer is `uri`, its positions said to be `count`, placed by `nodes`."""
    positions: dict[str, object] = {"componentType": 5126, "count": count, "type": "VEC3"} | (
        {"bufferView": 0} if view else {}
    )
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(nodes))}],
        "nodes": [{"mesh": 0}] * nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(TETRAHEDRON), "uri": uri}],
        "bufferViews": [{"buffer": 0, "byteOffset": 48 * k, "byteLength": 48} for k in (0, 1)],
        "accessors": [positions, {"bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR"}],
    }
    return json.dumps(document).encode()


TETRAHEDRON = struct.pack("<12f12I", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2)


def test_a_gltf_reads_its_own_folder_only(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    for name in ("out.bin", "in/data.bin"):
        (tmp_path / name).write_bytes(TETRAHEDRON)
    (tmp_path / "in" / "link.bin").symlink_to(tmp_path / "out.bin")
    file = tmp_path / "in" / "a.gltf"
    file.write_bytes(_gltf("data.bin"))
    assert len(read_mesh(file).faces) == 4
    for uri in ("../out.bin", str(tmp_path / "out.bin"), "link.bin", "file:///etc/hostname", "/etc/hostname"):
        file.write_bytes(_gltf(uri))
        with pytest.raises(MeshError, match="does not parse"):
            read_mesh(file)


def test_an_obj_s_materials_are_never_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from trimesh.resolvers import FilePathResolver

    asked: list[str] = []
    monkeypatch.setattr(FilePathResolver, "get", lambda self, name: asked.append(name))
    file = tmp_path / "a.obj"
    file.write_text("mtllib ../secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    assert len(read_mesh(file).faces) == 4
    assert asked == []


@pytest.mark.parametrize(("count", "nodes", "view"), [(2_000_000_000, 1, False), (4, 10_000_000, True)])
def test_a_kilobyte_that_asks_for_gigabytes_is_refused(tmp_path: Path, count: int, nodes: int, view: bool) -> None:
    (tmp_path / "data.bin").write_bytes(TETRAHEDRON)
    file = tmp_path / "a.gltf"
    file.write_bytes(_gltf("data.bin", count, min(nodes, 10), view))
    if nodes > 10:
        text = file.read_text().replace(', {"mesh": 0}]', ', {"mesh": 0}' * (nodes // 100) + "]")
        file.write_text(text.replace('"count": 12', '"count": 1200'))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(MeshError, match=r"wanted .*100,000,000.*, got "):
        read_mesh(file)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2**19, "kB"


def test_a_mesh_s_name_that_is_too_long_or_no_text_is_refused(tmp_path: Path) -> None:
    odd = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff.ply"))
    odd.write_bytes(b"ply\n")
    for path, says in (
        (tmp_path / ("a" * 300 + ".ply"), "name too long"),
        (odd, r"\\xff.ply: wanted a file name in UTF-8"),
    ):
        with pytest.raises(MeshError, match=says) as caught:
            read_mesh(path)
        str(caught.value).encode("utf-8")
