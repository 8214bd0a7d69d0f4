"""The one registry of engines, loaded on demand."""

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Final

from harness.engines.base import Engine
from harness.model import InputError, Mistake, Scene, nearest

REGISTRY: Final[Mapping[str, str]] = {
    "analytic": "harness.engines.analytic:TwoBlock",
    "pymunk": "harness.engines.pymunk:Munk2D",
    "pybullet": "harness.engines.pybullet.adapter:Bullet3D",
    "spatial": "harness.engines.spatial:Spatial",
    "pymunk:plain": "harness.engines.pymunk:PlainMunk2D",
    "pybullet:plain": "harness.engines.pybullet.adapter:PlainBullet3D",
}
DEFAULT_ENGINES: Final = ("analytic", "pymunk", "pybullet")
EXACT_IN_SPACE: Final = "spatial"
"""Joins them where the floor also moves across the rocking plane, of which planar models know nothing."""
THROWN: Final = (EXACT_IN_SPACE, "pybullet")
"""Engines of a scene that begins from a pose in space, with plastic impacts, and"""
BOUNCING: Final = (EXACT_IN_SPACE, "pybullet:plain")
"""where impacts give back a share of the velocity."""
PLASTIC_THROWN: Final = ("pymunk", "pybullet")
"""Engines that locate plastic impacts alone of what is thrown."""


def asked(names: Sequence[str] | None, otherwise: Sequence[str]) -> list[str]:
    """The names that are asked for, a text being one of them, each once; none are the `otherwise`."""
    return list(dict.fromkeys([names] if isinstance(names, str) else names or otherwise))


def default_engines(scene: Scene) -> tuple[str, ...]:
    """The engines that run a scene unless others are asked for."""
    if scene.initial.pose is None:
        across = stands_alone(scene) and scene.base_excitation.y.peak_m_s2 > 0.0
        return DEFAULT_ENGINES + ((EXACT_IN_SPACE,) if across else ())
    return THROWN if scene.contact.restitution is None else BOUNCING


def stands_alone(scene: Scene) -> bool:
    """Whether one body stands on a floor that moves with its frame, nothing beside it and no impact prescribed."""
    beside = scene.pedestal, scene.wall, scene.contact.restitution
    return all(item is None for item in beside) and scene.table != "moving"


def load(name: str) -> Engine:
    """The engine of that name; raises `InputError` with the nearest known name."""
    if not isinstance(name, str) or name not in REGISTRY:
        from multiprocessing import parent_process

        advice = "repeat -e for each" if "," in str(name) else nearest(str(name), REGISTRY)
        if parent_process() is not None:  # in a worker, which begins with the registry as it stands here
            advice = "an engine that a script adds is known to its own process alone: jobs=1"
        raise InputError(Mistake("--engine", "", f"one of {', '.join(REGISTRY)}", repr(name), advice))
    # Its module brings its simulator along: only who asks for the engine pays for that.
    module, _, attribute = REGISTRY[name].partition(":")
    engine: Engine = getattr(import_module(module), attribute)()
    return engine
