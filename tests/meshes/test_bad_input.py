"""Every bad scan gives one clear sentence or an accounted repair; none a traceback or a number from nowhere."""

import os
from pathlib import Path

import numpy as np
import pytest

from meshes import MeshError, Solid, load_solid
from meshes.intake import read_mesh
from meshes.mesh import RawMesh
from meshes.prepare import Wanted, prepare, prepare_mesh
from meshes.repair import Part
from tests.meshes.scanner import write
from tests.meshes.shapes import BOX_FACES, box, together, union

METRES = Wanted(unit="m", up="z")
BLOCK = (0.4, 0.7, 1.5)


def inside_out(part: Part) -> Part:
    return part[0], part[1][:, ::-1]


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
    vertices, faces = box(*BLOCK)
    vertices[5, 1] = np.nan
    rows = [" ".join(str(value) for value in row) for row in vertices]
    file = obj(tmp_path / "nan.obj", rows, [" ".join(str(index + 1) for index in row) for row in faces])
    with pytest.raises(MeshError, match="number 6"):
        prepare(file, METRES)


SHEET = (box(*BLOCK)[0] * [1.0, 1e-6, 1.0], BOX_FACES)
LARGE = (box(*BLOCK)[0] * 10.0, BOX_FACES)
CRANE = union([box(0.2, 0.2, 0.2), box(2.0, 0.2, 0.2, (0.0, 0.0, 0.2))])
LOOSE_WITHIN = together(
    box(1.0, 1.0, 2.0), inside_out(box(0.8, 0.8, 1.6, (0.1, 0.1, 0.2))), box(0.4, 0.4, 0.4, (0.3, 0.3, 0.6))
)
FINS = (box(*BLOCK)[0], np.vstack([BOX_FACES, [[0, 1, 6], [1, 2, 7], [2, 3, 4], [3, 0, 5]]]))


@pytest.mark.parametrize(
    ("part", "wanted", "said"),
    [
        (SHEET, METRES, "flat sheet"),
        (together(box(*BLOCK), box(*BLOCK, (2.0, 0.0, 0.0))), METRES, "2 separate bodies"),
        (LOOSE_WITHIN, METRES, "3 separate bodies"),
        (FINS, METRES, "non-manifold"),
        (LARGE, Wanted(unit="km", up="z"), "between"),
        (LARGE, Wanted(unit="furlong", up="z"), "unit out of"),
        (LARGE, Wanted(unit=-1.0, up="z"), "unit out of"),
        # Before an up axis is asked for.
        (box(4e3, 7e3, 7e3), Wanted(unit="m"), r"^scan: .* got .*1\.068e\+04 m .*unit m "),
        (box(400.0, 700.0, 1500.0), Wanted(up="z"), r"1\.5 m in mm"),  # never guessed
        (box(*BLOCK), Wanted(unit="m", height_m=1.5, up="z"), "got both"),
        (box(1.0, 1.0, 1.0), Wanted(unit="m"), "--up"),
        (CRANE, METRES, "stands"),
    ],
)
def test_what_no_statue_can_be_made_of_is_refused(part: Part, wanted: Wanted, said: str) -> None:
    with pytest.raises(MeshError, match=said):
        prepare_mesh(RawMesh(*part, "scan"), wanted).solid(density_kg_m3=2700.0)


INNER_M3, OUTER_M3 = 0.25, 2.0


@pytest.mark.parametrize(
    ("turned", "shift", "volume_m3"),
    [
        ((False, True), 0.25, OUTER_M3 - INNER_M3),  # a hollow
        ((True, False), 0.25, OUTER_M3 - INNER_M3),  # the same, inside out
        ((False, False), 0.25, OUTER_M3),  # nested, and solid as it faces: said
        ((False, False), 0.9, OUTER_M3 + 0.8 * INNER_M3),  # a part that overlaps
        ((False, True), 0.9, OUTER_M3 + 0.8 * INNER_M3),  # the same, inside out
        ((False, True), 0.6, None),  # neither
        ((False, True), 3.0, None),  # apart
    ],
)
def test_shells_by_where_they_lie_and_how_they_face(
    turned: tuple[bool, bool], shift: float, volume_m3: float | None, tmp_path: Path
) -> None:
    parts = box(1.0, 1.0, 2.0), box(0.5, 0.5, 1.0, (shift, 0.25, 0.5))
    both = RawMesh(*together(*(inside_out(p) if turn else p for p, turn in zip(parts, turned, strict=True))), "shells")
    if volume_m3 is None:
        with pytest.raises(MeshError, match=r"inner shell|second file"):
            prepare_mesh(both, METRES)
        return
    prepared = prepare_mesh(both, METRES)
    assert prepared.solid(density_kg_m3=1.0).mass_kg == pytest.approx(volume_m3)
    assert "bodies" in [change.step for change in prepared.log.changes]
    prepared.write(tmp_path / "body.ply")
    assert load_solid(tmp_path / "body.ply", unit="m", density_kg_m3=1.0).mass_kg == pytest.approx(volume_m3)


def test_a_branching_edge_is_repaired(statue: Solid) -> None:
    fin = np.vstack([statue.vertices_m, statue.vertices_m[statue.faces[100]].mean(axis=0) + np.array([0.0, 0.0, 0.02])])
    a, b, _ = statue.faces[100]
    faces = np.vstack([statue.faces, [[a, b, len(fin) - 1]]])
    prepared = prepare_mesh(RawMesh(fin, faces, "fin"), METRES)
    assert "non-manifold" in [change.step for change in prepared.log.changes]
    cube = np.vstack([box(*BLOCK)[0], [[1.0, 1.0, 1.0]]])
    trimmed = prepare_mesh(RawMesh(cube, np.vstack([BOX_FACES, [[0, 1, 8]]]), "one face on a cube"), METRES)
    assert [(each.code, each.values["faces"]) for each in trimmed.log.changes] == [("prepared_fins", 1)]
    assert trimmed.solid(density_kg_m3=1.0).mass_kg == pytest.approx(0.42)


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


def test_an_obj_s_materials_are_never_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from trimesh.resolvers import FilePathResolver

    asked: list[str] = []
    monkeypatch.setattr(FilePathResolver, "get", lambda self, name: asked.append(name))
    file = tmp_path / "a.obj"
    file.write_text("mtllib ../secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    assert len(read_mesh(file).faces) == 4
    assert asked == []


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
