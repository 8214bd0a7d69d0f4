"""Target spectra from the codes' parameters; response spectra against eqsig's; compatible motions against both."""

import hashlib
from pathlib import Path
from typing import Any

import eqsig
import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from harness.input.motions import SceneMotion, prepare, spectra
from harness.input.motions.recordfile import Series, displacement_m, velocity_m_s
from harness.input.motions.spec import Component, SpectrumSpec, Target
from harness.input.motions.spectra import DesignSpectrum, design_spectrum
from harness.model import InputError
from tests.budgets_motions import (
    CODE_TABLE,
    EQSIG_MISFIT,
    LIKENESS,
    MATCHING_PASSES,
    NIGAM_JENNINGS,
    PEAK_BETWEEN_SAMPLES,
    RETURN_TO_REST_M,
    RETURN_TO_REST_M_S,
)
from tests.harness.input.motions.writers import GRAVITY, wave

LIFE_SAFETY: dict[str, Any] = {
    "code": "ntc2008", "ag_g": 0.334, "S": 1.228, "F0": 2.356, "TB_s": 0.198, "TC_s": 0.593, "TD_s": 2.935,
}  # fmt: skip
COLLAPSE: dict[str, Any] = {
    "code": "ntc2008", "ag_g": 0.429, "S": 1.104, "F0": 2.315, "TB_s": 0.202, "TC_s": 0.605, "TD_s": 3.317,
}  # fmt: skip
PERIODS_S = np.geomspace(0.05, 2.0, 120)
ADAPTER: TypeAdapter[Any] = TypeAdapter(Component)


def target(**keys: Any) -> DesignSpectrum:
    return design_spectrum(Target(**keys))


@pytest.mark.parametrize(("limit_state", "TC_star_s"), [(LIFE_SAFETY, 0.4262), (COLLAPSE, 0.4391)])
def test_the_site_gives_the_published_shape_of_both_limit_states(limit_state: dict[str, Any], TC_star_s: float) -> None:
    shape = target(**limit_state)
    keys = {key: limit_state[key] for key in ("code", "ag_g", "F0")}
    site = target(**keys, soil="C", TC_star_s=TC_star_s)
    assert site.peak_m_s2 == pytest.approx(shape.peak_m_s2, rel=CODE_TABLE)
    for key in ("TB_s", "TC_s", "TD_s"):
        assert getattr(site, key) == pytest.approx(getattr(shape, key), abs=6e-4 if key != "TD_s" else 1.1e-3)


def test_the_branches_meet_and_have_the_codes_values() -> None:
    shape = target(**LIFE_SAFETY)
    plateau = 0.334 * 1.228 * 2.356
    found = shape.accel_m_s2([0.0, 0.099, 0.198, 0.4, 0.593, 1.186, 2.935, 5.87]) / GRAVITY
    start = 0.334 * 1.228
    wanted = [start, 0.5 * (start + plateau), plateau, plateau, plateau, plateau / 2]
    wanted += [plateau * 0.593 / 2.935, plateau * 0.593 / 2.935 / 4]
    np.testing.assert_allclose(found, wanted, rtol=1e-12)


@pytest.mark.parametrize(
    ("keys", "peak", "plateau", "TC_s"),
    [
        ({"soil": "A", "type": 1}, 1.0, 2.5, 0.4), ({"soil": "B", "type": 1}, 1.2, 3.0, 0.5),
        ({"soil": "C", "type": 1}, 1.15, 2.875, 0.6), ({"soil": "D", "type": 1}, 1.35, 3.375, 0.8),
        ({"soil": "E", "type": 1}, 1.4, 3.5, 0.5), ({"soil": "A", "type": 2}, 1.0, 2.5, 0.25),
        ({"soil": "D", "type": 2}, 1.8, 4.5, 0.3), ({"type": 1, "vertical": True}, 0.9, 2.7, 0.15),
        ({"type": 2, "vertical": True}, 0.45, 1.35, 0.15), ({"soil": "A", "type": 1, "damping": 0.10}, 1.0, 2.0412, 0.4),
    ],
)  # fmt: skip
def test_eurocode_8_by_hand(keys: dict[str, Any], peak: float, plateau: float, TC_s: float) -> None:
    shape = target(code="ec8", ag_g=1.0, **keys)
    assert shape.accel_m_s2(0.0) / GRAVITY == pytest.approx(peak, rel=1e-12)
    assert shape.accel_m_s2(TC_s) / GRAVITY == pytest.approx(plateau, rel=1e-4)
    assert shape.accel_m_s2(1.01 * TC_s) < shape.accel_m_s2(TC_s)


