"""The cache key holds all of the physics, and no name of the code."""

from dataclasses import fields, replace
from typing import Any

import numpy as np

from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration
from harness.model import BaseExcitation, Capabilities, Initial, Pose, Scene, Wall, info
from harness.runs.task import KEYED, NOT_PHYSICS, scene_key
from tests.scenes_for_tests import paestum

EVERYTHING = Capabilities(3, uses_mesh=True, statue_slips=True)
KEY = "27ea553f2de3ed90ed7c333693622481efd3a0be680ddd9e46ce861ebac0a6e4"
"""The key of the scene below; it changes only when the physics of a scene is named otherwise, which costs every stored run."""


def scene() -> Scene:
    start = Initial(0.01, 0.0, Pose((0.0, 0.0, 1.0)))
    motion = BaseExcitation(Harmonic(2.0, 1.5), Pulse("ricker", 1.0, 0.5), SampledAcceleration([0.0, 1.0], [0.0, 2.0]))
    return replace(
        paestum(duration_s=2.0, mu=(0.20, 0.15)), base_excitation=motion, wall=Wall("left", 0.7), initial=start
    )


def changes(value: Any) -> list[Any]:
    """The value with each of its parts that count changed a little."""
    if type(value) not in KEYED:
        return [changed(value)]
    aside = NOT_PHYSICS.get(type(value), "").split()
    names = [item.name for item in fields(value) if item.name not in aside and not item.name.startswith("_")]
    return [
        SampledAcceleration(
            **{"t_s": value.t_s, "accel_m_s2": value.samples_m_s2} | {name.replace("samples", "accel"): part}
        )
        if isinstance(value, SampledAcceleration)
        else replace(value, **{name: part})
        for name in names
        for part in changes(getattr(value, name))
    ]


def changed(value: Any) -> Any:
    if isinstance(value, str):
        others = {
            "dynamic": "static",
            "momentum": "unchanged",
            "left": "right",
            "frame": "moving",
            "ricker": "one_sine",
            "kinetic": "static",
        }
        return others[value]
    if value is None:
        return 0.5
    if isinstance(value, tuple):
        return (*value[:-1], value[-1] + 1e-9)
    return (
        value + np.linspace(1e-9, 2e-9, value.size).reshape(value.shape)
        if isinstance(value, np.ndarray)
        else value + 1e-9
    )


def test_every_part_of_the_physics_counts() -> None:
    others = changes(scene())
    keys = {scene_key(other, EVERYTHING) for other in [scene(), *others]}
    assert len(keys) == 1 + len(others) > 35


def test_what_is_no_physics_does_not_count() -> None:
    other = replace(scene(), title="another", findings=(info("key_assumed"),))
    assert scene_key(other, EVERYTHING) == scene_key(scene(), EVERYTHING)


def test_what_bounds_a_models_domain_counts() -> None:
    """It holds the statue on its support, and says from when on it would slide: a study gave all frictions that of the first."""
    smooth, rough = (replace(scene(), contact=replace(scene().contact, statue=mu)) for mu in (0.05, 0.6))
    assert scene_key(smooth, Capabilities(2)) != scene_key(rough, Capabilities(2))


def test_no_name_of_the_code_is_in_the_key() -> None:
    assert scene_key(scene(), EVERYTHING) == KEY
    names = {kind: kind.__name__ for kind in KEYED}
    try:
        for kind in names:
            kind.__name__ = "Renamed"
        assert scene_key(scene(), EVERYTHING) == KEY
    finally:
        for kind, name in names.items():
            kind.__name__ = name


def test_every_motion_has_a_name_in_the_key() -> None:
    assert set(Excitation.__subclasses__()) <= set(KEYED)
