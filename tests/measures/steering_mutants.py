"""Every wrong formula of what locates events, on many scenes: does the account of writes, or of the floor's friction, see it?

`python -m tests.measures.steering_mutants ENGINE [COUNT FIRST]` runs COUNT random scenes under each mutant at 1 ms and prints, by
mutant: scenes on which it acts at all, on how many of these the run fails (the steps do not explain what was written, or the
floor's friction is not Coulomb's), on how many it does not though the result moved, and the largest such movement.
"""

import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from harness import Run, RunOptions, Scene, engines
from harness.comparison.scores import error_rad
from harness.engines.base import EngineFailure
from tests.measures.mechanisms import Change, changed
from tests.measures.seeded_scenes import random_scene

STEP_S: Final = 1e-3
COUNT, FIRST_SEED = 60, 780_000
LIMIT: Final = 1.1
ARM: Final = 0.01
BESIDE_M: Final = 0.04
"""Distance of a wrong pivot from the vertex that stands."""
TURNED_RAD: Final = 1e-5
State = tuple[float, ...]


def _turned(change: Callable[[State, State], State]) -> Callable[[Any], Any]:
    """A writer whose `turn_on` is another: `change(before, after)` gives the state that is written."""

    def make(own: Any) -> Any:
        def write(self: Any, kind: str, before: State, after: State) -> None:
            own(self, kind, before, change(before, after) if kind == "turn_on" else after)

        return write

    return make


@dataclass(frozen=True)
class Columns:
    """Where a state has the statue's velocity along x and z, its rate of turning in the plane, and the support's velocity."""

    x: int
    z: int
    spin: int
    base_x: int | None = None


def _scaled(at: Columns, share: float) -> Callable[[State, State], State]:
    """The velocity times `share`: −1 is the other sign, 1.01 an arm that is too long."""

    def change(before: State, after: State) -> State:
        new = list(after)
        base = after[at.base_x] if at.base_x is not None and at.base_x < len(after) else 0.0
        new[at.x], new[at.z] = base + share * (after[at.x] - base), share * after[at.z]
        return tuple(new)

    return change


def _beside(at: Columns) -> Callable[[State, State], State]:
    """About a point beside the vertex that stands."""

    def change(before: State, after: State) -> State:
        new = list(after)
        new[at.z] += BESIDE_M * before[at.spin]
        return tuple(new)

    return change


def _turns(writer: str, at: Columns) -> dict[str, Change]:
    return {
        "pivot": {writer: _turned(_beside(at))},
        "sign": {writer: _turned(_scaled(at, -1.0))},
        "arm + 1 %": {writer: _turned(_scaled(at, 1.0 + ARM))},
        "arm − 1 %": {writer: _turned(_scaled(at, 1.0 - ARM))},
    }


def _limits(own: Any) -> Any:
    def start(self: Any, *values: Any) -> None:
        own(self, *values)
        self.static, self.kinetic = LIMIT * self.static, LIMIT * self.kinetic

    return start


def _static(own: Any) -> Any:
    """The step in which the pedestal breaks loose is not solved again."""

    def slip_onset(self: Any, gravity: Any, pull: Any, before: Any, row: Any) -> Any:
        gaining = math.hypot(*self._slip(before, row, self.table_rate)) > math.hypot(*self.slip_before)
        if gaining and self._share_of_limit(self.static, pull, before, row) >= 1.0 - self.events.unsolved:
            self._hold(self.kinetic)
        return row

    return slip_onset


def _at_impact(first: int, last: int, share: float) -> Callable[[Any], Any]:
    """A writer that multiplies some numbers of the row that it writes at an impact."""

    def make(own: Any) -> Any:
        def write(self: Any, kind: str, before: State, after: State) -> None:
            if kind == "impact":
                after = (*after[:first], *(share * value for value in after[first:last]), *after[last:])
            own(self, kind, before, after)

        return write

    return make


def _turned_at_impact(own: Any) -> Any:
    """A writer that turns the statue at an impact, which takes no time."""

    def write(self: Any, kind: str, before: State, after: State) -> None:
        if kind == "impact":
            (x, y, z, w), half = after[3:7], 0.5 * TURNED_RAD
            after = (*after[:3], x + half * z, y + half * w, z - half * x, w - half * y, *after[7:])
        own(self, kind, before, after)

    return write


def _gravity(own: Any) -> Any:
    """A thousandth more of weight than the scene's, in the layer alone."""

    def mean(scene: Scene, edges_s: Any) -> Any:
        pull = own(scene, edges_s)
        pull[:, 2] -= 1e-3 * scene.gravity_m_s2
        return pull

    return mean


