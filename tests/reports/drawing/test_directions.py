"""A scan drawn with its base, its weakest direction and both triads of axes."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

from meshes.orientation import turn_axis
from meshes.prepare import Wanted, prepare
from meshes.solid import Solid, solid_from_mesh
from reports.cli import app
from reports.cli.app import WRONG_INPUT, guarded
from reports.drawing.pictures import BASE, SCAN_SIDE, WEAKEST, scan_picture
from tests.budgets_reports import WRITTEN_PX
from tests.reports.svg_parts import elements, points_px


@pytest.fixture(scope="module")
def box() -> Solid:
    """A block 0.4 m along x, 1 m along y, 2 m high: it falls most easily along x."""
    body = trimesh.creation.box(extents=(0.4, 1.0, 2.0))
    return solid_from_mesh(np.asarray(body.vertices), np.asarray(body.faces), density_kg_m3=1000.0)


def test_the_arrow_points_from_under_the_centroid_along_the_weakest_direction(box: Solid) -> None:
    picture = scan_picture(box, np.eye(3), "box.ply")
    paths = elements(picture, "path")
    base = points_px(next(each for each in paths if each.get("fill") == BASE))
    arrow = points_px(next(each for each in paths if each.get("stroke") == WEAKEST))
    assert len(base) == 4
    np.testing.assert_allclose(arrow[0], base.mean(axis=0), atol=WRITTEN_PX)
    # Corners come counter-clockwise from the least x: an edge along x is parallel to the arrow.
    edges = np.diff(np.vstack([base, base[:1]]), axis=0)
    towards = arrow[1] - arrow[0]
    crossed = np.abs(edges[:, 0] * towards[1] - edges[:, 1] * towards[0])
    lengths = np.hypot(*edges.T) + np.hypot(*towards)
    assert np.count_nonzero(crossed < WRITTEN_PX * lengths) == 2, crossed / lengths
    assert any("11.3°" in str(each.text) for each in elements(picture, "text"))  # atan(0.2 / 1)


def test_everything_stays_inside_the_picture(box: Solid) -> None:
    picture = scan_picture(box, turn_axis("y"), "box.ply")
    texts = [[float(each.attrib["x"]), float(each.attrib["y"])] for each in elements(picture, "text")]
    points = np.vstack([*map(points_px, elements(picture, "path")), texts])
    assert points.min() > 0.0
    assert points.max() < SCAN_SIDE


def test_the_files_axes_are_turned_as_the_scan_was(box: Solid, tmp_path: Path) -> None:
    body = trimesh.Trimesh(box.vertices_m @ turn_axis("y"), box.faces, process=False)
    body.export(tmp_path / "lying.ply")
    prepared = prepare(tmp_path / "lying.ply", Wanted(unit="m", up="y"))
    np.testing.assert_array_equal(prepared.rotation, turn_axis("y"))
    letters = {
        name: [
            (float(each.attrib["x"]), float(each.attrib["y"]))
            for each in elements(scan_picture(box, rotation, "b"), "text")
            if each.text in ("x", "y", "z")
        ][:3]
        for name, rotation in (("turned", prepared.rotation), ("as it is", np.eye(3)))
    }
    # What the file calls y stands upright.
    assert letters["turned"][1] == pytest.approx(letters["as it is"][2])


def test_the_command_writes_it_and_overwrites_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scan = tmp_path / "box.ply"
    trimesh.creation.box(extents=(0.4, 1.0, 2.0)).export(scan)
    line = ["mesh", "inspect", str(scan), "--unit", "m", "--up", "z", "--picture"]
    for _ in range(2):
        done = CliRunner().invoke(app, [*line, str(tmp_path / "box.png")])
        assert done.exit_code == 0, done.output
    assert (tmp_path / "box.png").stat().st_size > 1000
    assert CliRunner().invoke(app, [*line, str(tmp_path / "box.html")]).exit_code == 0
    page = (tmp_path / "box.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")
    assert "aria-label=" in page
    assert "<script" not in page
    (tmp_path / "mine.png").write_bytes(b"mine")
    for name, said in (("box.bmp", r".png, .svg, .pdf"), ("mine.png", "as rockcheck wrote it")):
        code = guarded(lambda name=name: app([*line, str(tmp_path / name)], standalone_mode=False))
        assert code == WRONG_INPUT
        assert said in capsys.readouterr().err
    assert (tmp_path / "mine.png").read_bytes() == b"mine"
