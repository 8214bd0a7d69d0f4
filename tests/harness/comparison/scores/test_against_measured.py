"""A simulation against a measurement: E = S − D with the uncertainties of numbers, inputs and measurement."""

import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import harness
from harness import History, InputError, compare
from harness.comparison.scores import COVERAGE, Measured
from reports.cli import app
from tests import doubles
from tests.budgets_compare import ROUNDING_REL


def rocking(amplitude_rad: float) -> History:
    """A decaying sine that begins at its crest."""
    t = np.linspace(0.0, 4.0, 4001)
    theta = amplitude_rad * np.exp(-t) * np.cos(9.0 * t)
    rate = -theta - 9.0 * amplitude_rad * np.exp(-t) * np.sin(9.0 * t)
    return History(t, theta, rate, 0.0 * t, 0.0 * t)


@pytest.mark.parametrize(
    ("simulated_rad", "code"), [(0.105, "model_error_not_told"), (0.113, "model_error"), (0.087, "model_error")]
)
def test_an_error_counts_beyond_twice_the_uncertainties_together(simulated_rad: float, code: str) -> None:
    """u_num = 3 mrad/√3, u_input = 3 mrad and u_D = 4 mrad make 5.3 mrad: 5 mrad are within twice that, 13 are not."""
    scores = compare(
        rocking(simulated_rad), rocking(0.1), uncertainties_rad=(3e-3, None), measured=Measured(4e-3, 3e-3)
    )
    found = scores.comparison_error
    assert found.u_val_rad == pytest.approx(math.sqrt(3e-6 + 9e-6 + 16e-6), rel=ROUNDING_REL)
    assert found.error_rad == pytest.approx(simulated_rad - 0.1, rel=1e-9)
    said = scores.findings[-1]
    assert said.code == code
    assert said.values["high_rad"] - found.error_rad == pytest.approx(COVERAGE * found.u_val_rad)


def test_the_share_of_the_time_is_that_beyond_twice_u_val() -> None:
    """Of E = 0.02 e⁻ᵗ cos 9t what exceeds 2 u_D = 0.01 lies in the first ln 2 seconds."""
    scores = compare(rocking(0.12), rocking(0.1), measured=Measured(5e-3))
    t = np.linspace(0.0, 4.0, 100_001)
    wanted = np.mean(np.abs(0.02 * np.exp(-t) * np.cos(9.0 * t)) > 0.01)
    assert scores.comparison_error.beyond_share == pytest.approx(wanted, abs=1e-3)


def test_a_measured_history_that_is_the_simulation_and_noise_is_within_its_uncertainty() -> None:
    """Of 200 histories with their own error of the whole, 95 % have their E within 2 u_val."""
    random, known = np.random.default_rng(0), 0
    for error in 0.004 * random.standard_normal(200):
        seen = rocking(0.1 + error)
        known += compare(rocking(0.1), seen, measured=Measured(4e-3)).findings[-1].code == "model_error_not_told"
    # The standard error of 0.954 of 200 is 0.015: three of them.
    assert known / 200 == pytest.approx(0.954, abs=0.045)


def test_two_files_are_compared_by_options_and_wrong_ones_are_told(tmp_path: Path) -> None:
    for name, amplitude in (("a.csv", 0.12), ("b.csv", 0.1)):
        rocking(amplitude).write_csv(tmp_path / name)
    files = [str(tmp_path / "a.csv"), str(tmp_path / "b.csv")]
    answer = CliRunner().invoke(app, ["compare", *files, "--measured-uncertainty", "0.004", "--json"])
    assert answer.exit_code == 0, answer.output
    assert '"model_error"' in answer.output
    alone = CliRunner().invoke(app, ["compare", *files, "--input-uncertainty", "0.004"])
    assert isinstance(alone.exception, InputError)
    with pytest.raises(InputError, match=r"^--measured-uncertainty: .* got -1\.0$"):
        harness.compare_files(*files, measured=Measured(-1.0))


@pytest.mark.parametrize(("bounded_s", "told_s"), [(2.0, 2.0), (1e3, None)])
def test_a_largest_rotation_of_a_part_is_told_as_one(bounded_s: float, told_s: float | None) -> None:
    """Up to where the numerical error is bounded: what swings further comes after."""
    run = doubles.run_of(rocking(0.12), "analytic", numerical_uncertainty_rad=1e-6, reliable_until_s=bounded_s)
    said = compare(run, rocking(0.1), measured=Measured(5e-3)).findings[-1]
    assert said.values["until_s"] == told_s
