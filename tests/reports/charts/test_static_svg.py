"""Still pictures show what the figure holds, where it lies, and nothing that could leave the picture."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reports.charts.histories import histories_figure
from reports.charts.samples import packed_array
from reports.charts.static_svg import picture, still
from reports.charts.static_svg_axes import axes, nice_ticks
from reports.drawing.shapes import Path as Line
from reports.drawing.shapes import Text
from reports.source import run_source
from tests.budgets_reports import STILL_PX
from tests.reports.invented_run import write_invented


def line(x: Any, y: Any, **more: Any) -> dict[str, Any]:
    return {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": {"color": "#123456"}} | more


def drawn(svg: str, colour: str = "#123456") -> np.ndarray[Any, Any]:
    """The points of the one curve of a colour."""
    path = re.search(rf'<path d="M([^"]+)" fill="none" stroke="{colour}"', svg)
    assert path is not None
    return np.array([[float(value) for value in point.split()] for point in path.group(1).split("L")])


def test_a_curve_lies_where_its_values_are() -> None:
    figure = {
        "data": [line(packed_array([0.0, 5.0, 10.0]), packed_array([-1.0, 0.0, 2.0]))],
        "layout": {"height": 300, "xaxis": {"range": [0, 10]}, "yaxis": {"range": [-1, 3]}},
    }
    places = axes(figure, 500, 300)
    x, y = places["x"], places["y"]
    points = drawn(still(figure, 500))
    middle = 0.5 * (x.start_px + x.end_px)
    height = y.start_px - y.end_px
    wanted = [[x.start_px, y.start_px], [middle, y.start_px - height / 4], [x.end_px, y.start_px - 0.75 * height]]
    assert points == pytest.approx(np.array(wanted), abs=STILL_PX)


def test_a_peak_of_one_sample_survives() -> None:
    values = np.zeros(100_000)
    values[61_803] = 1.0
    figure = {
        "data": [line(packed_array(np.arange(1e5)), packed_array(values))],
        "layout": {"yaxis": {"range": [0, 1]}},
    }
    places = axes(figure, 1060, 360)
    points = drawn(still(figure))
    assert points[:, 1].min() == pytest.approx(places["y"].end_px, abs=STILL_PX)
    assert len(points) < 2000


def test_logarithms_names_and_reversed_axes_are_placed() -> None:
    figure = {
        "data": [line([1.0, 100.0], [1.0, 2.0]), {"type": "bar", "x": ["a", "b"], "y": [1.0, 2.0], "yaxis": "y2", "xaxis": "x2"}],
        "layout": {"xaxis": {"type": "log", "range": [0, 2]}, "yaxis": {"range": [0, 4], "autorange": "reversed"}},
    }  # fmt: skip
    places = axes(figure, 500, 300)
    assert places["x"].px(10.0)[0] == pytest.approx(0.5 * (places["x"].start_px + places["x"].end_px))
    assert places["y"].px(0.0)[0] == pytest.approx(places["y"].end_px)
    assert [text for _, text in places["x2"].ticks()] == ["a", "b"]
    assert places["y2"].low <= 0.0, "bars stand on nought"


def test_equal_neighbours_of_a_map_are_drawn_as_one() -> None:
    scale = [[0.0, "#ffffff"], [0.5, "#ffffff"], [0.5, "#ff0000"], [1.0, "#ff0000"]]
    trace = {
        "type": "heatmap", "x": [1.0, 2.0, 3.0], "y": [1.0, 2.0], "z": [[0.0, 0.0, 1.0], [1.0, 1.0, 1.0]],
        "zmin": 0.0, "zmax": 1.0, "colorscale": scale,
    }  # fmt: skip
    svg = still({"data": [trace], "layout": {}})
    assert sorted(re.findall(r'fill="(#f[0-9a-f]{5})"', svg)) == ["#ff0000", "#ff0000", "#ffffff"]


@pytest.mark.parametrize("disagree", [False, True])
def test_the_histories_are_well_formed_and_named(tmp_path: Path, disagree: bool) -> None:
    source = run_source(write_invented(tmp_path, disagree=disagree))
    svg = still(histories_figure(source))
    root = ElementTree.fromstring(svg)
    words = {item.text for item in root.iter() if item.tag.endswith("text")}
    assert set(source.histories) <= words
    assert "time  [s]" in words


def test_text_cannot_break_out() -> None:
    svg = still(
        {
            "data": [line([0, 1], [0, 1], name="<script>x</script> & 'y'", showlegend=True)],
            "layout": {"showlegend": True},
        }
    )
    ElementTree.fromstring(svg)
    assert "<script" not in svg


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-0.3, 0.7), (1e-7, 3e-7), (0.0, 12345.0)])
def test_ticks_are_round_within_and_few(low: float, high: float) -> None:
    found = nice_ticks(low, high, 6)
    assert 2 <= len(found) <= 7
    assert low - 1e-12 <= min(found) < max(found) <= high + 1e-12
    steps = np.diff(found)
    assert np.ptp(steps) < 1e-9 * high


def test_a_level_beyond_its_axis_is_not_drawn_in_another_row() -> None:
    def figure(level: float) -> dict[str, Any]:
        rows = {"yaxis": {"domain": [0.5, 1.0], "range": [-1, 1]}, "yaxis2": {"domain": [0.0, 0.4], "range": [-1, 1]}}
        shape = {
            "type": "line",
            "xref": "paper",
            "x0": 0,
            "x1": 1,
            "yref": "y",
            "y0": level,
            "y1": level,
            "line": {"color": "#abcdef"},
        }
        note = {"xref": "paper", "x": 1, "yref": "y", "y": level, "text": "a level"}
        data = [line([0.0, 1.0], [0.0, 0.5]), line([0.0, 1.0], [0.0, 0.5], yaxis="y2")]
        return {"data": data, "layout": {**rows, "shapes": [shape], "annotations": [note]}}

    assert "#abcdef" in still(figure(0.8))
    assert "a level" in still(figure(0.8))
    assert "#abcdef" not in still(figure(-2.0))
    assert "a level" not in still(figure(-2.0))


def test_a_curve_that_leaves_its_axis_does_not_run_along_its_edge() -> None:
    values = [0.0, 0.5, 2.0, 3.0, 4.0, 3.0, 2.0, 0.5]
    figure = {
        "data": [line(list(range(8)), values)],
        "layout": {"yaxis": {"range": [0, 1]}, "xaxis": {"range": [0, 7]}},
    }
    svg = still(figure)
    pieces = re.findall(r'<path d="M([^"]+)" fill="none" stroke="#123456"', svg) + re.findall(
        r'<path d="M([^"]+)" stroke="#123456"', svg
    )
    assert sorted(len(piece.split("L")) for piece in pieces) == [2, 3], "out over the edge, and in again"


def test_intervals_symbols_and_hatchings_are_drawn() -> None:
    ring = {"color": "#123456", "symbol": "circle-open"}
    points = {"type": "scatter", "mode": "markers", "x": [1.0, 2.0], "y": [1.0, 2.0], "marker": ring}
    points |= {"error_y": {"array": [0.5, 0.5]}}
    svg = still({"data": [points], "layout": {}})
    assert len(re.findall(r'<circle [^>]*fill="none" stroke="#123456"', svg)) == 2
    assert len(re.findall(r'<path d="[^"]*" stroke="#123456"', svg)) == 2
    crosses = still({"data": [points | {"marker": {"color": "#123456", "symbol": "x"}, "error_y": None}], "layout": {}})
    assert len(re.findall(r'<path d="[^"]*" stroke="#123456"', crosses)) == 4
    bar = {"type": "bar", "x": ["a"], "y": [1.0], "marker": {"color": "#123456", "pattern": {"shape": "x"}}}
    assert '"#ffffff"' in still({"data": [bar], "layout": {}})
    assert "nan" not in still({"data": [bar], "layout": {}})


@pytest.mark.parametrize(("low", "high", "most"), [(-0.44, 0.44, 2), (-0.95, 0.95, 2), (0.0, 1.0, 8), (3.0, 3.1, 3)])
def test_low_rows_have_ticks_enough_to_read_a_value(low: float, high: float, most: int) -> None:
    found = nice_ticks(low, high, most)
    assert 2 <= len(found) <= 2 * most + 1
    assert low <= found[0] < found[-1] <= high


def test_bars_areas_and_notes_end_with_their_axis() -> None:
    """What begins before the stretch shown or ends after it is cut there; a note at the end runs back into the chart."""
    bar = {"type": "bar", "orientation": "h", "x": [9.0], "base": [-4.0], "y": ["a"], "marker": {"color": "#123456"}}
    layout = {
        "xaxis": {"range": [0, 10]}, "height": 300,
        "shapes": [
            {"type": "rect", "x0": 8, "x1": 40, "yref": "paper", "y0": 0, "y1": 1, "fillcolor": "#abcdef"},
            {"type": "line", "x0": 12, "x1": 12, "yref": "paper", "y0": 0, "y1": 1, "line": {"color": "#fedcba"}},
        ],
        "annotations": [{"x": 9.5, "y": "a", "xanchor": "left", "text": "error bounded until 9.5 s"}],
    }  # fmt: skip
    drawing = picture({"data": [bar], "layout": layout}, 500)
    assert drawing is not None
    axis = axes({"data": [bar], "layout": layout}, 500, 300)["x"]
    areas = {each.fill: each.points_px for each in drawing.shapes if isinstance(each, Line) and each.fill}
    assert (areas["#123456"][:, 0].min(), areas["#123456"][:, 0].max()) == (axis.start_px, axis.px(5.0)[0])
    assert (areas["#abcdef"][:, 0].min(), areas["#abcdef"][:, 0].max()) == (axis.px(8.0)[0], axis.end_px)
    assert not any(each.stroke == "#fedcba" for each in drawing.shapes if isinstance(each, Line))
    note = next(each for each in drawing.shapes if isinstance(each, Text) and each.text.startswith("error"))
    assert (note.anchor, note.x) == ("end", axis.end_px)
