"""Every skip that an engine declares has its switch, and changes nothing; none is used that is not declared."""

import subprocess
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness import Scene, engines
from harness.accuracy.refinement import run_to_accuracy
from harness.engines.base import Engine
from harness.model import SKIPS, Run, RunOptions
from harness.questions.bench.standard_scenes import COLUMN, PAESTUM, PEDESTAL, harmonic, scene_of
from harness.runs.store import Store
from harness.statics.plan import plan
from tests import budgets_bench as budgets
from tests.engines_for_tests import ready
from tests.stores_for_tests import put

NAMES = tuple(engines.REGISTRY)
CASES = [(name, skip) for name in NAMES for skip in sorted(engines.load(name).capabilities.skips)]
HARNESS_OWN = {"planar", "lazy_engines", "cached"}
"""Skips that are no engine's: an engine is left out, or a stored result taken."""


@dataclass(frozen=True)
class Watching(RunOptions):
    """Notes which skips a run asks about."""

    asked: set[str] = field(default_factory=set)

    def allows(self, name: str) -> bool:
        self.asked.add(name)
        return super().allows(name)


def shaken(name: str) -> Scene:
    """A scene in which the named skip has something to leave out."""
    pulse = {"kind": "pulse", "shape": "one_sine", "amplitude_g": 0.28, "duration_s": 0.5}
    if name in RECORDED:
        return recorded(name)
    contents: dict[str, dict[str, Any]] = {
        "pulse": {"duration_s": 1.5, "statue": COLUMN, "motion": {"x": pulse}},
        "no_history": {"duration_s": 0.4, "statue": COLUMN, "motion": harmonic(0.25, 2.0)},
        "base_only": {"duration_s": 0.3, "statue": PAESTUM, "pedestal": PEDESTAL, "motion": harmonic(0.3, 3.0)},
        "mirror": {"duration_s": 0.7, "statue": PAESTUM, "pedestal": PEDESTAL, "motion": harmonic(0.429, 3.0)},
        "stop_at_overturn": {"duration_s": 1.2, "statue": COLUMN, "motion": harmonic(0.6, 1.0)},
    }
    return scene_of(name, contents[name])


RECORDED = {"quiet_start": (2.0, 3.0, 3.0), "quiet_rest": (0.0, 0.5, 16.0), "quiet_end": (0.0, 0.5, 16.0)}
"""When the strong part of a record begins and ends, and the run's duration, s; the rest stays below every limit."""
BESIDE = {"quiet_end": {"quiet_rest"}}
"""What would leave out the same: switched off on both sides."""


def recorded(name: str) -> Scene:
    """A record at 2 Hz of which only a part can move the block."""
    from analytic.excitation import SampledAcceleration
    from harness.model import BaseExcitation

    begin, end, duration = RECORDED[name]
    t = np.arange(301) * 0.01
    accel = np.where((t >= begin) & (t < end), 0.28, 0.02) * 9.81 * np.sin(4.0 * np.pi * t)
    still = scene_of(name, {"duration_s": duration, "statue": COLUMN})
    return replace(still, base_excitation=BaseExcitation(x=SampledAcceleration(t, accel)))


def run(engine: Engine, scene: Scene, options: RunOptions) -> Run:
    # The coarsest level that is expected to resolve what a skip may change: a coarser one differs by its own error.
    settings = next(
        (item for item in engine.refinement_levels(scene) if item.expected_error_rad <= budgets.SKIP_RAD), None
    )
    return engine.simulate(scene, settings or engine.refinement_levels(scene)[-1], options)


def left_out(skip: str, on: Run, off: Run) -> bool:
    """Whether the run with the skip did without what it names."""
    if skip == "no_history":
        return on.history is None and off.history is not None
    if skip == "base_only":
        return off.validity.get("full_shape_from_s") == 0.0 and on.validity.get("full_shape_from_s") != 0.0
    if skip == "mirror":
        return bool(on.validity["mirrored"] and not off.validity["mirrored"])
    return on.steps < off.steps


