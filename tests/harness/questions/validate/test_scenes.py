"""From a test of the table to its scenes: the stone turned, pared, shaken; perturbations seeded and small."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration
from harness.model import InputError
from harness.questions.study.rocking_spectrum import RING_DOWN_S
from harness.questions.validate.scenes import (
    BASE_SD_M,
    FRICTION_SD,
    GRAVITY_M_S2,
    Trial,
    digest_of,
    intensity,
    intensity_of,
    read_table,
    scene_of,
)
from tests.budgets_compare import QUANTILE_SE, SAMPLED_SINE_REL, TRAPEZOID_REL
from tests.harness.questions.validate.experiments import BASE, listing, variant, write_experiments, write_table

TURNED = 90.0


@pytest.fixture
def trial(tmp_path: Path) -> Trial:
    return read_table(write_experiments(tmp_path, [3.0], azimuth_deg=f"0;{TURNED:g}", friction="0.5;0.8"))[0]


def test_the_stone_stands_on_its_scanned_base(trial: Trial) -> None:
    scene = scene_of(trial, variant(trial))
    assert scene.statue.corner_left_m + scene.statue.corner_right_m == pytest.approx(np.ptp(BASE[:, 0]), rel=1e-6)
    assert scene.contact.statue == 0.5
    assert scene.pedestal is None
    assert scene.duration_s == pytest.approx(scene.base_excitation.end_s + RING_DOWN_S)


def test_turned_by_a_right_angle_width_and_depth_exchange(trial: Trial) -> None:
    straight, turned = (
        scene_of(trial, variant(trial)),
        scene_of(trial, variant(trial, azimuth_deg=TURNED, friction=0.8)),
    )
    assert turned.statue.depth_m == pytest.approx(straight.statue.corner_left_m + straight.statue.corner_right_m)
    assert turned.contact.statue == 0.8


def test_perturbations_are_seeded_small_and_of_the_stated_spread(trial: Trial) -> None:
    nominal = scene_of(trial, variant(trial))
    drawn = [scene_of(trial, variant(trial, k)) for k in range(1, 101)]
    again = scene_of(trial, variant(trial, 1))
    assert again.statue.corner_left_m == drawn[0].statue.corner_left_m
    assert again.contact.statue == drawn[0].contact.statue
    other = scene_of(trial, variant(trial, 1), seed=1)
    assert other.contact.statue != drawn[0].contact.statue
    rough = np.log([scene.contact.statue / nominal.contact.statue for scene in drawn])
    # The standard deviation of 100 normal draws errs by 1/√200 of itself.
    assert rough.std() == pytest.approx(FRICTION_SD, rel=QUANTILE_SE / np.sqrt(200))
    widths = np.array([scene.statue.corner_left_m + scene.statue.corner_right_m for scene in drawn])
    assert 0.0 < widths.std() < 20 * BASE_SD_M
    assert len({scene.statue.mass_kg for scene in drawn}) == 1


def test_a_pared_base_is_narrower_by_twice_the_cut(trial: Trial, monkeypatch: pytest.MonkeyPatch) -> None:
    from harness.questions.validate import scenes

    whole = scene_of(trial, variant(trial)).statue
    monkeypatch.setattr(scenes, "_scatter", lambda *_: (0.0, 0.004, 1.0))
    pared = scene_of(trial, variant(trial, 1)).statue
    assert pared.corner_left_m + pared.corner_right_m == pytest.approx(
        whole.corner_left_m + whole.corner_right_m - 2 * 0.004
    )
    assert np.ptp(pared.solid.base_profile_m[:, 0]) == pytest.approx(np.ptp(whole.solid.base_profile_m[:, 0]) - 0.008)
    assert pared.inertia_kg_m2 == whole.inertia_kg_m2


def burst(offset_m_s2: float = 0.0) -> SampledAcceleration:
    """Four seconds of 3 m/s² at 2 Hz, swelling and dying away over two each, on an offset of the accelerometer."""
    t = np.arange(3201) / 800.0
    wave = 3.0 * np.sin(4 * np.pi * t) * np.minimum(1.0, np.minimum(t, 4.0 - t))
    return SampledAcceleration(t, wave + offset_m_s2)


def test_intensity_is_that_of_the_burst(trial: Trial) -> None:
    """The burst's PGA is its amplitude (800 samples a second see the crest to (πf/800)²/2), its PGV A/ω."""
    found = intensity_of(trial)
    assert found.pga_g * GRAVITY_M_S2 == pytest.approx(3.0, rel=(np.pi * 2 / 800) ** 2 + TRAPEZOID_REL)
    assert found.ratio_s == pytest.approx(found.pgv_m_s / (found.pga_g * GRAVITY_M_S2))
    assert intensity(burst(), 4.0).pgv_m_s == pytest.approx(3.0 / (4 * np.pi), rel=SAMPLED_SINE_REL)


