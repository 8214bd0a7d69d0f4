"""A crash, a hang, an exception and a plain answer of a process of its own."""

import os
import signal
import time

import numpy as np
import pytest

from harness import Outcome, RunOptions
from harness.accuracy.simulation import RunTarget
from harness.engines.pymunk import Munk2D
from harness.runs.runner import Crash, Hung
from harness.runs.task import call, simulate_isolated
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


def test_a_crash_names_its_signal() -> None:
    with pytest.raises(Crash, match="SIGSEGV"):
        call(crash)


def test_an_exit_names_its_code() -> None:
    with pytest.raises(Crash, match="code 7"):
        call(leave)


def test_a_hang_is_ended() -> None:
    begin = time.monotonic()
    with pytest.raises(Hung, match="no answer"):
        call(hang, timeout_s=HANG_S)
    assert time.monotonic() - begin < 10.0 * HANG_S


def test_an_exception_is_the_callers() -> None:
    with pytest.raises(ArithmeticError, match="of its own"):
        call(fail)


def test_a_run_is_the_same_bit_for_bit_in_a_process_of_its_own() -> None:
    on = paestum(duration_s=0.5)
    other = simulate_isolated(on, "pymunk", RunTarget(dt_s=1e-3))
    here = Munk2D()
    own = here.simulate(on, here.settings_for_dt(on, 1e-3), RunOptions())
    np.testing.assert_array_equal(other.history.theta_rad, own.history.theta_rad)


def test_a_run_that_takes_too_long_is_recorded() -> None:
    run = simulate_isolated(paestum(duration_s=600.0), "pymunk", RunTarget(dt_s=1e-5), timeout_s=HANG_S)
    assert run.outcome is Outcome.TIMED_OUT
    assert run.history is None
    assert "no answer" in run.message
