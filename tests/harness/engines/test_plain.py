"""Unmodified engines: nothing is written to a body after the start, and they converge to the model where it is unambiguous."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from harness import RunOptions
from harness.comparison.scores import error_rad, errors
from harness.engines.base import Engine
from harness.engines.stepping.support import followed
from harness.model import Contact, Scene
from tests import budgets_engines as budget
from tests.engines_for_tests import exact, ready, run
from tests.scenes_for_tests import paestum

MUNK_WRITES = ("cpBodySetPosition", "cpBodySetAngle", "cpBodySetVelocity", "cpBodySetAngularVelocity")
BULLET_WRITES = ("resetBasePositionAndOrientation", "resetBaseVelocity", "changeDynamics", "setPhysicsEngineParameter")


def counted(monkeypatch: pytest.MonkeyPatch, module: Any, names: tuple[str, ...]) -> dict[str, int]:
    """Calls by name of a simulator's functions that write to bodies, from now on."""
    calls = dict.fromkeys(names, 0)

    def counting(name: str, own: Callable[..., Any]) -> Callable[..., Any]:
        def call(*values: Any, **named: Any) -> Any:
            calls[name] += 1
            return own(*values, **named)

        return call

    for name in names:
        monkeypatch.setattr(module, name, counting(name, getattr(module, name)))
    return calls


def writes(engine: Engine, scene: Scene, monkeypatch: pytest.MonkeyPatch) -> dict[str, int]:
    """Calls that write to bodies in the longer of two runs and not in the shorter: those of the start are in both."""
    if engine.name.startswith("pymunk"):
        from harness.engines.pymunk import backend

        # Chipmunk's library lets none of its functions be replaced.
        chipmunk = SimpleNamespace(
            **{name: getattr(backend.lib, name) for name in dir(backend.lib) if name[:2] == "cp"}
        )
        monkeypatch.setattr(backend, "lib", chipmunk)
        calls = counted(monkeypatch, chipmunk, MUNK_WRITES)
    else:
        import pybullet

        calls = counted(monkeypatch, pybullet, BULLET_WRITES)
    engine.simulate(replace(scene, duration_s=0.6), engine.settings_for_dt(scene, 1e-3), RunOptions())
    short = dict(calls)
    engine.simulate(replace(scene, duration_s=0.9), engine.settings_for_dt(scene, 1e-3), RunOptions())
    return {name: count - 2 * short[name] for name, count in calls.items()}


@pytest.mark.parametrize("name", ["pymunk:plain", "pybullet:plain"])
def test_nothing_is_written_to_a_body_after_the_start(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert set(writes(ready(name), paestum(0.429, 3.0, mu=0.15), monkeypatch).values()) == {0}


@pytest.mark.parametrize("name", ["pymunk:plain", "pybullet:plain"])
def test_two_coefficients_write_to_the_floor_s_surface_alone(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    engine, scene = ready(name), paestum(0.429, 3.0, mu=(0.20, 0.15))
    written = writes(engine, scene, monkeypatch)
    surfaces = written.pop("changeDynamics", 0)
    assert set(written.values()) == {0}
    assert (surfaces > 0) is (name == "pybullet:plain")


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_the_count_of_writes_sees_those_of_the_other_engines(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert max(writes(ready(name), paestum(0.429, 3.0, mu=0.15), monkeypatch).values()) > 0


@pytest.mark.parametrize("name", ["pymunk:plain", "pybullet:plain"])
def test_where_one_coefficient_acts_it_converges_to_the_model(name: str) -> None:
    scene = paestum(0.429, 3.0, mu=0.15, duration_s=1.0)
    model, found = exact(scene), run(name, scene)
    off_rad, off_m = errors(found, model, found.end_s)
    assert off_rad <= budget.PLAIN_RAD
    assert off_m <= budget.PLAIN_SLIP_M


@pytest.mark.parametrize("name", ["pymunk:plain", "pybullet:plain"])
def test_the_coefficient_follows_the_sliding_pedestal(name: str) -> None:
    """A static coefficient that holds: no slip. One that does not: the pedestal slides with the kinetic one."""
    held, loose, static = (
        run(name, paestum(0.3, 2.0, mu=mu, duration_s=0.5), 5e-4).peak_slip_m
        for mu in ((0.9, 0.1), (0.2, 0.1), (0.2, 0.2))
    )
    assert held <= budget.PLAIN_SLIP_M
    assert loose > static > budget.PLAIN_SLIP_M


def test_the_coefficient_is_kinetic_after_two_steps_of_the_same_slip() -> None:
    contact, rest_m_s = Contact(0.2, 0.15, 1.0), 1e-5
    fast, slow = (3e-5, 4e-5), (3e-6, 4e-6)
    assert followed(contact, rest_m_s, fast, fast) == 0.15
    assert followed(contact, rest_m_s, slow, fast) == 0.2, "what one step let go may be held again in the next"
    assert followed(contact, rest_m_s, fast, slow) == 0.2
    assert followed(contact, rest_m_s, (-3e-5, -4e-5), fast) == 0.2, "it was at rest inside the step"


@pytest.mark.parametrize("page", ["docs/engines.md", "docs/scores.md"])
def test_pages_say_that_rule(page: str) -> None:
    text = (Path(__file__).parents[3] / page).read_text(encoding="utf-8")
    rule = "kinetic once the pedestal slid the same way at the ends of two steps in a row, else static"
    assert rule in " ".join(text.split())


@pytest.mark.parametrize("name", ["pymunk:plain", "pybullet:plain"])
@pytest.mark.parametrize("dt_s", [5e-4, 3.1e-4, 2.5e-4, 2.2e-4, 1e-4])
def test_whether_the_pedestal_sticks_is_no_chance_of_the_step(name: str, dt_s: float) -> None:
    """It comes to rest where holding it needs 0.16 of its weight, between both coefficients; sliding on it is 0.02 rad off."""
    scene = paestum(0.334, 2.0, mu=(0.20, 0.15))
    found = run(name, scene, dt_s)
    assert error_rad(exact(scene), found, found.end_s) <= budget.FOLLOWED_RAD
