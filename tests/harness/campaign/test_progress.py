"""A long command is never silent off a terminal, and says nothing when quiet."""

from __future__ import annotations

import threading

import pytest

from harness.campaign import progress as telling
from harness.campaign.progress import ProgressMessages, progress


def test_a_long_wait_is_told_again_and_again(capsys: pytest.CaptureFixture[str]) -> None:
    with ProgressMessages(quiet=False, silent_s=0.05) as telling:
        telling.engine("pybullet")
        threading.Event().wait(0.4)
    told = capsys.readouterr().err.splitlines()
    assert told[0] == "running pybullet"
    assert len(told) >= 3
    assert all(line.startswith("running pybullet: ") and line.endswith(" s so far") for line in told[1:])
    assert not any("\x1b" in line for line in told), "no colours off a terminal"


def test_quiet_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with ProgressMessages(quiet=True, silent_s=0.02) as telling:
        telling.now("drawing")
        threading.Event().wait(0.1)
    assert capsys.readouterr() == ("", "")


def test_a_study_is_never_long_silent(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Nothing finishes for a while: the line of what is done comes again, with the time since."""
    monkeypatch.setattr(telling, "ProgressMessages", lambda quiet: ProgressMessages(quiet, silent_s=0.05))
    with progress("study", quiet=False) as told:
        told(0, 40)
        told(1, 40)
        threading.Event().wait(0.4)
    said = capsys.readouterr().err.splitlines()
    assert said[0] == "study: 0 of 40 runs"
    assert any(line.startswith("study: 1 of 40 runs: ") and line.endswith("s so far") for line in said)
