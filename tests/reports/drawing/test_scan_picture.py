"""A scan drawn with its base, its weakest direction and both triads of axes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

from meshes.orientation import turn_axis
from meshes.prepare import Wanted, prepare
from meshes.solid import Solid, solid_from_mesh
from reports.cli import app
from reports.cli.ending import WRONG_INPUT, guarded
from reports.drawing.scan_picture import BASE, SIDE, WEAKEST, scan_picture
from reports.drawing.shapes import Path as Line
from reports.drawing.shapes import Text
from tests.budgets_reports import PIXEL


@pytest.fixture(scope="module")
def box() -> Solid:
    """A block 0.4 m along x, 1 m along y, 2 m high: it falls most easily along x."""
    body = trimesh.creation.box(extents=(0.4, 1.0, 2.0))
    return solid_from_mesh(np.asarray(body.vertices), np.asarray(body.faces), density_kg_m3=1000.0)


def test_the_arrow_points_from_under_the_centroid_along_the_weakest_direction(box: Solid) -> None:
    shapes = scan_picture(box, np.eye(3), "box.ply").shapes
    base = next(shape for shape in shapes if isinstance(shape, Line) and shape.fill == BASE)
    arrow = next(shape for shape in shapes if isinstance(shape, Line) and shape.stroke == WEAKEST)
    assert len(base.points_px) == 4
    np.testing.assert_allclose(arrow.points_px[0], base.points_px.mean(axis=0), atol=PIXEL)
    # Corners come counter-clockwise from the least x: an edge along x is parallel to the arrow.
    edges = np.diff(np.vstack([base.points_px, base.points_px[:1]]), axis=0)
    towards = arrow.points_px[1] - arrow.points_px[0]
    sines = np.abs(edges[:, 0] * towards[1] - edges[:, 1] * towards[0])
    lengths = np.hypot(*edges.T) * np.hypot(*towards)
    assert np.count_nonzero(sines < PIXEL * np.hypot(*towards)) == 2, sines / lengths
    words = [shape.text for shape in shapes if isinstance(shape, Text)]
    assert any("balances at 11.3°" in text for text in words)  # atan(0.2 / 1)


def test_everything_stays_inside_the_picture(box: Solid) -> None:
    shapes = scan_picture(box, turn_axis("y"), "box.ply").shapes
    for shape in shapes:
        points = shape.points_px if isinstance(shape, Line) else np.array([[shape.x, shape.y]])
        assert points.min() > 0.0
        assert points.max() < SIDE


def test_the_files_axes_are_turned_as_the_scan_was(box: Solid, tmp_path: Path) -> None:
    body = trimesh.Trimesh(box.vertices_m @ turn_axis("y"), box.faces, process=False)
    body.export(tmp_path / "lying.ply")
    prepared = prepare(tmp_path / "lying.ply", Wanted(unit="m", up="y"))
    np.testing.assert_array_equal(prepared.rotation, turn_axis("y"))
    letters = {
        name: [
            (shape.x, shape.y)
            for shape in scan_picture(box, rotation, "b").shapes
            if isinstance(shape, Text) and shape.text in "xyz"
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
    assert 'aria-label="weakest towards' in page
    assert "<script" not in page
    (tmp_path / "mine.png").write_bytes(b"mine")
    for name, said in (("box.bmp", r".png, .svg, .pdf"), ("mine.png", "as rockcheck wrote it")):
        code = guarded(lambda name=name: app([*line, str(tmp_path / name)], standalone_mode=False))
        assert code == WRONG_INPUT
        assert said in capsys.readouterr().err
    assert (tmp_path / "mine.png").read_bytes() == b"mine"
