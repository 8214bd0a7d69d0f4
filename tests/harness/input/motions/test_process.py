"""Each processing step against what is known of it; acceleration, velocity and displacement of one motion agree."""

from pathlib import Path

import numpy as np
import pytest

from harness.input.mistakes import Contradiction
from harness.input.motions import process
from harness.input.motions.recordfile import Series, displacement_m, velocity_m_s
from harness.input.motions.records import load
from harness.input.motions.spec import RecordSpec
from harness.input.motions.spectra import measures, peak_velocity_m_s
from harness.model import InputError
from tests import doubles
from tests.budgets_motions import FILTER_PASS, FILTER_STOP, RETURN_TO_REST_M, RETURN_TO_REST_M_S, SAME_MOTION
from tests.harness.input.motions.writers import GRAVITY, wave

NOISE = Series(0.01, np.random.default_rng(3).normal(size=2000) * np.hanning(2000))


def test_velocity_and_displacement_are_those_of_the_excitation() -> None:
    record = NOISE.excitation()
    np.testing.assert_allclose(velocity_m_s(NOISE), record.velocity_m_s(NOISE.t_s), atol=SAME_MOTION)
    np.testing.assert_allclose(displacement_m(NOISE), record.displacement_m(NOISE.t_s), atol=10.0 * SAME_MOTION)


def test_integrals_of_a_cubic_displacement_are_exact() -> None:
    series = Series(0.1, np.linspace(0.0, 6.0, 11))  # a = 6t
    np.testing.assert_allclose(velocity_m_s(series), 3.0 * series.t_s**2, atol=SAME_MOTION)
    np.testing.assert_allclose(displacement_m(series), series.t_s**3, atol=SAME_MOTION)


@pytest.mark.parametrize("kind", ["mean", "linear", "quadratic"])
def test_a_polynomial_baseline_is_removed(kind: process.Baseline) -> None:
    t = np.linspace(-1.0, 1.0, 2000)
    drift = {"mean": 0.3 + 0.0 * t, "linear": 0.3 - 0.2 * t, "quadratic": 0.3 - 0.2 * t + 0.1 * t**2}[kind]
    clean = process.baseline(NOISE, kind).accel_m_s2
    drifting = Series(0.01, NOISE.accel_m_s2 + drift)
    found = process.baseline(drifting, kind)
    np.testing.assert_allclose(found.accel_m_s2, clean, atol=SAME_MOTION)
    assert found.done[-1].code == "step_baseline"


def test_the_rest_baseline_returns_to_rest() -> None:
    assert abs(displacement_m(NOISE)[-1]) > 1e3 * RETURN_TO_REST_M
    found = process.baseline(NOISE, "rest")
    assert abs(velocity_m_s(found)[-1]) <= RETURN_TO_REST_M_S
    assert abs(displacement_m(found)[-1]) <= RETURN_TO_REST_M
    assert found.accel_m_s2[0] == NOISE.accel_m_s2[0]


def test_the_band_pass_passes_and_stops() -> None:
    t = 0.01 * np.arange(6000)
    middle = slice(2000, 4000)
    passed = process.bandpass(Series(0.01, np.sin(2.0 * np.pi * 2.0 * t)), 0.5, 20.0)
    np.testing.assert_allclose(passed.accel_m_s2[middle], np.sin(2.0 * np.pi * 2.0 * t)[middle], atol=FILTER_PASS)
    stopped = process.bandpass(Series(0.01, np.sin(2.0 * np.pi * 0.125 * t)), 0.5, 20.0)
    assert np.abs(stopped.accel_m_s2[middle]).max() <= FILTER_STOP
    with pytest.raises(Contradiction, match=r"^bandpass_hz: .*, got 50 Hz"):
        process.bandpass(NOISE, 0.5, 50.0)