@pytest.mark.parametrize(("name", "skip"), CASES)
def test_a_skip_leaves_something_out_and_changes_nothing(name: str, skip: str) -> None:
    engine, scene = ready(name), shaken(skip)
    history = skip != "no_history"
    every = frozenset(SKIPS) - BESIDE.get(skip, set())
    on = run(engine, scene, RunOptions(history=history, skips=every))
    off = run(engine, scene, RunOptions(history=history, skips=every - {skip}))
    assert on.outcome is off.outcome
    allowed = budgets.SAME_RAD if engine.capabilities.certifies else budgets.SKIP_RAD
    assert abs(on.peak_theta_rad - off.peak_theta_rad) <= allowed
    assert left_out(skip, on, off), f"{skip} leaves nothing out: {on.steps} steps with it, {off.steps} without"


@pytest.mark.parametrize("name", NAMES)
def test_an_engine_asks_about_the_skips_that_it_declares_and_no_others(name: str) -> None:
    engine = ready(name)
    options = Watching(history=False)
    on_a_pedestal = [replace(shaken("base_only"), duration_s=0.1)] if engine.capabilities.pedestal else []
    for scene in (shaken("no_history"), *on_a_pedestal):
        engine.simulate(scene, engine.refinement_levels(scene)[0], options)
    assert options.asked == set(engine.capabilities.skips), "declare what is used in Capabilities.skips"


def test_the_plan_lists_every_skip_that_there_is() -> None:
    loaded = [engines.load(name) for name in NAMES]
    assert {step.skip for step in plan(shaken("no_history"), loaded, RunOptions())} == set(SKIPS)
    assert set().union(*(engine.capabilities.skips for engine in loaded)) == set(SKIPS) - HARNESS_OWN


def test_a_planar_question_has_one_answer_in_the_plane_and_in_three_dimensions() -> None:
    scene = shaken("pulse")
    flat, solid = (run_to_accuracy(ready(name), scene, 1e-3, RunOptions()) for name in ("pymunk", "pybullet"))
    assert flat.outcome is solid.outcome
    times = np.linspace(0.0, 1.5, 500)
    assert float(np.max(np.abs(flat.history.at(times) - solid.history.at(times)))) <= 2e-3, "each may err by 1e-3 rad"


def test_engines_that_are_not_imported_change_no_bit() -> None:
    code = """
from harness.questions.bench.standard_scenes import COLUMN, harmonic, scene_of
from harness.engines import REGISTRY, load
from harness.accuracy.refinement import simulate
{first}
run = simulate(scene_of("short", {{"duration_s": 0.5, "statue": COLUMN, "motion": harmonic(0.3, 2.0)}}), "pymunk", dt_s=1e-3)
print(run.steps, run.history.theta_rad.tobytes().hex())
"""
    ready("pymunk")
    eager = "for name in REGISTRY: load(name).missing()"
    said = [
        subprocess.run(
            [sys.executable, "-c", code.format(first=first)], capture_output=True, text=True, check=True
        ).stdout
        for first in ("", eager)
    ]
    assert said[0] == said[1]
    assert len(said[0]) > 1000


def test_a_stored_result_is_the_computed_one_bit_for_bit(tmp_path: Path) -> None:
    engine, scene = ready("pymunk"), shaken("no_history")
    computed = engine.simulate(scene, engine.settings_for_dt(scene, 1e-3), RunOptions())
    with Store(tmp_path / "store.sqlite") as store:
        put(store, [("key", computed)], histories=True)
        stored = store.run("key")
    assert (stored.outcome, stored.peak_theta_rad, stored.steps) == (
        computed.outcome,
        computed.peak_theta_rad,
        computed.steps,
    )
    assert np.array_equal(stored.history.theta_rad, computed.history.theta_rad)
