"""The page of an effects study: what it says follows from the record, and its pictures hold every direction."""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.model import Outcome, write_json
from harness.questions.effects3d import answer_of, findings_of
from harness.records.base import as_file
from harness.records.effects3d import EffectsRecord
from reports.blocks import verdict
from reports.charts.figure import Look
from reports.drawing.pictures import RoseCurve, rose_of
from reports.messages import ENGLISH
from reports.pages.conservator import of_effects
from reports.pages.page import write_report
from reports.pages.run_page import changes, rose, turned_scan
from reports.source import run_source
from tests.budgets_reports import BASE_M
from tests.reports.invented_effects import SOLID_G, answered, effects_record
from tests.reports.svg_parts import elements


@pytest.fixture(scope="module")
def record() -> EffectsRecord:
    return effects_record()


def test_the_verdict_counts_where_the_planar_model_is_too_safe(tmp_path: Path, record: EffectsRecord) -> None:
    said = told(record)
    assert (said["plane_unsafe"]["over"], said["plane_unsafe"]["directions"]) == (1, 4)
    assert said["plane_by_sides"]["within"] == 3
    worst = {"bounded": True, "azimuth_deg": 60.0, "planar_g": 1.0, "solid_g": 0.5, "error": 1.0, "never": 0}
    # Half of the shaking turns it about the side at 0°: that its plane says so too is told where the amplitude is that side's.
    assert said["plane_worst"] == {**worst, "sides_deg": [0.0]}
    elsewhere = [replace(each, projected_g=0.6) if each.azimuth_deg == 60.0 else each for each in record.static]
    assert told(replace(record, static=elsewhere))["plane_worst"] == {**worst, "sides_deg": []}
    assert (said["survey_effect"]["low"], said["survey_effect"]["high"]) == pytest.approx((-0.03, -0.03))
    assert said["leaves_plane"]["walked_m"] == 0.012
    fallen = [replace(each, outcome=Outcome.OVERTURNED_BACK, walked_m=0.6) for each in record.departures[:1]]
    assert told(replace(record, departures=[*fallen, *record.departures]))["leaves_plane"] == said["leaves_plane"]
    never = [
        replace(row, peak_g=None) if (row.engine, row.azimuth_deg) == ("analytic", 60.0) else row for row in record.rows
    ]
    bound = told(replace(record, rows=never))["plane_worst"]
    assert (bound["bounded"], bound["never"], bound["error"]) == (False, 1, pytest.approx(1.4))
    other = [replace(record.rows[1], engine="pybullet:plain", peak_g=0.52), *record.rows[2:]]
    doubted = [replace(record.rows[0], doubt="change"), record.rows[1], *other]
    said = told(replace(record, rows=doubted))
    assert said["solids_apart"]["median"] == pytest.approx(0.04)
    assert (said["solids_apart"]["within"], said["solids_apart"]["directions"]) == (1, 1)
    assert said["peaks_change"] == {"azimuths_deg": [0.0]}
    write_json(tmp_path / "result.json", as_file(replace(record, rows=doubted)))
    assert "<td>not asked</td>" in write_report(tmp_path).read_text(encoding="utf-8")
    wrong = ("analytic", 60.0)
    rows = [replace(row, peak_g=0.5) if (row.engine, row.azimuth_deg) == wrong else row for row in record.rows]
    repaired = answered(replace(record, rows=rows))
    assert "plane_safe" in told(repaired)
    assert (verdict(repaired).tone, verdict(record).tone) == ("agree", "differ")


def test_changes_that_are_opposite_in_two_directions_are_told_as_such(record: EffectsRecord) -> None:
    opposite = replace(record.effects[0], group="inertia", median=-0.0035, least=-0.057, largest=0.05)
    assert told(replace(record, effects=[opposite]))["other_effects"] == {
        "ranges": {opposite.condition: [-0.057, 0.05]}
    }


def told(record: EffectsRecord) -> dict[str, Mapping[str, Any]]:
    """The values of all that a record says, by code."""
    return {each.code: each.values for each in (*answer_of(record).findings, *findings_of(record))}


