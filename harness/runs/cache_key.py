"""The cache key: the hash of a scene's physics, as far as an engine looks at it.

It is made of names and of exact numbers; a class or a field that is renamed in the code keeps its name here.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from typing import Any, Final
from weakref import WeakKeyDictionary

import numpy as np

from analytic.excitation import Harmonic, Pulse, SampledAcceleration, ZeroExcitation
from harness.engines.base import Engine
from harness.model.options import Capabilities
from harness.model.run import versions
from harness.model.scene import BaseExcitation, Contact, Form, Initial, Pedestal, Pose, Scene, Statue, Wall

NOT_PHYSICS: Final[Mapping[type, str]] = {Scene: "title source given findings uncertainty", Statue: "solid"}
"""Fields of which a run does not depend; of a mesh its own digest is part of the key where an engine uses it."""
KEYED: Final[Mapping[type, str]] = {
    Scene: "scene", Form: "model", Statue: "statue", Pedestal: "pedestal", Contact: "contact", Wall: "wall",
    Initial: "initial", Pose: "pose", BaseExcitation: "motion", ZeroExcitation: "rest", Harmonic: "harmonic",
    Pulse: "pulse", SampledAcceleration: "record",
}  # fmt: skip
"""Name in the key of each class."""
RENAMED: Final = {"base_excitation": "motion", "samples_m_s2": "accel_m_s2"}
"""Name in the key of each field that is called otherwise today; every other has its own, in the order of its class."""
ADDED: Final = {"floor_impact": "kinetic"}
"""Fields that came later, and what they are in scenes without them."""
EVERYTHING: Final = Capabilities(dimensions=3, uses_mesh=True, own_impact=False, statue_slips=True)
"""Of what asks for all of a scene."""
_MEMBERS: Final = {
    kind: [
        (item.name, RENAMED.get(item.name, item.name))
        for item in fields(kind)
        if item.name not in NOT_PHYSICS.get(kind, "").split() and not item.name.startswith("_")
    ]
    for kind in KEYED
}


def scene_key(scene: Scene, capabilities: Capabilities) -> str:
    """SHA-256 of the scene as an engine of these capabilities sees it; equal digests are the same run by physics."""
    state = hashlib.sha256()
    for part in _parts("", relevant(scene, capabilities)):
        state.update(part)
    solid = scene.statue.solid
    if solid is not None and capabilities.uses_mesh:
        state.update(solid.digest.encode())
    return state.hexdigest()


def request_key(scene: Scene, engine: Engine | None, *asked: object) -> str:
    """What names an answer: the scene as the engine sees it (None: all of it), what was asked, and the versions that answer."""
    seen, name = (EVERYTHING, "") if engine is None else (engine.capabilities, engine.name)
    own = versions()
    mine = own if engine is None else {key: own.get(key) for key in ("rockcheck", "numpy", "numba", name)}
    return key_of(scene_key(scene, seen), name, asked, dict(mine))


def key_of(*parts: object) -> str:
    """SHA-256 of plain values as JSON: what names an answer in a store."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True, default=str).encode()).hexdigest()


def relevant(scene: Scene, capabilities: Capabilities) -> Scene:
    """The scene with everything that the engine does not look at set to one fixed value.

    Without a pedestal nothing slides on the floor; an engine's own contact knows neither the model's normal force nor, unless a
    ratio is imposed, its impact law; a planar engine sees neither the motion across the plane nor the body's third dimension.
    """
    form, contact, base_excitation, statue = scene.form, scene.contact, scene.base_excitation, scene.statue
    if scene.pedestal is None:
        form, contact = Form(), Contact(0.0, 0.0, contact.statue, contact.restitution)
    acts = contact.at_impact
    contact = replace(contact, floor_impact=acts if acts > contact.floor_kinetic else "kinetic")
    if capabilities.own_impact:
        form = replace(form, friction_normal=Form().friction_normal)
        if contact.restitution is None:
            form = Form()
    if not capabilities.statue_slips:
        contact = replace(contact, statue=1.0)
    if capabilities.dimensions == 2:
        base_excitation = base_excitation.in_plane()
        statue = _planar(statue)
    return replace(scene, form=form, contact=contact, base_excitation=base_excitation, statue=statue)


def _planar(statue: Statue) -> Statue:
    """The statue without its third dimension; the same object for the same statue, which thousands of scenes may share."""
    if statue not in _PLANAR:
        _PLANAR[statue] = replace(
            statue, depth_m=1.0, footprint_m=np.zeros((0, 3)), inertia_tensor_kg_m2=np.zeros((3, 3))
        )
    return _PLANAR[statue]


_PLANAR: Final[WeakKeyDictionary[Statue, Statue]] = WeakKeyDictionary()
_BYTES: Final[WeakKeyDictionary[Statue, bytes]] = WeakKeyDictionary()


def _parts(name: str, value: Any) -> Iterator[bytes]:
    """The bytes that stand for a value: names, types and exact numbers, so that no two values share them."""
    if isinstance(value, Statue):
        # Its section and footprint are long, and thousands of scenes may share it.
        if value not in _BYTES:
            _BYTES[value] = b"".join(_members(name, value))
        yield _BYTES[value]
    elif type(value) in KEYED:
        yield from _members(name, value)
    elif isinstance(value, np.ndarray):
        yield f"{name}:{value.dtype}{value.shape}=".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, tuple):
        yield from (part for item in (len(value), *value) for part in _parts(name, item))
    elif isinstance(value, (bool, str, int)):
        yield f"{name}={value!r};".encode()
    elif isinstance(value, float):
        # −0.0 and 0.0 are the same physics.
        yield f"{name}={(value + 0.0).hex() if math.isfinite(value) else value};".encode()
    else:
        raise TypeError(f"no name in the cache key for {name}: {type(value).__name__}")


def _members(name: str, value: Any) -> Iterator[bytes]:
    yield f"{name}:{KEYED[type(value)]}{{".encode()
    for attribute, key in _MEMBERS[type(value)]:
        # What is not given has no part in the key: a new thing that may be given changes no key of scenes without it.
        member = getattr(value, attribute)
        if member is not None and not (attribute in ADDED and member == ADDED[attribute]):
            yield from _parts(key, member)
    yield b"}"
