"""Drawn charts show what their data hold, where it lies, and nothing that could leave the picture."""

import json
import re
import resource
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reports.charts.figure import (
    Look,
    across,
    axis,
    cells,
    figure,
    level,
    localised,
    marks,
    named,
    rows,
    sized,
    still,
    svg,
    wrapped,
)
from reports.drawing.pictures import rings
from reports.messages import language
from reports.pages.bench_page import shapes
from reports.pages.page import pack_text, packed_chart
from reports.pages.run_page import histories_figure
from reports.source import RunSource, run_source
from tests.budgets_reports import STILL_PX
from tests.reports.unpacking import numbers, unpacked

COLOUR = "#123456"


def curve(x: Any, y: Any, name: str = "a model", *more: dict[str, Any]) -> dict[str, Any]:
    """A chart of one line over 0 to 10 and −1 to 3."""
    data = {"curves": [{"name": name, "x": x, "y": y}]}
    layers = [marks("line", "curves", named({name: Look(COLOUR)}, chosen=False)), *more]
    level_, upright = (
        across("x", "along", {"domain": [0, 10], "padding": 0}),
        axis("y", "up", scale={"domain": [-1, 3]}),
    )
    return figure(layers, 300, data, level_, upright)


def test_numbers_of_a_chart_are_written_as_its_language_writes_them() -> None:
    chart = curve([0.0, 10.0], [0.0, 2.0])
    for code, half in (("en", ">0.5<"), ("it", ">0,5<")):
        spoken = localised(chart, language(code))
        assert half in svg(spoken), code
        assert json.loads(unpacked(str(packed_chart(spoken))))["config"]["locale"]["number"]["decimal"] == half[2]


def test_the_words_at_a_balance_point_have_room(source: RunSource) -> None:
    """A rotation that all but reaches it leaves the point near the upper end of the view."""
    right_rad = source.scene.statue.slenderness_right_rad
    raised = {
        name: replace(each, theta_rad=0.94 * right_rad * each.theta_rad / np.abs(each.theta_rad).max())
        for name, each in source.histories.items()
    }
    low, high = histories_figure(replace(source, histories=raised))["usermeta"]["views"]["near"]
    assert high - right_rad > 0.05 * (high - low)


def test_rounding_of_a_statue_at_rest_is_no_rotation_to_be_seen(source: RunSource) -> None:
    """A chart of ± 1e-10 rad filled its height, and its axis was of sixteen digits."""
    still = {
        name: replace(each, theta_rad=1e-10 * each.theta_rad / np.abs(each.theta_rad).max())
        for name, each in source.histories.items()
    }
    low, high = histories_figure(replace(source, histories=still))["usermeta"]["views"]["near"]
    assert [-low, high] == pytest.approx([0.01, 0.01], rel=0.01)
    stuck = {name: replace(each, slip_m=1e-9 * np.abs(each.slip_m)) for name, each in source.histories.items()}
    rows_, fewer = (len(histories_figure(each)["vconcat"]) for each in (source, replace(source, histories=stuck)))
    assert fewer == rows_ - 1, "the slip of a pedestal at rest"


def points(drawn: str) -> np.ndarray[Any, Any]:
    """The points of the one curve."""
    path = re.search(rf'd="M([^"]+)" stroke="{COLOUR}"', drawn.split("mark-line", 1)[1])
    return np.array([[float(value) for value in point.split(",")] for point in path.group(1).split("L")])


def test_a_curve_lies_where_its_values_are() -> None:
    found = points(svg(curve(np.array([0.0, 5.0, 10.0]), np.array([-1.0, 0.0, 2.0])), 500))
    width = found[2, 0]
    assert width > 380.0, "the plot fills the picture"
    assert found == pytest.approx(np.array([[0, 300], [width / 2, 225], [width, 75]]), abs=STILL_PX)


def test_a_peak_of_one_sample_survives() -> None:
    values = np.zeros(100_000)
    values[61_803] = 1.0
    found = rows([{"name": "a", "t": np.arange(1e5), "y": values, "z": -values}], 400, {})
    assert len(found) <= 2 * 400
    assert {"name": "a", "t": 61803.0, "y": 1.0, "z": -1.0} in found


def test_parts_that_a_choice_leaves_out_are_not_drawn() -> None:
    parts = [{"model": name, "x": [1.0], "y": [2.0]} for name in ("a", "b")]
    assert [row["model"] for row in rows(parts, 10, {"model": "b"})] == ["b"]
    assert len(rows(parts, 10, {"other": "b"})) == 2


def test_equal_neighbours_of_a_map_are_drawn_as_one() -> None:
    found = cells([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 2.0], [["p", "p", "q"], ["q", None, "q"]])
    assert found == {
        "x": [0, 2, 0, 2],
        "x2": [2, 3, 1, 3],
        "y": [0, 0, 1, 1],
        "y2": [1, 1, 2, 2],
        "kind": ["p", "q", "q", "q"],
    }


