"""ISO/TS 18571 through the harness: the library's own numbers, only when asked, on a stated resampling."""

import subprocess
import sys
from dataclasses import replace

import numba
import numpy as np
import pytest

from harness import InputError, compare
from harness.comparison.scores import rate_by_iso, resampled
from harness.model import pair
from tests import doubles

pytest.importorskip("objective_rating_metrics", reason="the extra `iso` is not installed")


@pytest.fixture(scope="module", autouse=True)
def _uncompiled() -> None:
    """The library's time warping as Python: compiled, as each process does anew, it takes longer than all tests here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numba.config, "DISABLE_JIT", True)
        import objective_rating_metrics.rating  # noqa: F401


PARTS = ("corridor", "phase", "magnitude", "slope")
WEIGHTS = (0.4, 0.2, 0.2, 0.2)


@pytest.mark.filterwarnings("ignore")
def test_the_rating_is_the_library_s_on_the_resampled_curves() -> None:
    from objective_rating_metrics.rating import ISO18571

    history = doubles.rocking()
    both = pair(doubles.shifted(history, 0.05), history)
    found = rate_by_iso(both, samples=101)
    (a, b), step = resampled(both, 101)
    bare = ISO18571(reference_curve=b, comparison_curve=a, dt=step)
    assert found.overall == bare.overall_rating(-1)
    assert found.resampled_dt_s == pytest.approx(0.1)
    assert found.overall == pytest.approx(sum(w * getattr(found, part) for w, part in zip(WEIGHTS, PARTS, strict=True)))


def test_identical_histories_rate_one() -> None:
    history = doubles.rocking()
    found = rate_by_iso(pair(history, history), 101)
    assert [getattr(found, part) for part in (*PARTS, "overall")] == [1.0] * 5


def test_known_parts_by_hand() -> None:
    """Scaled by 1.2 in phase: the corridor holds |Δ| = 0.2|θ|, magnitude (0.5 − 0.2)/0.5 = 0.6, slope (2 − 0.2)/2 = 0.9."""
    history = doubles.wave()
    found = rate_by_iso(pair(doubles.scaled(history, 1.2), history), 201)
    size = np.abs(np.sin(2 * np.pi * np.linspace(0.0, 4.0, 201)))
    corridor = np.where(0.2 * size < 0.05, 1.0, ((0.5 - 0.2 * size) / 0.45) ** 2)
    assert found.corridor == pytest.approx(float(corridor.mean()), abs=1 / 201)  # one sample on the corridor's edge
    assert found.phase == 1.0
    assert found.slope == pytest.approx(0.9, abs=1e-9)
    # The warping may pair neighbours to lower the squares, so the magnitude is at least what the unwarped curves give.
    assert found.magnitude >= 0.6 - 1e-9


def test_doubles_rank_as_expected() -> None:
    history = doubles.rocking()
    names = {
        "near": doubles.shifted(history, 0.01),
        "late": doubles.shifted(history, 0.2),
        "flipped": doubles.flipped(history),
    }
    rated = {name: rate_by_iso(pair(double, history), 101).overall for name, double in names.items()}
    assert rated["near"] > rated["late"] > rated["flipped"]


def test_it_is_loaded_only_when_asked() -> None:
    code = (
        "import sys; from harness import compare; from tests import doubles; h = doubles.rocking(1.0);"
        "assert compare(h, h).iso is None; assert 'objective_rating_metrics' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_history_that_does_not_move_is_refused() -> None:
    history = doubles.wave()
    still = replace(history, theta_rad=np.zeros_like(history.t_s))
    with pytest.raises(InputError, match="histories that move"):
        compare(still, history, iso=True)


def test_the_extra_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "objective_rating_metrics.rating", None)
    with pytest.raises(InputError, match=r"rockcheck\[iso\]"):
        compare(doubles.wave(), doubles.wave(), iso=True)
