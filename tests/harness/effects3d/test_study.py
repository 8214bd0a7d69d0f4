"""A study of directions: its sides, effects, band and ledger, its mistakes, and a whole one resumed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import harness
from harness.campaign.campaign import silent
from harness.campaign.runner import InlinePool, LocalPool
from harness.campaign.store import Store
from harness.effects3d import BASELINE, Search, find
from harness.effects3d.conditions import turned
from harness.effects3d.study import (
    KIND,
    Questions,
    band,
    checked_azimuths,
    effects,
    run_effects,
    scan_directions,
    side_azimuths,
    static_rose,
)
from harness.input.tables import kind_of
from harness.model.errors import InputError
from harness.model.scene import Scene
from harness.records.base import plain
from harness.records.effects3d import Amplitude
from harness.records.kinds import read_result
from harness.studies.cases import base_of_scene

SEARCH = Search(most_g=1.0, resolution=0.02)


def test_sides_and_their_share_of_the_shaking(scene: Scene) -> None:
    assert side_azimuths(scene) == pytest.approx([0.0, 90.0, 180.0, 270.0])
    sides = [
        Amplitude(BASELINE, azimuth, "analytic", peak, 0.1, "", 1) for azimuth, peak in ((0.0, 0.25), (90.0, None))
    ]
    rows = {row.azimuth_deg: row for row in static_rose(scene, [0.0, 60.0, 180.0], sides)}
    assert rows[0.0].projected_g == pytest.approx(0.25)
    assert rows[60.0].projected_g == pytest.approx(0.5)
    assert rows[180.0].projected_g is None
    assert rows[60.0].lifts_g < rows[60.0].planar_lifts_g


def test_effects_are_changes_of_the_same_direction_and_engine() -> None:
    def row(condition: str, azimuth: float, peak: float | None) -> Amplitude:
        return Amplitude(condition, azimuth, "pybullet", peak, 0.1, "", 1)

    name = "centroid 3 % higher"
    rows = [row(BASELINE, a, p) for a, p in ((0.0, 0.2), (90.0, 0.4), (180.0, 0.5))]
    rows += [row(name, 0.0, 0.19), row(name, 90.0, 0.40), row(name, 180.0, None)]
    (found,) = effects(rows, [name])
    assert found.median == pytest.approx(-0.025)
    assert (found.least, found.largest) == (pytest.approx(-0.05), pytest.approx(0.0))
    assert found.flips == 1


def test_other_engines_are_asked_where_the_exact_model_doubts_and_where_the_plane_errs_most() -> None:
    exact, planar = {0.0: 0.2, 90.0: 0.4, 180.0: 0.3, 270.0: None}, {0.0: 0.2, 90.0: None, 180.0: 0.9, 270.0: 0.5}
    rows = [Amplitude(BASELINE, a, "spatial", p, 0.1, "", 1) for a, p in exact.items()]
    rows += [Amplitude(BASELINE, a, "analytic", p, p or 1.3, "", 1) for a, p in planar.items()]
    assert checked_azimuths(rows) == [90.0]
    rows[3] = replace(rows[3], doubt="its runs ended without an outcome")
    assert checked_azimuths(rows) == [90.0, 270.0]
    assert checked_azimuths(rows[:3]) == []


@pytest.mark.parametrize(("up", "turn_deg", "said"), [
    ("z", 0.0, "0° points along (1, 0, 0) and 90° along (0, 1, 0)"),
    ("z", 90.0, "0° points along (0, -1, 0) and 90° along (1, 0, 0)"),
    ("y", 0.0, "0° points along (1, 0, 0) and 90° along (0, 0, -1)"),
])  # fmt: skip
def test_directions_are_named_on_the_scan_as_its_file_has_it(scene: Scene, up: str, turn_deg: float, said: str) -> None:
    turned = replace(scene, given={"statue": {"mesh": {"file": "scan.ply", "up": up, "azimuth_deg": turn_deg}}})
    assert said in scan_directions(turned)


def test_the_band_holds_the_model_and_narrows_without_errors(block: Scene) -> None:
    row = find(block, BASELINE, 0.0, "analytic", Search(most_g=1.0, resolution=0.002))
    found = band(block, 0.0, SEARCH, samples=40, seed=1)
    assert row.peak_g is not None
    assert found.low_g is not None
    assert found.high_g is not None
    assert found.low_g < row.peak_g < found.high_g
    assert 0.02 < found.high_g / found.low_g - 1.0 < 0.2
    assert found == band(block, 0.0, SEARCH, samples=40, seed=1)


def test_an_answer_is_kept_with_its_cost_and_a_damaged_one_is_told(tmp_path: Path, block: Scene, root: Path) -> None:
    base = base_of_scene(root / "scenes" / "3d_effects_base.toml")
    arguments = [(BASELINE, azimuth, "analytic", SEARCH) for azimuth in (0.0, 90.0)]
    with Store(tmp_path / "store.sqlite") as store:
        first = Questions(base, block, store, InlinePool(), silent)
        rows = first.ask(Amplitude, arguments)
        assert first.seconds > 0.0
        again = Questions(base, block, store, InlinePool(), silent)
        assert again.ask(Amplitude, arguments) == rows
        assert (again.asked, again.found) == (2, 2)
        store._db.execute("UPDATE result SET record = substr(record, 1, 40) WHERE rowid = 2")
        with pytest.raises(InputError, match="move the file away"):
            Questions(base, block, store, InlinePool(), silent).ask(Amplitude, arguments)


def test_mistakes(scene: Scene, root: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="one of shaken"):
        find(scene, "as dreamt", 0.0, "analytic", SEARCH)
    numbers = harness.load_scene(root / "scenes" / "free_rocking.toml")
    with pytest.raises(InputError, match="numbers alone"):
        turned(numbers, 10.0)
    for text, said in (
        ('engines = ["analytic"]', "computes in 3D"),
        ('engines = ["spatial"]\ndirections = 10\nevery = 3', "divisor"),
        ('engines = ["spatial"]\nconditions = ["x"]', "names out of"),
        ('engines = ["spatial"]\ncolour = 1', "colour"),
    ):
        file = tmp_path / "study.toml"
        file.write_text(f'kind = "effects3d"\ntitle = "t"\nscene = "s.toml"\n{text}\n')
        assert kind_of(file) == KIND
        with pytest.raises(InputError, match=said):
            run_effects(file, tmp_path / "out", LocalPool(1))
    assert not (tmp_path / "out").exists()


def test_a_whole_study_is_resumed_and_repeats_nothing(root: Path, tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(
        'kind = "effects3d"\ntitle = "four directions"\n'
        f"scene = {json.dumps(str(root / 'scenes' / '3d_effects_base.toml'))}\n"
        'engines = ["analytic", "spatial"]\ndirections = 4\nevery = 2\nsamples = 5\n'
        'conditions = ["centroid 3 % higher", "base planed flat", "half the time step"]\n'
        "[search]\nmost_g = 0.4\nresolution = 0.02\ndt_s = 2e-3\n"
    )
    out = tmp_path / "out"
    first = run_effects(tmp_path / "study.toml", out, LocalPool(1))
    assert first.summary.failed == 0
    assert first.summary.cpu_s > 0.0
    assert first.left_out["base planed flat"] == "the base is flat"
    assert "a thousandth of the local error" in first.left_out["half the time step"]
    assert {row.condition for row in first.rows} == {BASELINE, "centroid 3 % higher"}
    assert first.replay is not None
    assert (out / "replay" / "result.json").is_file()
    assert plain(read_result(out)) == plain(first)
    again = run_effects(tmp_path / "study.toml", out, LocalPool(1))
    assert again.summary.found == again.summary.asked
    assert again.rows == first.rows
