"""Figures for papers and the animation hold the record's own curves, whole or not at all."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from harness.model.errors import InputError
from reports.export.animation import FRAMES_PER_S, write_gif
from reports.export.figures import draw_histories, draw_panels, write_figures
from reports.source import read_record, run_source
from tests.reports.invented_run import write_invented
from tests.reports.invented_study import write_map_study, write_table_study

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
    source = run_source(folder)
    figure = Figure()
    draw_histories(figure, source)
    lines = {line.get_label(): line for line in figure.axes[0].get_lines()}
    for name, history in source.histories.items():
        assert np.array_equal(lines[name].get_ydata(), history.theta_rad)
    assert [axes.get_ylabel() for axes in figure.axes] == ["rotation θ (rad)", "", "slip (mm)", "floor (g)"]
    assert figure.axes[-1].get_xlabel() == "time (s)"


def test_panels_stand_in_the_papers_arrangement(table: Path) -> None:
    panels = read_record(table)["panels"]
    group = [item for item in panels if item["restitution"] == 0.85]
    figure = Figure()
    draw_panels(figure, group, "pymunk (own impact)")
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles[:3] == ["0.334 g, 1.5 Hz", "0.429 g, 1.5 Hz", "0.334 g, 2 Hz"]
    drawn = figure.axes[1].get_lines()[1]
    recorded = next(item for item in group if (item["amplitude_g"], item["frequency_hz"]) == (0.429, 1.5))
    assert drawn.get_ydata().tolist() == recorded["curves"]["pymunk (own impact)"]["pedestal"]["theta_rad"]


def test_a_study_has_a_figure_for_each_restitution(table: Path) -> None:
    names = [path.name for path in write_figures(table, ("svg",), "column", "analytic (paper)")]
    assert names == [f"panels_{r}_analytic_paper.svg" for r in ("0.85", "0.875", "0.9")]


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


def test_a_record_without_curves_has_no_figure(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="histories or panels"):
        write_figures(write_map_study(tmp_path))


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
