"""The conservator's section follows from the scene, the histories and the rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from reports.museum import of_run, of_study, thresholds_g
from reports.posing import section
from reports.source import read_record, run_source
from reports.study_rows import conditions
from tests.reports.invented_run import write_invented
from tests.reports.invented_study import write_map_study, write_table_study


def test_motion_begins_at_the_limits_of_rest(tmp_path: Path) -> None:
    limits = thresholds_g(run_source(write_invented(tmp_path)).scene)
    assert limits["it tips to the right"] == pytest.approx(0.0682 / 0.774)
    assert limits["it tips to the left"] == pytest.approx(0.3585 / 0.774)
    assert limits["the pedestal slides"] == 0.2
    bare = thresholds_g(run_source(write_invented(tmp_path / "bare", pedestal=False)).scene)
    assert set(bare) == {"it tips to the left", "it tips to the right"}


def test_the_reach_is_of_standing_runs_only_and_falls_are_said(tmp_path: Path) -> None:
    source = run_source(write_invented(tmp_path, disagree=True))
    text = " ".join(of_run(source).sentences)
    shape, history = section(source.scene), source.histories["pymunk"]
    most = max(
        float(shape.overhang_m(item.theta_rad, item.slip_m, 1).max())
        for name, item in source.histories.items()
        if name != "pybullet"
    )
    assert f"farther than {100 * most:.1f}\u00a0cm" in text
    assert np.abs(history.theta_rad).max() < 0.2
    assert "In pybullet it falls" in text


def test_the_wall_stands_at_its_distance(tmp_path: Path) -> None:
    charts = {name: figure for name, _, figure in of_run(run_source(write_invented(tmp_path))).charts}
    assert [shape["y0"] for shape in charts["reach"]["layout"]["shapes"]] == [-0.70]


def test_what_the_pedestal_prevents_is_counted_by_condition(tmp_path: Path) -> None:
    record = read_record(write_table_study(tmp_path))
    found = of_study(record, *conditions(record["rows"]))
    assert found is not None
    assert (
        "it overturns in 12 without the pedestal; with it 6 of these are prevented and 0 others caused"
        in found.sentences[-1]
    )
    figures = {name: figure for name, _, figure in found.charts}
    assert figures["saved"]["data"][0]["text"] == ["6/6", "6/6", "0/6", "0/6", "0/6"]


def test_a_study_without_pedestals_has_no_such_section(tmp_path: Path) -> None:
    record = read_record(write_map_study(tmp_path))
    assert of_study(record, *conditions(record["rows"])) is None