@pytest.mark.parametrize(
    ("soil", "S", "TC_s"),
    [("A", 1.0, 0.35), ("B", 1.1, 0.47495), ("C", 1.25, 0.51966), ("D", 1.275, 0.73951), ("E", 1.175, 0.61256)],
)
def test_ntc_soils_by_hand(soil: str, S: float, TC_s: float) -> None:
    shape = target(code="ntc2018", ag_g=0.3, F0=2.5, soil=soil, TC_star_s=0.35)
    assert shape.peak_m_s2 / GRAVITY == pytest.approx(0.3 * S, rel=1e-9)
    assert shape.TC_s == pytest.approx(TC_s, abs=6e-5)
    assert pytest.approx(TC_s / 3.0, abs=3e-5) == shape.TB_s
    assert shape.TD_s == pytest.approx(2.8)


def test_ntc_vertical_by_hand() -> None:
    shape = target(code="ntc2018", ag_g=0.25, F0=2.4, vertical=True, topography=1.2)
    assert shape.accel_m_s2(0.1) / GRAVITY == pytest.approx(0.25 * 1.2 * 1.35 * 2.4 * 0.5, rel=1e-9)


@pytest.mark.parametrize(
    "keys",
    [
        {"code": "ec8", "ag_g": 0.3, "soil": "C"},
        {"code": "ec8", "ag_g": 0.3, "soil": "C", "type": 1, "F0": 2.5},
        {**LIFE_SAFETY, "soil": "C"},
        {**LIFE_SAFETY, "TC_s": 0.1},
        {**LIFE_SAFETY, "topography": 1.2},
        {"code": "ntc2018", "ag_g": 0.3, "soil": "C", "F0": 2.4},
    ],
)
def test_a_target_said_twice_or_half_is_refused(keys: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        Target(**keys)


def test_response_spectra_equal_eqsigs_on_the_same_samples() -> None:
    accel = np.random.default_rng(5).normal(size=3000) * np.hanning(3000)
    periods = np.geomspace(0.25, 3.0, 20)  # at 0.01 s both sample the response alike
    ours = spectra.spectrum_m_s2(accel, 0.01, periods, 0.05)
    theirs = eqsig.sdof.pseudo_response_spectra(accel, 0.01, periods, 0.05)[2]
    np.testing.assert_allclose(ours, theirs, rtol=NIGAM_JENNINGS)


def test_short_periods_are_sampled_finely_enough() -> None:
    accel = wave(400, 0.02)
    factor = 64
    fine = np.interp(np.arange(400 * factor - factor + 1) / factor, np.arange(400), accel)
    exact = spectra.spectrum_m_s2(fine, 0.02 / factor, [0.03, 0.05, 0.11], 0.05)
    found = spectra.spectrum_m_s2(accel, 0.02, [0.03, 0.05, 0.11], 0.05)
    assert (found <= exact * (1.0 + 1e-9)).all()
    assert (found >= exact * (1.0 - PEAK_BETWEEN_SAMPLES)).all()


def test_a_record_that_begins_with_a_jump_starts_its_oscillators_at_rest() -> None:
    step = np.full(500, 1.0)
    w = 2.0 * np.pi / 0.5
    t = 0.01 * np.arange(500)
    wd = w * np.sqrt(1.0 - 0.05**2)
    exact = -(1.0 - np.exp(-0.05 * w * t) * (np.cos(wd * t) + 0.05 * w / wd * np.sin(wd * t))) / w**2
    np.testing.assert_allclose(spectra.relative_displacement_m(step, 0.01, 0.5, 0.05), exact, atol=1e-13)


def _eqsig_misfit(series: Series, shape: DesignSpectrum) -> float:
    signal = eqsig.AccSignal(series.accel_m_s2, series.dt_s)
    signal.generate_response_spectrum(response_times=PERIODS_S, xi=shape.damping)
    return float(np.abs(signal.s_a / shape.accel_m_s2(PERIODS_S) - 1.0).max())


def test_an_artificial_motion_follows_its_target_and_returns_to_rest() -> None:
    shape = target(**LIFE_SAFETY)
    made = spectra.artificial(shape, seed=13, duration_s=20.0)
    assert _eqsig_misfit(made, shape) <= EQSIG_MISFIT
    assert abs(velocity_m_s(made)[-1]) <= RETURN_TO_REST_M_S
    assert abs(displacement_m(made)[-1]) <= RETURN_TO_REST_M
    assert made.accel_m_s2[0] == made.accel_m_s2[-1] == 0.0
    worse = Series(made.dt_s, 1.12 * made.accel_m_s2)
    assert _eqsig_misfit(worse, shape) > EQSIG_MISFIT
    assert spectra.misfit(worse, shape) > spectra.MISFIT


def test_the_same_seed_gives_the_same_bits_and_another_seed_another_motion() -> None:
    shape = target(code="ec8", ag_g=0.2, soil="A", type=2)
    bits = [
        hashlib.sha256(spectra.artificial(shape, seed=seed, duration_s=10.0).accel_m_s2.tobytes()).hexdigest()
        for seed in (4, 4, 5)
    ]
    assert bits[0] == bits[1] != bits[2]


def test_a_real_record_is_matched_within_its_work(data_dir: Path) -> None:
    keys = {**COLLAPSE, "code": "ntc2018"}
    record = {"file": str(data_dir / "records" / "elcentro1940_NS.csv"), "column": "a_NS_ms2"}
    spec = SpectrumSpec(kind="spectrum", **keys, record=record)  # type: ignore[arg-type]
    found = prepare(SceneMotion(spec, Path(), "scene.toml", "motion.x"))
    series = Series(spectra.STEP_S, found.excitation.accel_m_s2(spectra.STEP_S * np.arange(6237)))
    shape = target(**keys)
    assert _eqsig_misfit(series, shape) <= EQSIG_MISFIT
    end = found.excitation.end_s
    assert abs(float(found.excitation.velocity_m_s(end))) <= RETURN_TO_REST_M_S
    assert abs(float(found.excitation.displacement_m(end))) <= RETURN_TO_REST_M
    assert found.done[-1].values["passes"] <= MATCHING_PASSES
    original = prepare(
        SceneMotion(ADAPTER.validate_python({"kind": "record", **record}), Path(), "scene.toml", "motion.x")
    )
    t_s = original.excitation.t_s  # type: ignore[attr-defined]
    likeness = np.corrcoef(original.excitation.accel_m_s2(t_s), found.excitation.accel_m_s2(t_s))[0, 1]
    assert likeness > LIKENESS


def test_scaling_to_a_spectrum_is_one_factor(data_dir: Path) -> None:
    record = {"file": str(data_dir / "records" / "elcentro1940_NS.csv")}
    made = [
        prepare(SceneMotion(ADAPTER.validate_python(keys), Path(), "s", "motion.x")).excitation
        for keys in (
            {"kind": "record", **record},
            {"kind": "spectrum", **LIFE_SAFETY, "record": record, "method": "scale"},
        )
    ]
    ratio = made[1].samples_m_s2[1:-1] / made[0].samples_m_s2[1:-1]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    periods = np.geomspace(*spectra.BAND_S, 60)
    off = np.log(spectra.spectrum_m_s2(made[1].samples_m_s2, 0.02, periods) / target(**LIFE_SAFETY).accel_m_s2(periods))
    assert abs(off.mean()) <= 1e-9


@pytest.mark.parametrize(("key", "value"), [("pga_g", 0.3), ("pgv_m_s", 0.3), ("scale", -1.0)])
def test_a_factor_on_a_record_that_is_scaled_to_a_spectrum_is_refused(key: str, value: float) -> None:
    record = {"file": "record.csv", key: value}
    with pytest.raises(ValidationError, match=f"record.{key}"):
        ADAPTER.validate_python({"kind": "spectrum", **LIFE_SAFETY, "record": record})


def test_what_cannot_be_matched_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spectra, "MISFIT", 0.001)
    monkeypatch.setattr(spectra, "_PASSES", 1)
    keys = {"kind": "spectrum", **LIFE_SAFETY, "seed": 1, "duration_s": 10.0}
    with pytest.raises(InputError, match="try another seed"):
        prepare(SceneMotion(ADAPTER.validate_python(keys), Path(), "s", "motion.x"))
