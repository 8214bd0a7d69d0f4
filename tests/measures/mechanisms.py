"""What each mechanism of the event-located engines buys: error at equal cost with and without it.

`python -m tests.measures.mechanisms ENGINE [COUNT FIRST [WORD...]]` prints a line for each mechanism, or for those with a WORD
in their name, over the paper's cases, COUNT random scenes and some wide ones: the mean and the largest tenth of errors without
it over those with it, at equal processor time (errors are taken to fall with the step, cost to grow against it). A mechanism that
buys less than `WORTH` in both is not worth its lines.
"""

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Final

import numpy as np

from harness import Run, RunOptions, Scene, engines
from harness.comparison.scores import errors
from harness.engines.base import Engine, EngineFailure
from tests.measures.contact_engines import PAPER, paper_scene
from tests.measures.seeded_scenes import random_scene, wide_scene

STEPS_S: Final = (4e-3, 1e-3, 2.5e-4)
FINEST_S: Final = 1e-4
CONDITIONED_RAD: Final = 3e-4
"""Scenes on which the engine at `FINEST_S` is further than this from the model are ill-conditioned, or outside its domain."""
SMALLEST_RAD: Final = 1e-7
"""Smaller errors are taken as this."""
COUNT, FIRST_SEED = 24, 745_000
MICRO_ROCKING: Final = (10129, 20399, 20809, 20866)
"""Seeds of scenes with micro-rocking (`tests.measures.micro_rocking`), which random ones seldom do."""
WIDE: Final = 12
"""At most so many wide scenes beside the random ones: statues that slide, three axes. The engine's finest run is the truth."""
WORTH: Final = 1.3

Change = Mapping[str, Any]
"""By `module:attribute` what stands in its place; a function of what was there makes it."""


def _always(value: Any) -> Callable[[Any], Any]:
    return lambda _: lambda *__, **___: value


def _number(value: float) -> Callable[[Any], Any]:
    return lambda _: value


def _loose(own: Any) -> Any:
    """Settings whose equations at events are solved no more tightly than elsewhere."""
    return lambda self, *values, **named: own(
        self, *values, **(named | {"event_residual": 1.0, "event_iterations": 300})
    )


_M, _B = "harness.engines.pymunk.", "harness.engines.pybullet."
_E: Final = "harness.engines.stepping."
LAYER: Final[Mapping[str, Change]] = {
    "nothing (noise of the measurement)": {},
    "micro-rocking": {_E + "loop:after_impact": _always(None)},
    "stick onset located": {_E + "loop:_stick_onset": _always(16)},
    "uniform acceleration to contact": {_E + "step_state:ContactTimeEstimate._gathers": _always(0.0)},
    "velocities of the instant at contact": {
        _E + "step_state:ContactTimeEstimate.speeds": lambda _: lambda self: (self(), 1.0)
    },
    "velocities turned on": {_E + "step_state:StepState.turn": _always(None)},
    "lowered before a short step": {_E + "step_state:StepState.lower": _always(None)},
    "slip onset at its share of the step": {
        _E + "step_state:coefficient": lambda _: lambda stepper, *__: stepper.kinetic
    },
    "the step after a reversal solved again": {_E + "step_state:Stepper._reversed": _always(False)},
}
MUNK: Final[Mapping[str, Change]] = {
    **LAYER,
    "events located at all": {"harness.engines.pymunk:_located": _always(False)},
    "a turning statue held to its depth": {
        _M + "backend:SupportVertex._on_circle": lambda _: lambda self, state, *__: state
    },
    "its velocity corrected beforehand": {_M + "backend:velocity_owed": _always((0.0, 0.0))},
    "a statue at rest laid down": {
        _M + "backend:SupportVertex._at_rest": lambda _: lambda self, state, *__, **___: state
    },
    "more iterations at impacts": {"harness.engines.pymunk:AT_IMPACTS": _number(1)},
}
BULLET: Final[Mapping[str, Change]] = {
    **LAYER,
    "events located at all": {_B + "run_phases:gaps_of": _always(None)},
    "anchors let go where friction nears its limit": {_B + "world:BulletBackend._look_at_grip": _always(None)},
    "reach of contacts follows the turning": {
        _B + "world:NARROWER": _number(1e9),
        _B + "world:STEPS_OFF": _number(0.0),
    },
    "tighter equations at events": {_B + "settings:BulletSettings.__init__": _loose},
    "half of a symmetric scene": {_B + "run_phases:halves": _always(False)},
}
MECHANISMS: Final[Mapping[str, Mapping[str, Change]]] = {"pymunk": MUNK, "pybullet": BULLET}


