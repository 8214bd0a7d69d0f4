"""What a scene needs and what may be left out, decided before anything runs; printed by `--explain`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Protocol

from harness.model.options import SKIPS, Capabilities, RunOptions
from harness.model.scene import OVERTURN_RAD, Scene
from harness.statics.collision_shape import shape_needed
from harness.statics.rest import LimitsOfRest, first_motion_s
from harness.statics.symmetry import asymmetry


class Asked(Protocol):
    """What a plan needs to know of an engine."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def capabilities(self) -> Capabilities:
        """What it is able to do."""


@dataclass(frozen=True)
class Step:
    """One decision of the plan: the skip's name, the engine it concerns (`*`: all), whether it applies, and why."""

    skip: str
    engine: str
    applies: bool
    reason: str

    def __str__(self) -> str:
        return f"{'skip' if self.applies else 'keep'} {self.skip} ({self.engine}): {self.reason}"


def plan(
    scene: Scene, engines: Sequence[Asked], options: RunOptions, registered: Iterable[str] = ()
) -> tuple[Step, ...]:
    """All decisions for a scene: each engine's own skips, then those of the harness.

    `registered` names all engines there are: those that are not among `engines` are not imported.
    """
    own = [
        _decided(name, scene, engine, options)
        for engine in engines
        for name in SKIPS
        if name in engine.capabilities.skips
    ]
    return (*own, *_edges(scene, engines), _planar(scene, engines), _lazy(engines, registered), _cached())


def _decided(name: str, scene: Scene, engine: Asked, options: RunOptions) -> Step:
    """One skip of one engine."""
    if name not in options.skips:
        return Step(name, engine.name, False, "switched off")
    applies, reason = DECISIONS[name](scene, options)
    return Step(name, engine.name, applies, reason)


def _quiet_start(scene: Scene, options: RunOptions) -> Decision:
    quiet = first_motion_s(scene)
    if quiet > 0.0:
        return True, f"nothing can move before {quiet:.4g} s"
    return False, "the motion is not quiet at its start, or the statue starts off rest"


def _quiet_rest(scene: Scene, options: RunOptions) -> Decision:
    if scene.table != "frame":
        return False, "the table moves, not the frame"
    if LimitsOfRest.of(scene) is None:
        return False, "the motion is a formula, or the statue tilts off the vertices that it rests on"
    return True, "while the statue rests and the record's samples stay below what moves it"


def _quiet_end(scene: Scene, options: RunOptions) -> Decision:
    end = scene.base_excitation.end_s
    if end < scene.duration_s:
        return True, f"the floor is still after {end:.4g} s: the run ends once the statue is at rest"
    return False, "the floor moves until the end"


def _energy(scene: Scene, options: RunOptions) -> Decision:
    if options.history:
        return False, "histories are asked"
    end = scene.base_excitation.end_s
    if end < scene.duration_s:
        return True, f"after {end:.4g} s the energy decides the outcome, where the pedestal is shown to hold"
    return False, "the floor moves until the end"


def _base_only(scene: Scene, options: RunOptions) -> Decision:
    from meshes.decomposition import missing

    need = shape_needed(scene)
    if need.shape == "base":
        sentence = "nothing but the base can touch before the statue has overturned"
        return (
            True,
            sentence if scene.wall is None else f"{sentence} but the wall, at vertices of the hull: {need.reason}",
        )
    body = "hull" if need.shape == "hull" else "convex parts"
    sentence = (
        f"the base alone touches until the body can meet the pedestal's edge; from there on its {body}: {need.reason}"
    )
    if need.shape == "parts" and (reason := missing()):
        sentence += f"; but {reason}, so its hull is taken"
    return True, sentence if scene.wall is None else f"{sentence}; the wall is met at vertices of the hull"


def _mirror(scene: Scene, options: RunOptions) -> Decision:
    if scene.table != "frame":
        return False, "the table moves, not the frame"
    reason = asymmetry(scene)
    if reason is not None:
        return False, reason
    whole = "base_only" not in options.skips and scene.pedestal is not None
    sentence = "its bodies turn in the plane alone" if whole else "half of it is computed"
    return True, f"the scene is its own mirror image across the rocking plane: {sentence}"


def _no_history(scene: Scene, options: RunOptions) -> Decision:
    return (False, "histories are asked") if options.history else (True, "only the outcome is asked")


def _stop(scene: Scene, options: RunOptions) -> Decision:
    return True, f"a run ends at |θ| = {OVERTURN_RAD:g} rad"


Decision = tuple[bool, str]
DECISIONS: Final[Mapping[str, Callable[[Scene, RunOptions], Decision]]] = {
    "quiet_start": _quiet_start,
    "quiet_rest": _quiet_rest,
    "quiet_end": _quiet_end,
    "energy_outcome": _energy,
    "base_only": _base_only,
    "mirror": _mirror,
    "no_history": _no_history,
    "stop_at_overturn": _stop,
}
"""Whether a skip that an engine has applies to a scene, and why; switched with `--no-skip`."""


def _edges(scene: Scene, engines: Sequence[Asked]) -> list[Step]:
    """Engines that have one shape of their own for whatever scene, said where a pedestal's edge would need another."""
    need = shape_needed(scene)
    if need.shape != "parts":
        return []
    said = "it meets the pedestal's edge with {} in every scene; {}"
    shapes = {engine.name: engine.capabilities.edge_shape for engine in engines if engine.capabilities.edge_shape}
    return [Step("base_only", name, False, said.format(shape, need.reason)) for name, shape in shapes.items()]


def _planar(scene: Scene, engines: Sequence[Asked]) -> Step:
    """Switched by naming a 3D engine."""
    solid = [engine.name for engine in engines if engine.capabilities.dimensions == 3]
    if solid:
        return Step("planar", "*", False, f"{', '.join(solid)} asked: computed in 3D (leave it out with -e)")
    if not scene.planar:
        return Step("planar", "*", False, "the scene is not planar, but no 3D engine is asked (name one with -e)")
    return Step("planar", "*", True, "the scene is planar and no 3D engine is asked (name one with -e)")


def _lazy(engines: Sequence[Asked], registered: Iterable[str]) -> Step:
    """Switched by naming the engine."""
    asked = {engine.name for engine in engines}
    idle = [name for name in registered if name not in asked]
    if not idle:
        return Step("lazy_engines", "*", False, "every engine is asked")
    return Step("lazy_engines", "*", True, f"{', '.join(idle)} not asked (-e): not imported")


def _cached() -> Step:
    """Switched by another folder for the store."""
    return Step(
        "cached", "*", False, "one run is always computed; a study finds what its store has (--out elsewhere: anew)"
    )
