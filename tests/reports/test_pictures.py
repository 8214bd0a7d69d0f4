"""Figures for papers and the animation hold the record's own curves, whole or not at all."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from PIL import Image

from harness import InputError, RunRecord, StudyRecord, read_result
from harness.model import PatternName, write_json
from harness.records.base import Record, as_file
from harness.records.bench import StressRecord
from reports.blocks import Chart, walk
from reports.charts.figure import across, figure, localised, marks, still, upwards
from reports.export.figures import DPI, FRAMES_PER_S, WIDTHS_MM, pixels_across, printed, write_figures, write_gif
from reports.messages import ENGLISH, language
from reports.pages.bench_page import STABILITY
from reports.pages.page import page_blocks
from reports.pages.run_page import histories_figure
from reports.pages.study_page import panel_place, panels_figure
from reports.source import run_source
from tests.budgets_reports import ROUNDED_INCH
from tests.reports.invented_run import write_invented

SIGNATURES = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}


@pytest.fixture(scope="module")
def folder(written: Callable[[str], Path]) -> Path:
    return written("apart")


@pytest.fixture(scope="module")
def table(written: Callable[[str], Path]) -> Path:
    return written("table")


def test_a_runs_figure_is_written_in_every_format_and_again_as_it_was(folder: Path) -> None:
    paths = write_figures(folder)
    assert [path.suffix[1:] for path in paths] == list(SIGNATURES)
    first = [path.read_bytes() for path in paths]
    assert all(content.startswith(SIGNATURES[path.suffix[1:]]) for path, content in zip(paths, first, strict=True))
    assert sorted(item.name for item in (folder / "figures").iterdir()) == sorted(path.name for path in paths)
    assert [path.read_bytes() for path in write_figures(folder, ("png", "svg"))] == first[:2]


def test_a_printed_figure_is_as_wide_as_asked_and_has_its_words(folder: Path) -> None:
    source = run_source(folder)
    for width_mm in WIDTHS_MM.values():
        drawn = printed(histories_figure(source), pixels_across(width_mm))
        assert f'width="{width_mm:.2f}mm"' in drawn
        words = set(re.findall(r">([^<>\n]+)</text>", drawn))
        assert {"rotation θ  [rad]", "slip u  [mm]", "floor x  [g]", "time  [s]", *source.histories} <= words
        assert {ENGLISH.strings[f"chart.pattern_{name}"] for name in get_args(PatternName)} & words, (
            "a strip of patterns needs its key"
        )


def test_a_printed_chart_writes_its_numbers_as_the_page_does() -> None:
    """The page had 2000, its figure 2,000."""
    chart = figure(
        [marks("point", "a")], 100, {"a": [{"x": [0.0, 2500.0], "y": [0.0, 1.0]}]}, across("x"), upwards("y")
    )
    for drawn in (printed(chart, 400.0), str(still(localised(chart, ENGLISH), 400.0))):
        assert ">2000<" in drawn
        assert ">0.5<" in drawn
    assert ">0,5<" in still(localised(chart, language("it")), 400.0)


def test_vector_and_pixel_figures_have_one_size(folder: Path) -> None:
    png, svg, pdf = write_figures(folder, ("png", "svg", "pdf"), "column")
    wide, high = (float(mm) / 25.4 for mm in re.findall(r'="([\d.]+)mm"', svg.read_text(encoding="utf-8"))[:2])
    box = re.search(rb"MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", pdf.read_bytes())
    assert [float(side) / 72.0 for side in box.groups()] == pytest.approx([wide, high], abs=ROUNDED_INCH)
    with Image.open(png) as image:
        assert [side / DPI for side in image.size] == pytest.approx([wide, high], abs=1.0 / DPI)


def test_panels_stand_in_the_papers_arrangement(table: Path) -> None:
    record = read_result(table)
    assert isinstance(record, StudyRecord)
    panels = [panel for panel in record.panels or [] if panel.restitution == 0.85]
    chart = panels_figure(panels, "pymunk (own impact)")
    chosen = {each["name"]: each["value"] for each in chart["params"] if "bind" in each}
    assert chosen == {"model": "pymunk (own impact)", "r": 0.85}
    assert chart["columns"] == len({panel.amplitude_g for panel in panels})
    places = [(panel.frequency_hz, panel.amplitude_g) for panel in panels]
    assert chart["facet"]["sort"] == [f"{g:g} g, {hz:g} Hz" for hz, g in sorted(places)], (
        "amplitudes across, frequencies down"
    )
    for panel in panels:
        wanted = {
            "name": ENGLISH("chart.panel_pedestal_theta_rad"),
            "model": "pymunk (own impact)",
            "r": panel.restitution,
            "place": panel_place(panel),
        }
        (drawn,) = [part for part in chart["datasets"]["panels"] if wanted.items() <= part.items()]
        assert drawn["value"].tolist() == panel.curves["pymunk (own impact)"]["pedestal"].theta_rad


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


def test_every_chart_of_a_studys_page_is_a_figure(
    written: Callable[[str], Path], record_of: Callable[[str], Record]
) -> None:
    folder = written("map")
    charts = [each.name for each in walk(page_blocks(folder, record_of("map"))) if isinstance(each, Chart)]
    assert len(charts) > 3
    assert [path.stem for path in write_figures(folder, ("svg",), "column")] == charts
    assert [path.stem for path in write_figures(written("rose"), ("svg",))][-1] == "rose"


def test_a_validation_has_its_figures(written: Callable[[str], Path]) -> None:
    names = {path.stem for path in write_figures(written("validation"), ("svg",))}
    assert names == {"accuracy", "plane", "fragility"}


def test_a_record_without_charts_has_no_figure(tmp_path: Path) -> None:
    folder = write_invented(tmp_path)
    record = read_result(folder)
    assert isinstance(record, RunRecord)
    write_json(folder / "result.json", as_file(replace(record, histories=[])))
    with pytest.raises(InputError, match=str(tmp_path)):
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


def test_a_gif_is_of_a_run_alone(table: Path) -> None:
    with pytest.raises(InputError) as refused:
        write_gif(table)
    (mistake,) = refused.value.mistakes
    assert (mistake.key, mistake.wanted, mistake.got) == ("kind", "run", "'study'")


def test_a_stress_run_has_a_map_of_each_engine_with_its_words(written: Callable[[str], Path]) -> None:
    folder = written("stress")
    record = read_result(folder)
    assert isinstance(record, StressRecord)
    paths = {path.stem: path.read_text(encoding="utf-8") for path in write_figures(folder, ("svg",))}
    assert set(paths) == {f"stability-{cell.engine.replace(':', '-')}" for cell in record.cells}
    for cell in record.cells:
        drawn = paths[f"stability-{cell.engine.replace(':', '-')}"]
        sign, _ = STABILITY[cell.category]
        told = (sign, f"{sign} {cell.category}", cell.setting, cell.difficulty)
        assert all(f">{words}</text>" in drawn for words in told)
