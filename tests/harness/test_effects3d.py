"""The third dimension: directions, what each condition changes, crossings, and the same plane found at any azimuth."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import harness
from analytic.excitation import Pulse, Record
from harness import effects3d
from harness.effects3d import (
    BASELINE,
    CONDITIONS,
    Search,
    amplified,
    changed_scene,
    departure,
    find,
    start_factor,
    tilt_along,
    turned,
    with_solid,
)
from harness.effects3d.band import band
from harness.effects3d.search import first_crossing, nearest_crossing, peak_g
from harness.effects3d.study import Ledger, side_azimuths
from harness.effects3d.summary import effects, static_rose
from harness.engine import Want
from harness.engines import load
from harness.errors import InputError
from harness.processes.executors import LocalPool
from harness.scene import Scene, Shake
from meshes import footprint, solid_from_mesh
from tests.budgets_meshes import SAME_PLANE_RAD
from tests.meshes.shapes import box

SEARCH = Search(most_g=1.0, resolution=0.02)
needs_pybullet = pytest.mark.skipif(load("pybullet").missing() is not None, reason=str(load("pybullet").missing()))


@pytest.fixture(scope="module")
def scene(root: Path) -> Scene:
    return harness.load_scene(root / "scenes" / "3d_effects_base.toml")


@pytest.fixture(scope="module")
def block(scene: Scene) -> Scene:
    """The scene with a plain block in place of the statue."""
    vertices, faces = box(0.3, 0.4, 1.2)
    return with_solid(scene, solid_from_mesh(vertices, faces, density_kg_m3=2700.0))


def falls_in(*windows: tuple[float, float]) -> Callable[[float], str | None]:
    """A statue that overturns at the factors inside these windows only."""
    return lambda factor: "overturned_right" if any(low <= factor <= high for low, high in windows) else None


def test_the_first_window_is_found_and_bracketed() -> None:
    found = first_crossing(falls_in((0.7, 0.8), (1.5, 9.0)), 0.2, 4.0, 1.05, 1e-3)
    assert found.above == pytest.approx(0.7, rel=1e-3)
    assert found.below < 0.7 <= (found.above or 0.0) <= found.below * 1.001
    assert found.outcome == "overturned_right"
    assert found.runs < 50
    coarse = first_crossing(falls_in((0.7, 0.8), (1.5, 9.0)), 0.2, 4.0, 1.5, 1e-3)
    assert coarse.above is not None
    assert coarse.above > 0.8, "a grid coarser than the window steps over it"


def test_no_window_is_said() -> None:
    found = first_crossing(falls_in(), 0.2, 4.0, 1.2, 1e-3)
    assert found.above is None
    assert found.below == pytest.approx(4.0)


@pytest.mark.parametrize("near", [0.5, 0.69, 0.7, 0.75, 1.4])
def test_the_crossing_is_followed_from_nearby(near: float) -> None:
    found = nearest_crossing(falls_in((0.7, 9.0)), near, 0.2, 4.0, 1e-3)
    assert found.above == pytest.approx(0.7, rel=1e-3)
    assert found.runs <= 20
    assert nearest_crossing(falls_in(), near, 0.2, 4.0, 1e-3).above is None
    everything = nearest_crossing(falls_in((0.0, 9.0)), near, 0.2, 4.0, 1e-3)
    assert everything.above == pytest.approx(0.2)


@pytest.mark.parametrize("azimuth", [0.0, 37.0, 180.0])
def test_turned_towards_an_azimuth_shows_its_corners(scene: Scene, azimuth: float) -> None:
    statue = scene.statue
    assert statue.solid is not None
    expected = footprint.planar(statue.solid.footprint_m, statue.centroid_height_m, statue.solid.inertia_kg_m2, azimuth)
    found = turned(scene, azimuth).statue
    assert found.corner_right_m == pytest.approx(expected.corner_right_m, rel=1e-9)
    assert found.corner_left_m == pytest.approx(expected.corner_left_m, rel=1e-9)
    assert found.inertia_kg_m2 == pytest.approx(expected.inertia_kg_m2, rel=1e-9)


def test_every_condition_changes_one_thing(scene: Scene) -> None:
    before = scene.statue
    rel = {
        "centroid 3 % higher": ("centroid_height_m", 1.03),
        "base 3 % narrower": ("corner_right_m", 0.97),
        "inertia 3 % larger": ("inertia_kg_m2", 1.03),
    }
    for name in CONDITIONS:
        after = changed_scene(scene, name, 0.0)
        for attribute in ("mass_kg", "centroid_height_m", "corner_right_m", "inertia_kg_m2"):
            factor = rel.get(name, ("", 1.0))[1] if rel.get(name, ("", 1.0))[0] == attribute else None
            if factor is not None:
                assert getattr(after.statue, attribute) == pytest.approx(factor * getattr(before, attribute), rel=1e-9)
            elif not any(word in name for word in attribute.split("_")) and "base" not in name:
                assert getattr(after.statue, attribute) == pytest.approx(getattr(before, attribute), rel=1e-9), name
    peaks = {name: tuple(_peaks(changed_scene(scene, name, 0.0))) for name in CONDITIONS}
    assert peaks.pop("with the vertical component") == pytest.approx((0.3, 0.0, 0.27))
    assert peaks.pop("with the second horizontal component") == pytest.approx((0.3, 0.09, 0.0))
    assert peaks.pop("with all three components") == pytest.approx((0.3, 0.09, 0.27))
    assert set(peaks.values()) == {peaks[BASELINE]}
    assert peaks[BASELINE] == pytest.approx((0.3, 0.0, 0.0))


def _peaks(scene: Scene) -> list[float]:
    shake = scene.shake
    return [item.peak_m_s2 / scene.gravity_m_s2 for item in (shake.x, shake.y, shake.z)]


def test_ragged_base_and_no_products(scene: Scene) -> None:
    solid = scene.statue.solid
    assert solid is not None
    rough = changed_scene(scene, "base ragged by 1 mm", 0.0).statue
    plain = changed_scene(scene, "products of inertia left out", 0.0).statue.solid
    assert rough.solid is not None
    assert plain is not None
    assert 0.0 < np.ptp(rough.solid.feet_m[:, 2]) <= 1e-3
    assert len(rough.solid.feet_m) > len(solid.feet_m)
    assert rough.inertia_kg_m2 == scene.statue.inertia_kg_m2
    assert np.count_nonzero(plain.inertia_kg_m2) == 3
    assert np.count_nonzero(solid.inertia_kg_m2) == 9


def test_tilt_along_is_the_rotation_in_its_own_plane() -> None:
    tilt = np.linspace(-0.6, 0.6, 13)
    for direction in (0.0, 37.0, 90.0):
        angle = np.deg2rad(direction)
        up = np.column_stack([np.sin(tilt) * np.cos(angle), np.sin(tilt) * np.sin(angle), np.cos(tilt)])
        theta, across = np.arctan2(up[:, 0], up[:, 2]), np.arcsin(up[:, 1])
        np.testing.assert_allclose(tilt_along(theta, across, direction), tilt, atol=1e-12)


def test_the_amplitude_found_overturns_and_the_one_below_stands(block: Scene) -> None:
    row = find(block, BASELINE, 0.0, "analytic", SEARCH)
    assert row.peak_g is not None
    assert row.stands_at_g < row.peak_g <= row.stands_at_g * (1.0 + SEARCH.resolution) * 1.0001
    base = changed_scene(block, BASELINE, 0.0)
    for peak, outcome in ((row.peak_g, row.outcome), (row.stands_at_g, "stands")):
        assert harness.simulate(amplified(base, peak / peak_g(base)), "analytic").outcome.value == outcome
    assert find(block, BASELINE, 180.0, "analytic", SEARCH).peak_g == row.peak_g


def test_below_the_start_nothing_lifts(scene: Scene) -> None:
    """Shaken obliquely the body lifts where the push leaves the footprint, before the planar limit of that direction."""
    oblique = changed_scene(scene, BASELINE, 45.0)
    solid = oblique.statue.solid
    assert solid is not None
    along = 0.0682 * math.sqrt(2.0) / 0.774
    assert start_factor(oblique) * peak_g(oblique) == pytest.approx(0.95 * along, rel=1e-3)
    assert along < oblique.statue.corner_right_m / oblique.statue.centroid_height_m


def test_sides_and_their_share_of_the_shaking(scene: Scene) -> None:
    assert side_azimuths(scene) == pytest.approx([0.0, 90.0, 180.0, 270.0])
    sides = [{"azimuth_deg": 0.0, "peak_g": 0.25}, {"azimuth_deg": 90.0, "peak_g": None}]
    rows = {row["azimuth_deg"]: row for row in static_rose(scene, [0.0, 60.0, 180.0], sides)}
    assert rows[0.0]["projected_g"] == pytest.approx(0.25)
    assert rows[60.0]["projected_g"] == pytest.approx(0.5)
    assert rows[180.0]["projected_g"] is None
    assert rows[60.0]["lifts_g"] < rows[60.0]["planar_lifts_g"]


def test_effects_are_changes_of_the_same_direction_and_engine() -> None:
    def row(condition: str, azimuth: float, peak: float | None) -> dict[str, object]:
        return {"condition": condition, "engine": "mujoco", "azimuth_deg": azimuth, "peak_g": peak}

    name = "centroid 3 % higher"
    rows = [row(BASELINE, a, p) for a, p in ((0.0, 0.2), (90.0, 0.4), (180.0, 0.5))]
    rows += [row(name, 0.0, 0.19), row(name, 90.0, 0.40), row(name, 180.0, None)]
    (found,) = effects(rows, [name])
    assert found["median"] == pytest.approx(-0.025)
    assert (found["least"], found["largest"]) == (pytest.approx(-0.05), pytest.approx(0.0))
    assert found["flips"] == 1


def test_the_band_holds_the_model_and_narrows_without_errors(block: Scene) -> None:
    row = find(block, BASELINE, 0.0, "analytic", Search(most_g=1.0, resolution=0.002))
    found = band(block, 0.0, SEARCH, samples=40, seed=1)
    assert row.peak_g is not None
    assert found.low_g is not None
    assert found.high_g is not None
    assert found.low_g < row.peak_g < found.high_g
    assert 0.02 < found.high_g / found.low_g - 1.0 < 0.2
    assert found == band(block, 0.0, SEARCH, samples=40, seed=1)


def test_a_cut_line_of_the_ledger_is_left_out(tmp_path: Path, block: Scene) -> None:
    file = tmp_path / "searches.jsonl"
    Ledger(file).put("a", find(block, BASELINE, 0.0, "analytic", SEARCH), 0.5)
    file.write_text(file.read_text() + '{"key": "b", "ans')
    assert set(Ledger(file).known) == {"a"}
    assert Ledger(file).spent_s == {"a": 0.5}


def test_mistakes(scene: Scene, root: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="one of shaken"):
        find(scene, "as dreamt", 0.0, "analytic", SEARCH)
    numbers = harness.load_scene(root / "scenes" / "free_rocking.toml")
    with pytest.raises(InputError, match="numbers alone"):
        turned(numbers, 10.0)
    for text, said in (
        ('engines = ["analytic"]', "computes in 3D"),
        ('engines = ["mujoco"]\ndirections = 10\nevery = 3', "divisor"),
        ('engines = ["mujoco"]\nconditions = ["x"]', "names out of"),
        ('engines = ["mujoco"]\ncolour = 1', "colour"),
    ):
        file = tmp_path / "study.toml"
        file.write_text(f'kind = "effects3d"\ntitle = "t"\nscene = "s.toml"\n{text}\n')
        assert effects3d.asked(file)
        with pytest.raises(InputError, match=said):
            effects3d.run_effects(file, tmp_path / "out", LocalPool(1), lambda done, total: None)
    assert not (tmp_path / "out").exists()


@needs_pybullet
def test_the_same_plane_at_any_azimuth(block: Scene) -> None:
    """The block and its shaking turned together: the rotation in the plane of shaking is that of azimuth 0."""
    solid = block.statue.solid
    assert solid is not None
    amplitude = 0.3 * 9.81
    histories = []
    for direction in (0.0, 37.0, 90.0):
        angle = np.deg2rad(direction)
        shake = Shake(
            x=Pulse("one_sine", amplitude * float(np.cos(angle)), 0.5),
            y=Pulse("one_sine", amplitude * float(np.sin(angle)), 0.5),
        )
        run = harness.simulate(
            with_solid(block, solid.rotated(direction)).but(shake=shake, duration_s=1.0), "pybullet", dt_s=2.5e-4
        )
        assert run.history is not None
        histories.append(tilt_along(run.history.theta_rad, run.history.extra["out_of_plane_rad"], direction))
    assert np.abs(histories[0]).max() > 0.02
    for other in histories[1:]:
        assert np.abs(other - histories[0]).max() < SAME_PLANE_RAD


@needs_pybullet
def test_the_quiet_start_of_oblique_shaking_ends_where_the_base_is_left(scene: Scene) -> None:
    """Under a rising push at 45° the statue lifts at 0.125 g, where it leaves the base, its planar section only at 0.39 g."""
    from harness.engines.bullet import course

    t_s = np.linspace(0.0, 2.0, 201)
    push = Shake(x=Record(t_s, -0.4 * 9.81 * t_s / 2.0))
    straight, oblique = (
        changed_scene(scene, BASELINE, azimuth).but(shake=push, contact=replace(scene.contact, statue=1.0))
        for azimuth in (0.0, 45.0)
    )
    assert course.quiet_start_s(straight, course.prepare(straight)) == pytest.approx(2.0 * 0.0881 / 0.4, abs=0.01)
    assert course.quiet_start_s(oblique, course.prepare(oblique)) == pytest.approx(2.0 * 0.1246 / 0.4, abs=0.01)
    moved = harness.simulate(oblique.but(duration_s=1.0), "pybullet", dt_s=1e-3, want=Want(skips=frozenset()))
    assert moved.history is not None
    first = moved.history.t_s[
        np.argmax(np.hypot(moved.history.theta_rad, moved.history.extra["out_of_plane_rad"]) > 1e-5)
    ]
    assert 0.0 < first - 2.0 * 0.1246 / 0.4 < 0.05


@needs_pybullet
def test_oblique_shaking_leaves_the_plane_on_one_corner(scene: Scene) -> None:
    """Shaken at 110° the statue turns about a corner and yaws; along its own axis of symmetry it does neither."""
    straight, oblique = (departure(scene, azimuth, "pybullet", 0.22, 1e-3) for azimuth in (0.0, 30.0))
    assert straight.out_of_plane_rad < 1e-3
    assert straight.corner_share == 0.0
    assert oblique.out_of_plane_rad > 10.0 * straight.out_of_plane_rad
    turning = departure(scene, 110.0, "pybullet", 0.8, 1e-3)
    assert turning.corner_share > 0.2
    assert turning.yaw_rad > 0.02


def test_a_whole_study_is_resumed_and_repeats_nothing(root: Path, tmp_path: Path) -> None:
    pytest.importorskip("mujoco", reason="mujoco is an optional extra and is not installed")
    (tmp_path / "study.toml").write_text(
        'kind = "effects3d"\ntitle = "four directions"\n'
        f"scene = {json.dumps(str(root / 'scenes' / '3d_effects_base.toml'))}\n"
        'engines = ["analytic", "mujoco"]\ndirections = 4\nevery = 2\nsamples = 5\n'
        'conditions = ["centroid 3 % higher", "base planed flat"]\n'
        "[search]\nmost_g = 0.4\nresolution = 0.02\ndt_s = 2e-3\n"
    )
    out = tmp_path / "out"
    found, summary = effects3d.run_effects(tmp_path / "study.toml", out, LocalPool(1), lambda done, total: None)
    assert summary.failed == 0
    assert summary.cpu_s > 0.0
    assert found["left_out"] == {"base planed flat": "the base is flat"}
    assert {row["condition"] for row in found["rows"]} == {BASELINE, "centroid 3 % higher"}
    assert found["replay"] is not None
    assert (out / "replay" / "result.json").is_file()
    again, second = effects3d.run_effects(tmp_path / "study.toml", out, LocalPool(1), lambda done, total: None)
    assert second.found == second.asked
    assert again["rows"] == found["rows"]
