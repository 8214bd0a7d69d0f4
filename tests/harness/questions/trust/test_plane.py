"""Where engines are asked, and which scenes stand at the points."""

import math
from pathlib import Path
from typing import Any

import pytest

import harness
from harness.model import InputError
from harness.questions.trust import Plane, to_ask

BLOCK: dict[str, Any] = {
    "title": "a block",
    "duration_s": 1.0,
    "statue": {
        "mass_kg": 500.0, "centroid_height_m": 0.5, "corner_left_m": 0.2, "corner_right_m": 0.1, "inertia_kg_m2": 43.3,
    },
    "motion": {"x": {"kind": "harmonic", "amplitude_g": 0.3, "frequency_hz": 2.0}, "scale": 2.0},
    "uncertainty": {
        "motion.x.frequency_hz": {"kind": "assumed"},
        "statue.mass_kg": {"kind": "assumed", "correlated_with": "motion.x.frequency_hz", "rho": 0.5},
    },
}  # fmt: skip


def test_engines_are_asked_at_ends_first_and_then_between_what_differs() -> None:
    alike = [None, None, *"aaaaaaaaa", "b"]
    assert to_ask(alike, {}, 10) == {2, 10, 11}
    ends = {2: "confirmed", 10: "outcome_confirmed", 11: "probability"}
    assert to_ask(alike, ends, 10) == {6}
    assert to_ask(alike, ends | {6: "confirmed"}, 10) == {8}
    assert to_ask(alike, ends | {6: "confirmed", 8: "outcome_confirmed"}, 10) == {7}
    assert not to_ask(alike, ends | {6: "confirmed", 7: "confirmed", 8: "outcome_confirmed"}, 10)


def test_engines_are_asked_often_enough_where_nothing_changes() -> None:
    ends = {0: "confirmed", 8: "confirmed"}
    assert not to_ask("a" * 9, ends, 8)
    assert to_ask("a" * 9, ends, 7) == {4}


def test_a_check_of_another_class_is_bracketed() -> None:
    found = {0: "confirmed", 4: "refuted", 8: "confirmed"}
    assert to_ask("a" * 9, found, 8) == {2, 6}


@pytest.mark.parametrize("motion", ["sine", "pulse", "scene"])
def test_what_is_said_of_a_motion_is_not_said_where_another_shakes(motion: str, tmp_path: Path) -> None:
    record = tmp_path / "cut.csv"
    record.write_text("t_s,a_m_s2\n" + "".join(f"{0.01 * k:.2f},{2.0 * math.cos(0.3 * k):.6f}\n" for k in range(200)))
    across = {"kind": "record", "file": str(record), "column": "a_m_s2", "unit": "m/s^2"}
    plane = Plane.of(harness.scene({**BLOCK, "motion": {**BLOCK["motion"], "y": across}}), motion, coarse=True)
    assert "record_abrupt" in {each.code for each in plane.scene.findings}
    assert ("record_abrupt" in {each.code for each in plane.shaken.findings}) is (motion == "scene")
    assert plane.shaken.planar is (motion != "scene")


@pytest.mark.parametrize("motion", ["sine", "pulse", "scene"])
def test_a_point_has_its_strength_and_frequency(motion: str) -> None:
    plane = Plane.of(harness.scene(BLOCK), motion, coarse=True)
    point = (len(plane.frequencies_hz) - 1, 4)
    scene = plane.at(point)
    assert scene.base_excitation.x.peak_m_s2 == pytest.approx(scene.gravity_m_s2 * plane.amplitudes_g[4])
    kept = {item.key for item in scene.uncertainty}
    assert kept == ({"statue.mass_kg", "motion.x.frequency_hz"} if motion == "scene" else {"statue.mass_kg"})
    if motion == "pulse":
        assert scene.base_excitation.x.end_s == pytest.approx(1.0 / plane.frequencies_hz[-1])  # type: ignore[operator]
        assert scene.duration_s > 5.0


def test_neighbours_differ_by_the_resolution_and_rest_is_below_the_weaker_side() -> None:
    plane = Plane.of(harness.scene(BLOCK), "sine", coarse=False)
    ratios = {b / a for a, b in zip(plane.amplitudes_g, plane.amplitudes_g[1:], strict=False)}
    assert max(ratios) < 1.06
    strengths = [plane.without_dimension((0, j))[0] for j in range(len(plane.amplitudes_g))]
    assert [plane.at_rest((0, j)) for j in range(len(strengths))] == [strength < 1.0 for strength in strengths]
    p = math.sqrt(500.0 * plane.scene.gravity_m_s2 * math.hypot(0.1, 0.5) / (43.3 + 500.0 * (0.1**2 + 0.5**2)))
    assert plane.without_dimension((0, 0))[1] == pytest.approx(plane.frequencies_hz[0] / p)  # type: ignore[operator]


def test_a_scene_without_a_motion_has_none_to_make_stronger() -> None:
    still = harness.scene({**BLOCK, "motion": {"x": {"kind": "rest"}}, "uncertainty": {}})
    with pytest.raises(InputError) as caught:
        Plane.of(still, "scene", coarse=True)
    assert caught.value.mistakes[0].key == "motion.x"
    assert Plane.of(still, "sine", coarse=True).amplitudes_g


def test_a_pedestal_that_would_tip_is_not_at_rest() -> None:
    """Friction and the statue's own base bear 0.2 g; the pedestal, b over the centroid's height of both, less."""
    pedestal = {"mass_kg": 10.0, "width_m": 0.4, "depth_m": 0.4, "height_m": 2.0}
    contact = {"floor_static": 0.9, "floor_kinetic": 0.9, "statue": 1.0}
    scene = harness.scene({**BLOCK, "pedestal": pedestal, "contact": contact, "uncertainty": {}})
    plane = Plane.of(scene, "sine", coarse=True)
    alone = Plane.of(harness.scene({**BLOCK, "uncertainty": {}}), "sine", coarse=True)
    strengths = [amplitude for j, amplitude in enumerate(plane.amplitudes_g) if plane.at_rest((0, j))]
    assert 0.0 < strengths[-1] < 0.2 / 2.4
    assert alone.at_rest((0, alone.amplitudes_g.index(max(a for a in alone.amplitudes_g if a < 0.19))))
