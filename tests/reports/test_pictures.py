"""Figures for papers and the animation hold the record's own curves, whole or not at all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from harness.model.errors import InputError
from harness.model.run import PATTERN_NAMES, write_json
from harness.records.base import as_file
from harness.records.kinds import read_result
from harness.records.run import RunRecord
from harness.records.stress import StressRecord
from harness.records.study import StudyRecord
from reports.blocks import Chart, walk
from reports.charts.palette import look
from reports.charts.static_svg_axes import MARGIN
from reports.charts.study_figures import panels_figure
from reports.drawing.shapes import Path as Line
from reports.drawing.shapes import Text
from reports.export.animation import FRAMES_PER_S, write_gif
from reports.export.figures import histories_picture, pixels_across, write_figures
from reports.pages.page import page_blocks
from reports.source import run_source
from tests.budgets_reports import DRAWN_SHARE, STILL_PX
from tests.reports.invented_records import write_stress, write_validation
from tests.reports.invented_run import write_invented
from tests.reports.invented_study import write_map_study, write_rose_study, write_table_study

SIGNATURES = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_invented(tmp_path_factory.mktemp("run"), disagree=True)


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_table_study(tmp_path_factory.mktemp("table"))


def test_a_runs_figure_is_written_in_every_format(folder: Path) -> None:
    paths = write_figures(folder)
    assert [path.suffix[1:] for path in paths] == list(SIGNATURES)
    assert all(path.read_bytes().startswith(SIGNATURES[path.suffix[1:]]) for path in paths)
    assert sorted(item.name for item in (folder / "figures").iterdir()) == sorted(path.name for path in paths)


def test_the_same_record_gives_the_same_vector_figures(folder: Path) -> None:
    first = [path.read_bytes() for path in write_figures(folder, ("svg", "pdf"))]
    assert [path.read_bytes() for path in write_figures(folder, ("svg", "pdf"))] == first


def test_the_figures_curves_are_the_histories(folder: Path) -> None:
    """A printed curve passes through its history's peaks, where these lie on the axis."""
    source = run_source(folder)
    drawn = histories_picture(source, 800.0)
    words = [shape.text for shape in drawn.shapes if isinstance(shape, Text)]
    assert {"rotation θ  [rad]", "slip u  [mm]", "floor  [g]", "time  [s]", *source.histories} <= set(words)
    assert set(PATTERN_NAMES.values()) & set(words), "a printed strip of patterns needs its key"
    for name, history in source.histories.items():
        style = look(name, list(source.histories))
        curve = next(
            item.points_px
            for item in drawn.shapes
            if isinstance(item, Line) and (item.stroke, item.width) == (style.colour, style.width)
        )
        early = history.t_s < 6.0
        peak, trough = (int(pick(history.theta_rad[early])) for pick in (np.argmax, np.argmin))
        lowest, highest = int(np.argmax(curve[:, 1])), int(np.argmin(curve[: len(curve) // 2, 1]))
        shares = (curve[lowest, 0] - curve[0, 0]) / (curve[highest, 0] - curve[0, 0])
        assert shares == pytest.approx(history.t_s[trough] / history.t_s[peak], rel=DRAWN_SHARE)


def test_a_column_holds_its_chart_whole(folder: Path) -> None:
    """A chart that is printed narrow reaches from the names of its axes to the picture's right edge."""
    drawn = histories_picture(run_source(folder), pixels_across(85.0))
    lines = [item.points_px for item in drawn.shapes if isinstance(item, Line)]
    right = max(float(np.nanmax(points[:, 0])) for points in lines)
    assert right == pytest.approx(drawn.width - MARGIN["right"], abs=STILL_PX)
    assert all(np.nanmin(points) >= 0.0 for points in lines)


def test_panels_stand_in_the_papers_arrangement(table: Path) -> None:
    record = read_result(table)
    assert isinstance(record, StudyRecord)
    group = [item for item in record.panels or () if item.restitution == 0.85]
    figure = panels_figure(group, "pymunk (own impact)")
    layout = figure["layout"]
    for note in layout["annotations"]:
        number = note["xref"].partition(" ")[0][1:]
        panel = group[int(number or 1) - 1]
        assert note["text"] == f"{panel.amplitude_g:g} g, {panel.frequency_hz:g} Hz"
        x, y = layout[f"xaxis{number}"]["domain"], layout[f"yaxis{number}"]["domain"]
        assert (x[0] > 0.0) == (panel.amplitude_g == 0.429)
        assert (y[1] == 1.0) == (panel.frequency_hz == 1.5)
        mine = [trace for trace in figure["data"] if trace["xaxis"] == f"x{number}"]
        (drawn,) = [trace for trace in mine if trace["name"].startswith("θ, on the pedestal")]
        assert drawn["y"] == panel.curves["pymunk (own impact)"]["pedestal"].theta_rad


def test_a_study_has_a_figure_for_each_restitution(table: Path) -> None:
    names = [path.name for path in write_figures(table, ("svg",), "column", "analytic (paper)")]
    assert names == [*(f"panels_{r}_analytic_paper.svg" for r in ("0.85", "0.875", "0.9")), "saved.svg", "moved.svg"]


@pytest.mark.parametrize(
    ("options", "match"),
    [({"formats": ("gif",)}, "--format"), ({"width": "poster"}, "--width"), ({"model": "nobody"}, "--model")],
)
def test_unknown_options_are_refused_and_nothing_is_written(
    table: Path, options: dict[str, object], match: str
) -> None:
    before = sorted(table.rglob("*"))
    with pytest.raises(InputError, match=match):
        write_figures(table, **options)  # type: ignore[arg-type]
    assert sorted(table.rglob("*")) == before


def test_every_chart_of_a_studys_page_is_a_figure(tmp_path: Path) -> None:
    folder = write_map_study(tmp_path)
    record = read_result(folder)
    charts = [each.name for each in walk(page_blocks(folder, record)) if isinstance(each, Chart)]
    assert len(charts) > 3
    assert [path.stem for path in write_figures(folder, ("svg",), "column")] == charts
    assert [path.stem for path in write_figures(write_rose_study(tmp_path / "rose"), ("svg",))][-1] == "rose"


def test_a_validation_has_its_figures(tmp_path: Path) -> None:
    names = {path.stem for path in write_figures(write_validation(tmp_path), ("svg",))}
    assert names == {"accuracy", "plane", "fragility"}


def test_a_record_without_charts_has_no_figure(tmp_path: Path) -> None:
    folder = write_invented(tmp_path)
    record = read_result(folder)
    assert isinstance(record, RunRecord)
    write_json(folder / "result.json", as_file(replace(record, histories=[])))
    with pytest.raises(InputError, match="a record with charts"):
        write_figures(folder)


def test_the_gif_runs_in_real_time_and_moves(folder: Path) -> None:
    path = write_gif(folder)
    with Image.open(path) as image:
        history = run_source(folder).histories["pybullet"]
        assert image.n_frames == pytest.approx(FRAMES_PER_S * history.t_s[-1], abs=2)
        assert image.info["duration"] == 1000 // FRAMES_PER_S
        image.seek(0)
        first = np.asarray(image.convert("L"), dtype=int)
        image.seek(image.n_frames - 1)
        last = np.asarray(image.convert("L"), dtype=int)
    assert np.count_nonzero(first != last) > 0.05 * first.size, "a statue that has fallen fills other pixels"


def test_the_gif_of_an_unknown_model_is_refused(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--model"):
        write_gif(folder, tmp_path / "x.gif", "nobody")
    assert not (tmp_path / "x.gif").exists()


def test_a_stress_run_has_a_map_of_each_engine_with_its_words(tmp_path: Path) -> None:
    folder = write_stress(tmp_path)
    record = read_result(folder)
    assert isinstance(record, StressRecord)
    paths = {path.stem: path.read_text(encoding="utf-8") for path in write_figures(folder, ("svg",))}
    assert set(paths) == {f"stability-{cell.engine.replace(':', '-')}" for cell in record.cells}
    for cell in record.cells:
        drawn = paths[f"stability-{cell.engine.replace(':', '-')}"]
        assert all(f">{words}</text>" in drawn for words in (cell.category, cell.setting, cell.difficulty))
