"""A long command is never silent off a terminal, and says nothing when quiet."""

from __future__ import annotations

import threading

import pytest

from harness.telling import Telling


def test_a_long_wait_is_told_again_and_again(capsys: pytest.CaptureFixture[str]) -> None:
    with Telling(quiet=False, silent_s=0.05) as telling:
        telling.engine("pybullet")
        threading.Event().wait(0.4)
    told = capsys.readouterr().err.splitlines()
    assert told[0] == "running pybullet"
    assert len(told) >= 3
    assert all(line.startswith("running pybullet: ") and line.endswith(" s so far") for line in told[1:])
    assert not any("\x1b" in line for line in told), "no colours off a terminal"


def test_quiet_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with Telling(quiet=True, silent_s=0.02) as telling:
        telling.now("drawing")
        threading.Event().wait(0.1)
    assert capsys.readouterr() == ("", "")
