"""A name for what is computed: the hash of a scene's physics, as far as an engine looks at it."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any, Final
from weakref import WeakKeyDictionary

import numpy as np

from analytic.excitation import ZeroExcitation
from harness.model.options import Capabilities
from harness.model.scene import BaseExcitation, Contact, Form, Scene, Statue

NOT_PHYSICS: Final = frozenset({"title", "source", "given", "notes", "solid", "uncertainty"})


def scene_digest(scene: Scene, capabilities: Capabilities) -> str:
    """SHA-256 of the scene as an engine of these capabilities sees it; equal digests are the same run by physics."""
    state = hashlib.sha256()
    seen = relevant(scene, capabilities)
    for item in fields(seen):
        if item.name == "statue":
            state.update(_statue_bytes(seen.statue))
        elif item.name not in NOT_PHYSICS:
            state.update(b"".join(_parts(item.name, getattr(seen, item.name))))
    solid = scene.statue.solid
    if solid is not None and capabilities.uses_mesh:
        state.update(solid.digest.encode())
    return state.hexdigest()


def relevant(scene: Scene, capabilities: Capabilities) -> Scene:
    """The scene with everything that the engine does not look at set to one fixed value.

    Without a pedestal nothing slides on the floor; an engine's own contact knows neither the model's normal force nor, unless a
    ratio is imposed, its impact law; a planar engine sees neither the motion across the plane nor the body's third dimension.
    """
    form, contact, base_excitation, statue = scene.form, scene.contact, scene.base_excitation, scene.statue
    if scene.pedestal is None:
        form, contact = Form(), Contact(0.0, 0.0, contact.statue, contact.restitution)
    if capabilities.own_impact:
        form = replace(form, friction_normal=Form().friction_normal)
        if contact.restitution is None:
            form = Form()
    if not capabilities.statue_slips:
        contact = replace(contact, statue=1.0)
    if capabilities.dimensions == 2:
        base_excitation = BaseExcitation(base_excitation.x, ZeroExcitation(), base_excitation.z)
        statue = _planar(statue)
    return scene.but(form=form, contact=contact, base_excitation=base_excitation, statue=statue)


def _planar(statue: Statue) -> Statue:
    """The statue without its third dimension; the same object for the same statue, which thousands of scenes may share."""
    if statue not in _PLANAR:
        _PLANAR[statue] = replace(
            statue, depth_m=1.0, footprint_m=np.zeros((0, 3)), inertia_tensor_kg_m2=np.zeros((3, 3))
        )
    return _PLANAR[statue]


def _statue_bytes(statue: Statue) -> bytes:
    if statue not in _BYTES:
        _BYTES[statue] = b"".join(_parts("statue", statue))
    return _BYTES[statue]


_PLANAR: Final[WeakKeyDictionary[Statue, Statue]] = WeakKeyDictionary()
_BYTES: Final[WeakKeyDictionary[Statue, bytes]] = WeakKeyDictionary()


def _parts(name: str, value: Any) -> Iterator[bytes]:
    """The bytes that stand for a value: names, types and exact numbers, so that no two values share them."""
    if is_dataclass(value) and not isinstance(value, type):
        yield f"{name}:{type(value).__name__}{{".encode()
        for item in fields(value):
            if item.name not in NOT_PHYSICS and not item.name.startswith("_"):
                yield from _parts(item.name, getattr(value, item.name))
        yield b"}"
    elif isinstance(value, np.ndarray):
        yield f"{name}:{value.dtype}{value.shape}=".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, bool) or value is None or isinstance(value, (str, int)):
        yield f"{name}={value!r};".encode()
    elif isinstance(value, float):
        # −0.0 and 0.0 are the same physics.
        yield f"{name}={(value + 0.0).hex() if math.isfinite(value) else value};".encode()
    else:
        raise TypeError(f"no digest for {name}: {type(value).__name__}")