def test_a_corner_or_a_step_that_asks_for_endless_memory_is_refused() -> None:
    lowest_hz = process.LEAST_PERIODS / NOISE.duration_s
    process.bandpass(NOISE, 1.001 * lowest_hz, 20.0)
    for low_hz in (1e-300, 1e-6, 0.999 * lowest_hz):
        with pytest.raises(Contradiction) as refused:
            process.bandpass(NOISE, low_hz, 20.0)
        assert refused.value.key == "bandpass_hz"
        assert f"{lowest_hz:.4g} Hz" in refused.value.wanted
    long = Series(0.05, np.ones(int(process.MOST_SAMPLES) // 1000))
    with pytest.raises(Contradiction) as refused:
        process.resample(long, 1e-5)
    assert refused.value.key == "resample_dt_s"


@pytest.mark.parametrize(
    ("printed", "largest", "codes", "at_s"),
    [
        ([0, 0, 1, 1, 2, 2], 3, ["record_times_spread"], [0.0, 0.005, 0.01, 0.015, 0.02, 0.025]),
        ([0, 1, 1, 2, 3, 3, 4], 2, ["record_times_spread", "record_times_uneven"], [0.005 * k for k in range(9)]),
    ],
)
def test_times_of_a_film_that_are_printed_alike_are_spread(
    printed: list[int], largest: int, codes: list[str], at_s: list[float]
) -> None:
    """And the largest sample stays on the clock; of a file of samples doubled times are a mistake."""
    times_s = 0.01 * np.array(printed)
    clock = process.clock_of(times_s, "film", largest=largest)
    assert doubles.codes(clock.said) == codes
    assert clock.start_s + clock.dt_s * np.arange(clock.count) == pytest.approx(at_s)
    peak = np.arange(len(printed)) == largest
    assert clock.on(1.0 * peak).max() == 1.0
    with pytest.raises(InputError, match="increasing times"):
        process.clock_of(times_s, "samples")


def test_a_finer_step_is_the_same_motion() -> None:
    finer = process.resample(NOISE, 0.0025)
    np.testing.assert_allclose(finer.accel_m_s2[::4], NOISE.accel_m_s2, atol=SAME_MOTION)
    np.testing.assert_allclose(displacement_m(finer)[::4], displacement_m(NOISE), atol=10.0 * SAME_MOTION)
    assert process.resample(NOISE, 0.01) is NOISE


def test_a_coarser_step_folds_nothing_back() -> None:
    t = 0.005 * np.arange(4000)
    fast = Series(0.005, np.sin(2.0 * np.pi * 45.0 * t) * np.hanning(4000))
    assert np.abs(process.resample(fast, 0.02).accel_m_s2).max() <= 0.01
    assert np.abs(fast.accel_m_s2[::4]).max() > 0.5  # dropping samples would keep it, at 5 Hz
    with pytest.raises(Contradiction, match="a simple ratio"):
        process.resample(NOISE, 0.0123456789)


def test_window_and_significant_duration() -> None:
    cut = process.window(NOISE, 2.0, 5.0)
    np.testing.assert_array_equal(cut.accel_m_s2, NOISE.accel_m_s2[200:501])
    with pytest.raises(Contradiction, match=r"^window_s: .*, got 30 to 40 s"):
        process.window(NOISE, 30.0, 40.0)
    short = process.significant(NOISE, (0.05, 0.95), NOISE.accel_m_s2**2)
    assert short.duration_s == pytest.approx(measures(NOISE).significant_5_95_s, abs=2.0 * NOISE.dt_s)


def test_scaling_reaches_pga_and_pgv_and_keeps_their_sign() -> None:
    assert measures(process.to_pga(NOISE, 0.4)).pga_g == pytest.approx(0.4, rel=SAME_MOTION)
    assert measures(process.to_pgv(NOISE, 0.2)).pgv_m_s == pytest.approx(0.2, rel=SAME_MOTION)
    assert process.scaled(NOISE, -1.0, "sign").accel_m_s2[77] == -NOISE.accel_m_s2[77]
    assert process.scaled(NOISE, 1.0, "scale").done == ()


@pytest.mark.parametrize("more", [
    {}, {"pga_g": 0.3}, {"pgv_m_s": 0.3}, {"baseline": "mean"}, {"significant": (0.05, 0.95)}, {"bandpass_hz": (1.0, 9.0)},
])  # fmt: skip
def test_a_part_of_a_record_in_which_it_is_at_rest_is_refused(more: dict[str, object], tmp_path: Path) -> None:
    """A factor on it would be infinite. What another channel does is its own."""
    t = 0.01 * np.arange(1000)
    late = np.where(t > 3.0, np.sin(12.0 * t), 0.0)
    table = np.column_stack([t, late, np.roll(late, -250)])
    np.savetxt(tmp_path / "r.csv", table, delimiter=",", header="t_s,a_ms2,b_ms2", comments="", fmt="%.6g")
    made = {"kind": "record", "file": str(tmp_path / "r.csv"), "window_s": (0.0, 2.0), **more}
    with pytest.raises(InputError, match=r"motion\.x\.file: .* r\.csv"):
        load(RecordSpec(**made, column="a_ms2"), base_dir=tmp_path, where="scene", key="motion.x")  # type: ignore[arg-type]
    moving, _ = load(RecordSpec(**made, column="b_ms2"), base_dir=tmp_path, where="scene", key="motion.x")  # type: ignore[arg-type]
    assert moving.accel_m_s2.any()


def test_measures_of_a_sine_have_closed_forms() -> None:
    amplitude, frequency = 2.0, 1.0
    series = Series(0.001, amplitude * np.sin(2.0 * np.pi * frequency * 0.001 * np.arange(10001)))
    found = measures(series)
    assert found.pga_g == pytest.approx(amplitude / GRAVITY, rel=1e-6)
    assert found.pgv_m_s == pytest.approx(2.0 * amplitude / (2.0 * np.pi * frequency), rel=1e-5)
    assert measures(series).arias_m_s == pytest.approx(np.pi / (2.0 * GRAVITY) * amplitude**2 / 2.0 * 10.0, rel=1e-6)
    assert found.significant_5_95_s == pytest.approx(9.0, abs=0.05)
    assert found.bracketed_s == pytest.approx(10.0, abs=0.1)


def test_peak_velocity_is_found_between_samples() -> None:
    series = Series(1.0, np.array([0.0, 1.0, -1.0, 0.0]))
    assert peak_velocity_m_s(series) == pytest.approx(0.75)  # 0.5 at both samples, and ½ · 1 · ½ more between them
    assert peak_velocity_m_s(Series(0.01, wave())) > 0.0