def _shaken(own: Any) -> Any:
    """A thousandth more of the floor's acceleration along x."""

    def mean(scene: Scene, edges_s: Any) -> Any:
        pull = own(scene, edges_s)
        pull[:, 0] *= 1.001
        return pull

    return mean


def _heavier(own: Any) -> Any:
    """A statue that turns with a thousandth more of inertia than the scene's."""

    def build(scene: Scene, *values: Any) -> Any:
        statue = scene.statue
        more = replace(
            statue,
            inertia_kg_m2=1.001 * statue.inertia_kg_m2,
            inertia_tensor_kg_m2=1.001 * statue.inertia_tensor_kg_m2,
        )
        return own(replace(scene, statue=more), *values)

    return build


_E: Final = "harness.engines.stepping."
LAYER: Final[Mapping[str, Change]] = {
    **_turns(_E + "step_state:RowWriter.write", Columns(7, 9, 11, 20)),
    **{
        f"{what} written at an impact × {share}": {_E + "step_state:RowWriter.write": _at_impact(*columns, share)}
        for what, columns in {"velocity": (7, 10), "rate": (10, 13), "pedestal's velocity": (20, 23)}.items()
        for share in (1.0 + ARM, 1.0 - ARM)
    },
    "turned at an impact": {_E + "step_state:RowWriter.write": _turned_at_impact},
    "shaking + 1 ‰": {_E + "trajectory:apparent_gravity": _shaken},
    "gravity + 1 ‰": {_E + "trajectory:apparent_gravity": _gravity},
    "inertia + 1 ‰": {
        "harness.engines.pymunk.world:build": _heavier,
        "harness.engines.pybullet.statue:prepare": _heavier,
    },
    "turned the other way": {
        _E + "step_state:StepState.turn": lambda own: lambda self, seconds, foot_m: own(self, -seconds, foot_m)
    },
    "limits of friction × 1.1": {_E + "step_state:Stepper.__init__": _limits},
    "limit × 1.1 in the test alone": {
        _E + "step_state:Stepper._share_of_limit": lambda own: lambda self, *values: own(self, *values) / LIMIT
    },
    "release as static": {
        _E + "step_state:Stepper._slip_onset": _static,
        _E + "step_state:Stepper.redo_sliding": lambda _: lambda self, friction, gravity, before: self.backend.read(),
    },
}
MUTANTS: Final[Mapping[str, Mapping[str, Change]]] = dict.fromkeys(("pymunk", "pybullet"), LAYER)
"""The same for both engines, as both are located in by the same room."""


@dataclass(frozen=True)
class Seen:
    """What became of one scene under a mutant: `failed`: the run said that it was wrong; `moved_rad`: by how much it was."""

    failed: bool
    moved_rad: float


def seen(name: str, change: Change, scene: Scene, right: Run) -> Seen:
    """Run a scene under a mutant, beside the right run."""
    engine = engines.load(name)
    with changed(change):
        try:
            run = engine.simulate(scene, engine.settings_for_dt(scene, STEP_S), RunOptions())
        except EngineFailure:
            return Seen(True, 0.0)
    return Seen(False, error_rad(run, right))


def scenes(name: str, count: int, first: int) -> Iterator[tuple[Scene, Run]]:
    """Random scenes with the engine's right runs."""
    engine = engines.load(name)
    for seed in range(first, first + count):
        scene = random_scene(seed)
        yield scene, engine.simulate(scene, engine.settings_for_dt(scene, STEP_S), RunOptions())


def main(arguments: Sequence[str]) -> None:
    """Print the table."""
    name, *count_and_seed = arguments
    count, first = [int(item) for item in count_and_seed] + [COUNT, FIRST_SEED][len(count_and_seed) :]
    pairs, say = list(scenes(name, count, first)), sys.stdout.write
    heads = "engine | mutant | scenes on which it acts | caught | not caught | rotation moved there, at most, rad"
    say(f"| {heads} |\n|---|---|---|---|---|---|\n")
    for mutant, change in MUTANTS[name].items():
        each = [seen(name, change, scene, right) for scene, right in pairs]
        acts = [item for item in each if item.failed or item.moved_rad > 0.0]
        missed = [item.moved_rad for item in acts if not item.failed]
        row = (name, mutant, len(acts), len(acts) - len(missed), len(missed), f"{max(missed, default=0.0):.1e}")
        say(f"| {' | '.join(map(str, row))} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