def test_the_rose_holds_every_direction_of_every_curve(record: EffectsRecord) -> None:
    picture = str(rose(record).svg())
    curves = re.findall(r'<path d="M([^"]*)Z" fill="none" stroke="#(?!6d6353)', picture)
    assert [len(points.split("L")) for points in curves] == [4, 4, 4]
    assert "pybullet, 270°: stands" in picture
    assert "analytic, 60°: 1.00 g" in picture
    (changed,) = changes(record)["datasets"]["changes"]
    assert changed["x"] == pytest.approx([-3.0, -3.0, -3.0])
    assert changed["tip"][0] == "pybullet, 0°: −3.0\u00a0%"
    # Of few conditions one may move it farther than the axis of nine in ten holds: its median stood beyond the chart.
    many = [replace(record.effects[0], condition=f"{k}", median=-0.03) for k in range(12)]
    far = replace(many[0], condition="far", median=0.41, changes=[replace(record.effects[0].changes[0], relative=0.41)])
    drawn = changes(replace(record, effects=[*many, far]))
    assert drawn["encoding"]["x"]["scale"]["domain"] == [-45.0, 45.0]


def test_the_page_is_written_and_says_what_was_left_out(record: EffectsRecord, tmp_path: Path) -> None:
    write_json(tmp_path / "result.json", as_file(record))
    page = write_report(tmp_path).read_text(encoding="utf-8")
    assert "base planed flat" in page
    assert "rockcheck study rose.toml" in page
    assert 'id="replay-data"' not in page
    assert page.count("25 %") >= 1, "the share of the time on a corner"


def test_the_conservator_is_told_of_variants_of_the_statue_and_of_what_shakes_it(
    record: EffectsRecord, tmp_path: Path
) -> None:
    """Neither a shorter step nor a further component of the motion is another statue."""
    more = [
        replace(record.effects[0], condition=name, group=group)
        for name, group in (("half the time step", "numerical"), ("with all three components", "components"))
    ]
    for beside, shaken in (([], "form"), (more[:1], "form"), (more, "axes")):
        answer, *_ = of_effects(tmp_path, replace(record, effects=[*record.effects, *beside]))
        assert ENGLISH("study.effects_directions", count=4, variants=2) in answer.points
        assert ENGLISH(f"study.effects_{shaken}") in answer.points
    answer, *_ = of_effects(tmp_path, replace(record, effects=[]))
    assert ENGLISH("study.effects_alone", count=4) in answer.points, "no variant was tried"


def test_a_rose_joins_only_directions_asked_one_after_another() -> None:
    whole = RoseCurve("spatial", dict.fromkeys((0.0, 90.0, 180.0, 270.0), 1.0), Look("#000"))
    some = RoseCurve("pybullet", {0.0: 0.9, 180.0: 0.8, 270.0: None}, Look("#d50"))
    paths = elements(rose_of([whole, some], 1.2, " g"), "path")
    steps = {path.get("stroke"): re.sub(r"[\d. ]", "", path.attrib["d"]) for path in paths[::-1]}  # the key comes last
    assert steps["#000"] == "MLLLZ"
    assert steps["#d50"] == "MMLL"


def test_the_scan_is_turned_back_from_the_replay_to_the_roses_directions(
    record: EffectsRecord, written: Callable[[str], Path], record_of: Callable[[str], Any]
) -> None:
    source, replayed = run_source(written("effects") / "replay"), record_of("effects")
    scan = turned_scan(replayed, source)
    assert scan is not None
    vertices, _, footprint, weakest_deg = scan
    own, drawn = np.asarray(record.scene.statue.footprint_m)[:, :2], footprint[:, :2]
    apart = np.linalg.norm(own[:, None] - drawn[None], axis=2)
    assert apart.min(axis=0).max() < BASE_M
    assert apart.min(axis=1).max() < BASE_M
    np.testing.assert_allclose(vertices[vertices[:, 2] < BASE_M].max(axis=0)[:2], own.max(axis=0), atol=BASE_M)
    assert weakest_deg == min((a for a, peak in SOLID_G.items() if peak), key=lambda a: SOLID_G[a] or np.inf)
    assert turned_scan(record, source) is None, "without a replay it is not known how the mesh was turned"