def test_the_peak_velocity_between_samples_counts() -> None:
    """A burst of sixteen samples a swing: its velocity peaks where the straight line between two passes zero."""
    t_s = 0.017 + np.arange(127) / 32.0
    coarse = SampledAcceleration(t_s, 3.0 * np.sin(4 * np.pi * t_s) * np.minimum(1.0, np.minimum(t_s, 4.0 - t_s)))
    fine = np.linspace(t_s[0], t_s[-1], 400_001)
    told, true = intensity(coarse, 4.0).pgv_m_s, np.abs(coarse.velocity_m_s(fine)).max()
    assert np.abs(coarse.velocity_m_s(t_s)).max() < 0.99 * true
    assert told == pytest.approx(true, rel=2e-3)


def test_an_offset_of_the_record_is_no_velocity() -> None:
    """0.05 m/s² integrate to 0.2 m/s in four seconds, as much as the burst's own; the drift is taken off as it was put on."""
    bare, shifted = intensity(burst(), 4.0), intensity(burst(0.05), 4.0)
    raw = np.max(np.abs(burst(0.05).velocity_m_s(np.arange(3201) / 800.0)))
    assert raw > 1.5 * bare.pgv_m_s
    assert shifted.pgv_m_s == pytest.approx(bare.pgv_m_s, rel=TRAPEZOID_REL)


@pytest.mark.parametrize(
    "motion", [Harmonic(3.0, 2.0), Pulse("rectangular", 3.0, 0.5, 0.1), Pulse("one_sine", 3.0, 0.5)]
)
@pytest.mark.parametrize("duration_s", [0.7, 4.0])
def test_the_peak_velocity_of_a_formula_is_its_integral_s(motion: Excitation, duration_s: float) -> None:
    """A harmonic motion from rest has one of 2A/ω: a drift taken off it told less."""
    t_s = np.linspace(0.0, duration_s, 1_000_001)
    accel = motion.accel_m_s2(t_s)
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t_s) * (accel[1:] + accel[:-1]))])
    assert intensity(motion, duration_s).pgv_m_s == pytest.approx(np.abs(velocity).max(), rel=SAMPLED_SINE_REL)


