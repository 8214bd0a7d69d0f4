"""The page of an effects study: what it says follows from the record, and its pictures hold every direction."""

from __future__ import annotations

import copy
import re
from pathlib import Path
from typing import Any

import pytest

import harness
from harness.effects3d import BASELINE
from harness.effects3d.summary import effects, static_rose
from harness.model.run import machine, to_plain, versions, write_json
from harness.records.scene import SceneRecord
from reports.drawing.effects_figures import changes, rose
from reports.pages.effects3d_page import effects_verdict
from reports.pages.page import write_report

AZIMUTHS = (0.0, 60.0, 180.0, 270.0)
SOLID_G = {0.0: 0.25, 60.0: 0.50, 180.0: 0.22, 270.0: None}
PLANAR_G = {0.0: 0.25, 60.0: 1.0, 180.0: 0.22, 270.0: None}


@pytest.fixture(scope="module")
def record(root: Path) -> dict[str, Any]:
    """An invented record of four directions, two engines, one effect."""
    scene = harness.load_scene(root / "scenes" / "3d_effects_base.toml")

    def row(condition: str, engine: str, azimuth: float, peak: float | None) -> dict[str, Any]:
        outcome = "" if peak is None else "overturned_right"
        kept = {"condition": condition, "engine": engine, "azimuth_deg": azimuth, "peak_g": peak}
        return {**kept, "stands_at_g": 0.1, "outcome": outcome, "runs": 9}

    rows = [row(BASELINE, "pybullet", a, SOLID_G[a]) for a in AZIMUTHS]
    rows += [row(BASELINE, "analytic", a, PLANAR_G[a]) for a in AZIMUTHS]
    name = "centroid 3 % higher"
    rows += [row(name, "pybullet", a, 0.97 * peak) for a, peak in SOLID_G.items() if peak is not None]
    sides = [row(BASELINE, "analytic", a, PLANAR_G[a]) for a in (0.0, 180.0, 270.0)]
    departure = {
        "azimuth_deg": 60.0,
        "engine": "pybullet",
        "peak_g": 0.475,
        "outcome": "stands",
        "peak_theta_rad": 0.04,
    }
    departure |= {"out_of_plane_rad": 0.03, "yaw_rad": 0.01, "across_m": 0.02, "yaw_left_rad": -0.005}
    departure |= {"walked_m": 0.012, "corner_share": 0.25}
    found = {
        "schema_version": 1,
        "kind": "effects3d",
        "title": "an invented rose",
        "file": "rose.toml",
        "scene": to_plain(SceneRecord.of(scene)),
        "notes": [],
        "study": {"share": 0.95, "search": {"most_g": 1.2, "resolution": 0.002, "dt_s": 1e-3}},
        "rows": rows,
        "sides": sides,
        "static": static_rose(scene, AZIMUTHS, sides),
        "bands": [
            {"azimuth_deg": 0.0, "low_g": 0.24, "middle_g": 0.25, "high_g": None, "stands_share": 0.1, "runs": 5}
        ],
        "departures": [departure],
        "effects": effects(rows, [name]),
        "left_out": {"base planed flat": "the base is flat"},
        "replay": None,
        "summary": {"sentence": "4 directions"},
        "versions": versions(),
        "machine": machine(),
        "seconds": 1.0,
    }
    plain: dict[str, Any] = to_plain(found)
    return plain


def test_the_verdict_counts_where_the_planar_model_is_too_safe(record: dict[str, Any]) -> None:
    verdict = effects_verdict(record)
    assert "too safe at 1 of 4 directions; asked at the base's sides, it is right within" in verdict.headline
    text = " ".join(verdict.points)
    assert "At 60° it overturns from 1.00\u00a0g, in three dimensions (pybullet) from 0.500\u00a0g" in text
    assert "within 5 % at 3 of them" in text
    assert "−3.0 % to −3.0 %" in text
    assert "12\u00a0mm" in text
    mended = copy.deepcopy(record)
    for row in mended["rows"]:
        if row["engine"] == "analytic" and row["azimuth_deg"] == 60.0:
            row["peak_g"] = 0.5
    assert effects_verdict(mended).tone == "agree"
    assert "too safe at 0 of 4" in effects_verdict(mended).headline


def test_the_rose_holds_every_direction_of_every_curve(record: dict[str, Any]) -> None:
    picture = str(rose(record))
    curves = re.findall(r'<path d="M([^"]*)Z" fill="none" stroke="#(?!6d6353)', picture)
    assert [len(points.split("L")) for points in curves] == [4, 4, 4]
    assert "pybullet, 270°: stands" in picture
    assert "analytic, 60°: 1.000 g" in picture
    dots = str(changes(record, {}))
    assert dots.count("<circle") == 3
    assert "pybullet, 0°: -3.0 %" in dots


def test_the_page_is_written_and_says_what_was_left_out(record: dict[str, Any], tmp_path: Path) -> None:
    write_json(tmp_path / "result.json", record)
    page = write_report(tmp_path).read_text(encoding="utf-8")
    assert "base planed flat (the base is flat)" in page
    assert "rockcheck study rose.toml" in page
    assert 'id="replay-data"' not in page
    assert page.count("25 %") >= 1, "the share of the time on a corner"
