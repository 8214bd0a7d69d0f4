"""Histories are frozen, finite and read back as written."""

import pickle
from pathlib import Path

import numpy as np
import pytest

from harness.input.history_file import read_history
from harness.model import COLUMNS, History, Outcome, hermites, output_grid
from tests.budgets import HERMITE_ROUNDING


def wave(n: int = 11) -> History:
    t = np.linspace(0.0, 1.0, n)
    return History(t, np.sin(t), np.cos(t), 0.1 * t, np.full(n, 0.1), {"yaw_rad": t**2})


def test_a_history_cannot_be_changed() -> None:
    history = wave()
    with pytest.raises(ValueError, match="read-only"):
        history.theta_rad[0] = 1.0
    with pytest.raises(TypeError):
        history.extra["yaw_rad"] = history.t_s  # type: ignore[index]


def test_csv_round_trip_is_bit_for_bit(tmp_path: Path) -> None:
    history = wave()
    history.write_csv(tmp_path / "h.csv")
    assert (tmp_path / "h.csv").read_text().splitlines()[0] == ",".join((*COLUMNS, "yaw_rad"))
    for back in (read_history(tmp_path / "h.csv"), History.read_csv(tmp_path / "h.csv")):
        assert list(back.columns()) == list(history.columns())
        for name, values in history.columns().items():
            assert np.array_equal(values, back.columns()[name]), name


@pytest.mark.parametrize(
    "text", ["theta_rad,t_s\n0,0\n", f"{','.join(COLUMNS)}\n0,0,0,0\n", f"{','.join(COLUMNS)}\n0,0,0,0,nan\n"]
)
def test_only_a_file_as_it_is_written_is_read_at_once(text: str, tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text(text)
    with pytest.raises(ValueError, match=r".+"):
        History.read_csv(tmp_path / "h.csv")


def test_a_history_travels_between_processes() -> None:
    history = wave()
    back = pickle.loads(pickle.dumps(history))
    assert all(np.array_equal(values, back.columns()[name]) for name, values in history.columns().items())
    assert not back.theta_rad.flags.writeable


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"theta_rad": np.array([0.0, np.nan])}, "theta_rad is not finite at sample 1"),
        ({"t_s": np.array([0.0, 0.0])}, "increase strictly"),
        ({"slip_m": np.zeros(3)}, "shape"),
        ({name: np.zeros(0) for name in COLUMNS}, "at least one sample"),
    ],
)
def test_what_is_no_history_is_refused(change: dict[str, np.ndarray], message: str) -> None:
    columns = {name: np.zeros(2) for name in COLUMNS} | {"t_s": np.array([0.0, 1.0])} | change
    with pytest.raises(ValueError, match=message):
        History(**columns)


def test_hermite_is_exact_for_cubics_and_holds_beyond_the_ends() -> None:
    knots = np.array([0.0, 0.3, 1.0])
    values, rates = knots**3 - knots, 3.0 * knots**2 - 1.0
    t = np.array([-1.0, 0.1, 0.3, 0.77, 1.0, 2.0])
    expected = np.array([0.0, 0.1**3 - 0.1, 0.3**3 - 0.3, 0.77**3 - 0.77, 0.0, 0.0])
    assert np.max(np.abs(hermites(t, knots, ((values, rates),))[0] - expected)) <= HERMITE_ROUNDING


def test_the_output_grid_ends_at_the_last_instant() -> None:
    assert output_grid(1.0, 0.1).size == 11
    assert np.array_equal(output_grid(0.25, 0.1), [0.0, 0.1, 0.2, 0.25])
    assert output_grid(0.3, 0.1)[-1] == pytest.approx(0.3)
    assert output_grid(0.3, 0.1).size == 4


def test_an_outcome_knows_a_fall_and_a_failure() -> None:
    assert Outcome.OVERTURNED_FRONT.overturned
    assert not Outcome.STANDS.overturned
    assert Outcome.CRASHED.failed
    assert not Outcome.UNDECIDED.failed
