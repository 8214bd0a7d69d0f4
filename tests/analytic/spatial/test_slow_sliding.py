"""Bases that slide slowly: they begin, turn and stop with friction whose direction the motion itself has to give."""

from typing import Final

import pytest

import analytic
from analytic import spatial
from analytic.block import GRAVITY_M_S2 as GRAVITY

FRICTION: Final = 0.4
BODY: Final = spatial.Body.block(400.0, 0.35, 0.45, 1.1)
LONG_S: Final = 2.0
COARSE: Final = 1e-7
"""Local error of a run for its outcome: the finest ones of these scenes take up to a million steps."""
SCENES: Final = (
    (2.0, 1.0 / 0.6, 0.9158),
    (2.0, 1.0 / 0.7, 0.9158),
    (2.0, 1.1, 1.2),
    (2.0, 1.7, 1.1053),
    (1.25, 1.0 / 0.7, 0.8211),
    (1.25, 1.3, 0.9632),
    (1.25, 1.1, 1.1526),
    (1.25, 1.7, 0.9158),
    (1.0, 1.1, 0.7737),
    (1.5, 1.0 / 0.7, 0.7737),
    (1.5, 1.3, 1.1526),
    (1.5, 1.1, 0.7737),
)
"""Frequencies of one sine along x and y, Hz, and their factor. Each once ended as a paradox at one local error or another."""


def problem(x_hz: float, y_hz: float, factor: float) -> spatial.Problem:
    """One sine of 0.4 g along x and one of 0.35 g along y, both times the factor."""
    x, y = (
        analytic.Pulse("one_sine", amplitude * factor * GRAVITY, 1.0 / hz)
        for amplitude, hz in ((0.4, x_hz), (0.35, y_hz))
    )
    return spatial.Problem(BODY, LONG_S, FRICTION, None, x, y, gravity_m_s2=GRAVITY)


@pytest.mark.parametrize("scene", SCENES)
def test_a_mode_is_possible_all_the_time(scene: tuple[float, float, float]) -> None:
    """At a coefficient of 0.4 these bodies are far from Painlevé's paradox: a run must reach its end, and there rest."""
    run = spatial.solve(problem(*scene), tolerance=COARSE, dt_out_s=None)
    assert run.outcome is spatial.Outcome.STANDS
    assert run.intervals[-1].mode is spatial.Mode.REST
    assert not run.gave_up


def test_a_run_of_ever_shorter_steps_is_given_up_and_says_so() -> None:
    """A slide may take steps without end: here they are held to 0.2 µs, 1.7 million of them to the end."""
    most = 20_000
    run = spatial.solve(problem(*SCENES[0]), tolerance=COARSE, step_cap_s=2e-7, dt_out_s=None, most_steps=most)
    assert run.gave_up
    assert run.work.steps == most
    assert run.end_s < LONG_S