@pytest.mark.parametrize("kind", ["agreed", "apart"])
def test_the_histories_are_well_formed_and_named(written: Callable[[str], Path], kind: str) -> None:
    source = run_source(written(kind))
    drawn = still(histories_figure(source))
    root = ElementTree.fromstring(f"<div>{drawn}</div>")
    words = {item.text for item in root.iter() if item.tag.endswith("text")}
    assert set(source.histories) <= words
    assert "time  [s]" in words
    called = set(re.findall(r'"url\(#([^)]+)\)"', drawn))
    assert {"hatch-sliding", "hatch-both"} < called
    ids = [item.get("id") for item in root.iter() if item.get("id")]
    assert set(ids) == called, "what a fill calls stands in the page"
    assert len(ids) == len(set(ids))
    assert still(histories_figure(source)) == drawn, "drawn again it is the same"


def test_text_cannot_break_out() -> None:
    name = "<script>x</script> & 'y'"
    drawn = svg(curve([0.0, 1.0], [0.0, 1.0], name), words=name)
    words = {item.text for item in ElementTree.fromstring(drawn).iter() if item.tag.endswith("text")}
    assert name in words
    assert "<script" not in drawn
    steering = svg(curve([0.0, 1.0], [0.0, 1.0], "a\x1b[31m\udcff\u202eb"))
    assert any(
        (item.text or "").startswith(r"a\x1b[31m\udcff\u202eb") for item in ElementTree.fromstring(steering).iter()
    )


def test_a_level_beyond_its_axis_is_not_drawn() -> None:
    assert "a level" in svg(curve([0.0], [0.0], "a", *level(2.0, "a level")))
    beyond = svg(curve([0.0], [0.0], "a", *level(4.0, "a level")))
    assert "clip-path" in beyond
    assert re.search(r"translate\([\d.]+,-\d", beyond), "above the plot, where it is cut"


def test_a_still_rounds_places_and_no_words() -> None:
    drawn = still(curve([0.0, 3.3333], [0.0, 1.2345], "a", *level(2.0, "until 6.08 s")))
    assert ">until 6.08 s<" in drawn
    assert not re.search(r'd="M[^"]*\d\.\d\d', drawn)


def test_every_plot_has_the_share_of_the_width_that_it_states() -> None:
    beside = {"hconcat": [{"vconcat": [{"width": 0.6}, {"width": 0.6}]}, {"width": 0.4}]}
    left, right = sized(beside, 1000.0)["hconcat"]
    assert [each["width"] for each in left["vconcat"]] == [468.0, 468.0]
    assert right["width"] == 268.0
    assert sized({"layer": []}, 1000.0)["width"] == 1000.0


def test_a_page_carries_samples_packed_and_all_else_as_it_is() -> None:
    chart = curve(np.linspace(0.0, 10.0, 101), np.sin(np.linspace(0.0, 10.0, 101)))
    (part,) = json.loads(unpacked(packed_chart(chart)))["datasets"]["curves"]
    assert part["name"] == "a model"
    assert np.abs(numbers(part["y"]) - chart["datasets"]["curves"][0]["y"]).max() < 1e-5
    (listed,) = json.loads(unpacked(packed_chart(curve([1.0], [None]))))["datasets"]["curves"]
    assert (listed["x"], listed["y"]) == ([1.0], [None])


@pytest.mark.parametrize("text", ["", "a", "θ ≤ α", "0123456789" * 997])
def test_packed_text_comes_back_and_ends_no_script(text: str) -> None:
    assert unpacked(pack_text(text)) == text
    assert not set("<&>") & set(pack_text(text))


@pytest.mark.parametrize("most", [1.0, 0.7, 3e-7, 12345.0, 1.2])
def test_rings_are_round_within_and_few(most: float) -> None:
    found = rings(most, 6)
    assert 1 <= len(found) <= 6
    assert found == pytest.approx(found[0] * np.arange(1, len(found) + 1))
    assert found[-1] <= most < found[-1] + found[0]
    assert f"{found[0]:e}"[0] in "125"


def test_addresses_that_are_limited_are_told_before_the_library_ends_the_process(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda _: (2**33, 2**33))
    with pytest.raises(OSError, match="ulimit -v unlimited"):
        svg(curve([0.0, 1.0], [0.0, 1.0]))


def test_a_key_of_signs_takes_as_many_columns_as_fit() -> None:
    """In Italian the second sign of a bench's key stood beyond a telephone's edge, and the page scrolled sideways."""
    words = {"secondo la sua accuratezza": "circle", "fino all'obiettivo": "diamond"}
    assert shapes(words)["shape"]["legend"]["columns"] == wrapped(words)["columns"]
