"""A crash, a hang, an exception and a plain answer of a process of its own."""

import os
import signal
import time
from collections.abc import Callable

import numpy as np
import pytest

from harness import Outcome
from harness.accuracy.refinement import RunTarget
from harness.runs.runner import Crash, Hung
from harness.runs.task import call, simulate_isolated
from tests.engines_for_tests import run
from tests.scenes_for_tests import paestum

HANG_S = 3.0


def add(a: int, b: int) -> int:
    return a + b


def crash() -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def leave() -> None:
    os._exit(7)


def hang() -> None:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    time.sleep(600.0)


def fail() -> None:
    raise ArithmeticError("of its own")


def test_an_answer_comes_back() -> None:
    assert call(add, (2, 3)) == 5


@pytest.mark.parametrize(
    ("work", "kind", "said"),
    [
        (crash, Crash, "SIGSEGV"),
        (leave, Crash, "code 7"),
        (hang, Hung, "no answer"),
        (fail, ArithmeticError, "of its own"),
    ],
)
def test_a_crash_an_exit_a_hang_and_an_exception_are_told(
    work: Callable[[], None], kind: type[Exception], said: str
) -> None:
    begin = time.monotonic()
    with pytest.raises(kind, match=said):
        call(work, timeout_s=HANG_S if work is hang else 10.0 * HANG_S)
    assert time.monotonic() - begin < 10.0 * HANG_S


def test_a_run_is_the_same_bit_for_bit_in_a_process_of_its_own() -> None:
    on = paestum(duration_s=0.5)
    other = simulate_isolated(on, "pymunk", RunTarget(dt_s=1e-3))
    np.testing.assert_array_equal(other.history.theta_rad, run("pymunk", on, 1e-3).history.theta_rad)


def test_a_run_that_takes_too_long_is_recorded() -> None:
    late = simulate_isolated(paestum(duration_s=600.0), "pymunk", RunTarget(dt_s=1e-5), timeout_s=HANG_S)
    assert (late.outcome, late.history) == (Outcome.TIMED_OUT, None)
    assert "no answer" in late.message
