"""A long command is never silent off a terminal, and says nothing when quiet."""

import threading
import time
import warnings

import pytest

from harness.runs import progress as telling
from harness.runs.progress import ProgressMessages, duration_words, progress


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
    monkeypatch.setattr(
        telling, "ProgressMessages", lambda quiet, counts: ProgressMessages(quiet, silent_s=0.05, counts=counts)
    )
    with progress("study", quiet=False) as told:
        told(0, 40)
        told(1, 40)
        threading.Event().wait(0.4)
    said = capsys.readouterr().err.splitlines()
    assert said[0] == "study: 0 of 40 runs"
    assert any(line.startswith("study: 1 of 40 runs: ") and "s so far" in line for line in said)


def test_the_time_left_is_that_of_the_clock(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A tenth of the tasks took two minutes by the clock, whatever the processor did meanwhile: nine times as long is left."""
    now_s = [1000.0]
    monkeypatch.setattr(time, "monotonic", lambda: now_s[0])
    with progress("study", quiet=False) as on_progress:
        on_progress(0, 40)
        for done in (1, 2, 3, 4):
            now_s[0] += 30.0
            on_progress(done, 40)
    assert capsys.readouterr().err.splitlines() == ["study: 0 of 40 runs", "study: 4 of 40 runs, about 18 min left"]
    with progress("blocks", quiet=False) as on_progress:
        on_progress(10, 50)
        now_s[0] += 60.0
        # Two workers finish at once what took each a minute.
        for done in (20, 30):
            on_progress(done, 50)
    assert capsys.readouterr().err.splitlines()[-1] == "blocks: 30 of 50 runs, about 60 s left"
    # Two workers have the last two in hand: the later of both takes half as long again, and then the page is written.
    with progress("last", quiet=False, workers=2, after_s=4.0) as on_progress:
        on_progress(0, 10)
        now_s[0] += 80.0
        on_progress(8, 10)
    assert capsys.readouterr().err.splitlines()[-1] == "last: 8 of 10 runs, about 34 s left"
    # Each may ask for others: what is left is not known.
    with progress("search", quiet=False, grows=True) as on_progress:
        on_progress(0, 0)
        on_progress(1, 3)
        now_s[0] += 10.0
        on_progress(2, 4)
    assert capsys.readouterr().err.splitlines() == ["search", "search: 1 of 3 runs", "search: 2 of 4 runs"]
    # A forecast of 30 s a task counts as ten tasks: it is told at once, and two tasks of no time take a sixth from it.
    with progress("forecast", quiet=False, each_s=30.0) as on_progress:
        on_progress(0, 20)
        on_progress(2, 20)
    assert capsys.readouterr().err.splitlines() == [
        "forecast: 0 of 20 runs, about 10 min left",
        "forecast: 2 of 20 runs, about 7.5 min left",
    ]
    assert [duration_words(value) for value in (0.0, 7.0, 5400.0, 2e5)] == ["1 s", "7 s", "1.5 h", "2.3 days"]


@pytest.mark.parametrize("quiet", [False, True])
def test_a_warning_is_one_line_or_nothing(quiet: bool, capsys: pytest.CaptureFixture[str]) -> None:
    before = warnings.showwarning
    with ProgressMessages(quiet):
        warnings.simplefilter("always")
        warnings.warn("two\nlines", RuntimeWarning, stacklevel=1)
    assert capsys.readouterr().err == ("" if quiet else "warning: two\\nlines\n")
    assert warnings.showwarning == before