@contextmanager
def changed(change: Change) -> Iterator[None]:
    """Put other things in the places of a change, and those that were there back at the end."""
    before = []
    for name, make in change.items():
        module, _, path = name.partition(":")
        owner: Any = import_module(module)
        *holders, last = path.split(".")
        for holder in holders:
            owner = getattr(owner, holder)
        before.append((owner, last, owner.__dict__[last]))
        setattr(owner, last, make(before[-1][2]))
    try:
        yield
    finally:
        for owner, last, own in reversed(before):
            setattr(owner, last, own)


def cases(engine: Engine, count: int, first: int) -> list[tuple[Scene, Run]]:
    """Scenes on which the engine converges to the model, with the model's runs."""
    model = engines.load("analytic")
    scenes = [paper_scene(a, f, pedestal=True, static=static) for a, f in PAPER for static in (0.15, 0.20)]
    scenes += [paper_scene(a, f, pedestal=False, static=0.15) for a, f in PAPER]
    scenes += [random_scene(seed) for seed in (*MICRO_ROCKING, *range(first, first + count))]
    runs = []
    for scene in scenes:
        exact = model.simulate(scene, model.refinement_levels(scene)[-1], RunOptions())
        fine = engine.simulate(scene, engine.settings_for_dt(scene, FINEST_S), RunOptions())
        if fine.outcome is exact.outcome and errors(fine, exact)[0] < CONDITIONED_RAD:
            runs.append((scene, exact))
    for seed in range(first, first + min(count, WIDE)):
        scene = wide_scene(seed)
        finer, fine = (
            engine.simulate(scene, engine.settings_for_dt(scene, dt), RunOptions()) for dt in (FINEST_S, 2.2 * FINEST_S)
        )
        if fine.outcome is finer.outcome and fine.history is not None and errors(fine, finer)[0] < CONDITIONED_RAD:
            runs.append((scene, finer))
    return runs


def measured(engine: Engine, on: Sequence[tuple[Scene, Run]], change: Change) -> tuple[np.ndarray, float]:
    """Errors of rotation, rad, shape (scenes, steps), and the processor time, s, that they took in all."""
    each_rad = np.full((len(on), len(STEPS_S)), np.inf)
    with changed(change):
        begin = time.process_time()
        for i, (scene, exact) in enumerate(on):
            for j, dt_s in enumerate(STEPS_S):
                try:
                    run = engine.simulate(scene, engine.settings_for_dt(scene, dt_s), RunOptions())
                except EngineFailure:
                    continue
                each_rad[i, j] = errors(run, exact)[0] if run.history is not None else np.inf
        cost_s = time.process_time() - begin
    return np.clip(each_rad, SMALLEST_RAD, 1.0), cost_s


def main(arguments: Sequence[str]) -> None:
    """Print the table."""
    name, *numbers = arguments
    count, first = (int(item) for item in numbers[:2]) if numbers else (COUNT, FIRST_SEED)
    asked = [each for each in MECHANISMS[name] if not numbers[2:] or any(word in each for word in numbers[2:])]
    engine = engines.load(name)
    on = cases(engine, count, first)
    own, own_s = measured(engine, on, {})
    say = sys.stdout.write
    say(f"{name}: {len(on)} scenes, steps of {', '.join(f'{1e3 * s:g}' for s in STEPS_S)} ms; with all: mean error ")
    say(f"{np.exp(np.mean(np.log(own))):.2e} rad, largest tenth {np.quantile(own, 0.9):.2e}, {own_s:.1f} s\n")
    say("| without | mean error, times | largest tenth, times | worst, times | cost, times | worth it |\n")
    say("|---|---|---|---|---|---|\n")
    for mechanism in asked:
        without, cost_s = measured(engine, on, MECHANISMS[name][mechanism])
        costly = cost_s / own_s
        ratio = without / own * costly
        mean, tenth = (
            float(np.exp(np.mean(np.log(ratio)))),
            float(np.quantile(without, 0.9) / np.quantile(own, 0.9)) * costly,
        )
        worth = "yes" if max(mean, tenth) >= WORTH else "no"
        say(f"| {mechanism} | {mean:.2f} | {tenth:.2f} | {ratio.max():.3g} | {costly:.2f} | {worth} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
