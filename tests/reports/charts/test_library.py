"""The chart library on the pages is the wheel's own, with the kinds of chart that pages draw and without the rest."""

from __future__ import annotations

import json

import pytest

from reports.charts.library import chart_library, reduced, whole_library
from reports.charts.samples import packed_array
from reports.pages.assets import CHART_KINDS, pack_text, packed_chart
from tests.budgets_reports import LIBRARY_SHARE
from tests.reports.unpacking import unpacked


@pytest.fixture(scope="module")
def whole() -> str:
    return whole_library()


def test_it_is_a_fraction_of_the_wheels(whole: str) -> None:
    kept = unpacked(chart_library())
    assert len(kept) < LIBRARY_SHARE * len(whole)
    assert kept == reduced(whole), "the same wheel always gives the same library"


def test_it_holds_the_kinds_wanted_the_licence_and_no_maps(whole: str) -> None:
    kept = reduced(whole)
    for kind in CHART_KINDS:
        assert f'moduleType:"trace",name:"{kind}"' in kept
    for kind in ("scattermap", "mesh3d", "sankey"):
        assert f'moduleType:"trace",name:"{kind}"' in whole
        assert f'moduleType:"trace",name:"{kind}"' not in kept
    assert kept.startswith("/**\n* plotly.js v")
    assert "Licensed under the MIT license" in kept


@pytest.mark.parametrize("text", ["", "window.Plotly={};", "var Plotly=(()=>{var a=b((c,d)=>{});return a();})();"])
def test_a_bundle_of_another_shape_is_used_whole(text: str) -> None:
    assert reduced(text) == text


def test_a_bundle_without_a_wanted_kind_is_used_whole(whole: str) -> None:
    renamed = whole.replace('moduleType:"trace",name:"heatmap"', 'moduleType:"trace",name:"heat"')
    assert reduced(renamed) == renamed


def test_a_kind_that_was_left_out_is_told_when_the_page_is_written() -> None:
    assert packed_chart({"data": [{"type": "scatter"}], "layout": {}})
    with pytest.raises(LookupError, match="violin"):
        packed_chart({"data": [{"type": "violin"}], "layout": {}})


def test_curves_over_the_same_times_share_one_array() -> None:
    times, other = packed_array([0.0, 1.0]), packed_array([0.0, 2.0])
    traces = [
        {"type": "scatter", "x": times, "y": other},
        {"type": "scatter", "x": dict(times), "y": packed_array([3.0, 4.0])},
    ]
    written = json.loads(unpacked(packed_chart({"data": traces, "layout": {}})))["data"]
    assert written[0]["x"] == times
    assert written[1]["x"] == {"same": [0, "x"]}
    assert written[1]["y"] == traces[1]["y"]
    assert traces[1]["x"] == times, "the figure itself stays whole: its still picture is drawn from it"


@pytest.mark.parametrize("text", ["", "a", "θ ≤ α", "0123456789" * 997])
def test_packed_text_comes_back_and_ends_no_script(text: str) -> None:
    assert unpacked(pack_text(text)) == text
    assert not set("<&>") & set(pack_text(text))