def test_bodies_are_drawn_once_for_all_their_tests(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Forty tests of one body in five draws ask for five turned statues, not for two hundred; friction is each test's own."""
    from harness.questions.validate import scenes

    made: list[float] = []
    whole = scenes.statue_of
    monkeypatch.setattr(scenes, "statue_of", lambda solid: made.append(1.0) or whole(solid))
    tests = read_table(write_experiments(tmp_path, np.linspace(2.0, 4.0, 40), friction="0.5"))
    drawn = [[scene_of(test, variant(test, k)) for k in range(6)] for test in tests]
    assert len(made) == 1 + 5
    assert len({row[3].statue.corner_left_m for row in drawn}) == 1
    assert len({row[3].contact.statue for row in drawn}) == 40


def test_mass_tolerance_and_worn_edge_reach_the_statue(trial: Trial) -> None:
    given = listing(
        replace(trial, mass_kg=33.0), azimuth_deg=(0.0,), contact_tolerance_m=(0.9, None), inset_m=(0.0, 0.004)
    )
    high, worn = (
        scene_of(given, variant(given)).statue,
        scene_of(given, variant(given, contact_tolerance_m=None, inset_m=0.004)).statue,
    )
    plain = scene_of(given, variant(given, contact_tolerance_m=None)).statue
    assert plain.mass_kg == pytest.approx(33.0)
    width = plain.corner_left_m + plain.corner_right_m
    assert worn.corner_left_m + worn.corner_right_m == pytest.approx(width - 2 * 0.004)
    # Within nine tenths of a metre all of the stone touches: its shifted top too, which reaches further right.
    assert high.solid.contact_tolerance_m == 0.9


@pytest.mark.parametrize("body", ["stone", "block"])
def test_an_edge_is_worn_as_far_as_the_table_says(trial: Trial, tmp_path: Path, body: str) -> None:
    """By a quarter of the base and more; what leaves no base under the centroid is refused before any run."""
    given = listing(trial, azimuth_deg=(0.0,), inset_m=(0.0, 0.06))
    if body == "block":
        (tmp_path / "block.toml").write_text(SCENE)
        given = replace(given, mesh=None, motion=None, scene=tmp_path / "block.toml")
    whole, worn = (scene_of(given, variant(given, inset_m=by)).statue for by in given.unknown["inset_m"])
    assert worn.corner_left_m == pytest.approx(whole.corner_left_m - 0.06)
    assert worn.corner_right_m == pytest.approx(whole.corner_right_m - 0.06)
    intensity_of(given)
    for by in (0.12, 0.5):
        with pytest.raises(InputError, match="leaves a base"):
            intensity_of(listing(given, inset_m=(0.0, by)))


def test_sign_and_scale_reach_the_motion(trial: Trial) -> None:
    mirrored = scene_of(trial, variant(listing(trial, sign=(-1,), scale=(2.0,))))
    t = np.linspace(0.0, 2.0, 50)
    assert mirrored.base_excitation.x.accel_m_s2(t) == pytest.approx(
        -2.0 * np.asarray(scene_of(trial, variant(trial)).base_excitation.x.accel_m_s2(t))
    )


def test_the_digest_follows_the_files_content(trial: Trial, tmp_path: Path) -> None:
    from harness.questions.validate import scenes

    before = digest_of(trial)
    assert digest_of(replace(trial, duration_s=2.0)) != before
    assert digest_of(replace(trial, observed="overturned", share="x")) == before
    trial.motion.write_text(trial.motion.read_text() + "9.0,0.0\n")
    scenes._file_digest.cache_clear()
    assert digest_of(trial) != before


SCENE = """
title = "block"
duration_s = 3.0
[statue]
mass_kg = 100.0
centroid_height_m = 0.5
corner_left_m = 0.1
corner_right_m = 0.1
inertia_kg_m2 = 10.0
height_m = 1.0
depth_m = 0.4
[motion.x]
kind = "harmonic"
amplitude_g = 0.3
frequency_hz = 2.0
"""


def test_a_scene_of_numbers_keeps_its_motion_and_cannot_be_turned(tmp_path: Path) -> None:
    (tmp_path / "block.toml").write_text(SCENE)
    rows = [{"test": "a", "scene": "block.toml", "observed": "stands", "azimuth_deg": "0;30"}]
    block = read_table(write_table(tmp_path / "table.csv", rows))[0]
    scene = scene_of(block, variant(block))
    assert scene.duration_s == 3.0
    assert intensity_of(listing(block, azimuth_deg=(0.0,))).pga_g == pytest.approx(0.3, rel=1e-3)
    narrower = scene_of(block, variant(block))
    assert narrower.statue.corner_left_m == 0.1
    drawn = scene_of(block, variant(block, 1)).statue  # its base's edge is drawn, its turn is not
    assert 0.0 < abs(drawn.corner_left_m - 0.1) < 5 * BASE_SD_M
    # It is told before any run.
    with pytest.raises(InputError, match="numbers alone"):
        intensity_of(block)
