"""A wall or a second body scanned with the statue: seen, refused with the cut that leaves the statue, else no alarm."""

import re
from pathlib import Path

import numpy as np
import pytest

from harness.model import InputError
from meshes import MeshError, Solid
from meshes.beside import attached_beside
from meshes.mesh import RawMesh
from meshes.prepare import Wanted, prepare_mesh
from reports.cli import scans
from reports.cli.app import ScanOptions
from tests.budgets_meshes import CUT_VOLUME_REL
from tests.meshes.scanner import write
from tests.meshes.shapes import box, cylinder, union


@pytest.fixture(scope="module")
def bodies(statue: Solid) -> dict[str, RawMesh]:
    """The generated statue with a wall (closed, turned, as a scanner sees it), a second statue and a column at its side."""
    vertices, faces = np.array(statue.vertices_m), np.array(statue.faces)
    back, right = float(vertices[:, 1].min()), float(vertices[:, 0].max())
    walled, faces_walled = union([(vertices, faces), box(3.0, 0.1, 3.0, (-1.5, back - 0.08, 0.0))])
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    wall = RawMesh(walled, faces_walled, "wall")
    front = wall.with_faces(faces_walled[walled[faces_walled][:, :, 1].min(axis=1) > back - 0.07])
    column = union([(vertices, faces), box(0.37, 0.4, 1.0, (right - 0.02, -0.2, 0.0))])
    return {
        "a wall": wall,
        "a turned wall": wall.moved(walled @ turn.T),
        "the front of a wall": front,
        "a column": RawMesh(*column, "column"),
    }


@pytest.mark.parametrize("name", ["a wall", "a turned wall", "the front of a wall", "a column"])
def test_what_hangs_on_a_statue_is_refused_with_the_cut_that_takes_it_off(
    name: str, bodies: dict[str, RawMesh], statue: Solid, tmp_path: Path
) -> None:
    file = write(bodies[name], tmp_path / "scan.ply")
    what = "a second body" if name == "a column" else "a wall"
    with pytest.raises(InputError, match=what) as caught:
        scans.inspect(file, ScanOptions(unit="m", up="z"))
    told = re.search(r"--cut-beyond (\S+) \(--cut-beyond none says", str(caught.value))
    found = scans.inspect(file, ScanOptions(unit="m", up="z", cut_beyond=told.group(1)))
    assert found.solid.mass_kg == pytest.approx(statue.mass_kg, rel=CUT_VOLUME_REL)
    assert found.solid.height_m == pytest.approx(statue.height_m, rel=CUT_VOLUME_REL)
    assert "cut" in {change.step for change in found.prepared.log.changes}


def test_what_is_the_statue_s_own_is_kept_when_told(bodies: dict[str, RawMesh]) -> None:
    mesh = prepare_mesh(bodies["a column"], Wanted(unit="m", up="z", cut_beyond=(0.0, np.inf))).mesh
    assert float(mesh.vertices[:, 0].max()) == pytest.approx(float(bodies["a column"].vertices[:, 0].max()))
    with pytest.raises(MeshError, match="a cut between"):
        prepare_mesh(bodies["a column"], Wanted(unit="m", up="z", cut_beyond=(0.0, 9.0)))
    with pytest.raises(InputError, match=r"^--cut-beyond: .* got 'north'"):
        scans.inspect(Path("any.ply"), ScanOptions(cut_beyond="north"))


def test_a_cut_through_vertices_is_closed_like_any_other() -> None:
    """A drum of 48 sides cut where a column of its vertices stands, as a file in single precision has it."""
    vertices, faces = cylinder(0.2, 1.2, around=48)
    drum = RawMesh(vertices.astype(np.float32).astype(np.float64), faces, "drum")
    through, beside = (
        prepare_mesh(drum, Wanted(unit="m", up="z", cut_beyond=(0.0, distance_m))).solid(density_kg_m3=1.0).mass_kg
        for distance_m in (0.1, 0.1 + 1e-5)
    )
    assert through == pytest.approx(beside, rel=CUT_VOLUME_REL)


def test_a_statue_alone_raises_no_alarm(statue: Solid) -> None:
    vertices, faces = np.array(statue.vertices_m), np.array(statue.faces)
    for angle in (0.0, 0.3, 1.1):
        turn = np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
        assert attached_beside(vertices @ turn.T, faces) is None
