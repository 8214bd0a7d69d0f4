"""From a test of the table to the scenes that are run: each unknown input, each small perturbation."""

from __future__ import annotations

import hashlib
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np

import meshes
from analytic.constants import GRAVITY_M_S2 as GRAVITY_M_S2
from analytic.excitation import Excitation, ZeroExcitation
from harness.campaign.cache_key import scene_key
from harness.input import scene_file as load
from harness.input.mesh_statue import statue_of
from harness.input.motions import SceneMotion, prepare
from harness.input.motions.spec import RecordSpec
from harness.model.errors import InputError, Mistake
from harness.model.options import Capabilities
from harness.model.scene import Array, BaseExcitation, Contact, Form, Scene, Statue
from harness.validation.table import Trial

RING_DOWN_S: Final = 5.0
"""Time after the motion's end in which rocking may still decide: several periods of a body of some metres."""
AZIMUTH_SD_DEG: Final = 2.0
"""Scatter of the body's azimuth on the table: what placing by hand leaves."""
BASE_SD_M: Final = 0.001
"""Scatter of the base's edge: what a scan resolves and a placement crushes."""
FRICTION_SD: Final = 0.05
"""Relative scatter of the friction: the spread of repeated tilt tests."""


@dataclass(frozen=True)
class Variant:
    """One choice of a test's unknown inputs (their indices in the lists), slightly perturbed unless `sample` is 0."""

    azimuth: int = 0
    friction: int = 0
    sample: int = 0


@dataclass(frozen=True)
class Intensity:
    """Peaks of the motion along the rocking plane; PGV/PGA tells its dominant period."""

    pga_g: float
    pgv_m_s: float

    @property
    def ratio_s(self) -> float:
        """PGV/PGA in s."""
        return self.pgv_m_s / (self.pga_g * GRAVITY_M_S2) if self.pga_g else 0.0


def variants(trial: Trial, samples: int) -> Iterator[Variant]:
    """All variants of a test: every choice of its unknown inputs, each nominal and `samples` times perturbed."""
    choices = itertools.product(range(len(trial.azimuths_deg)), range(len(trial.frictions)), range(samples + 1))
    return (Variant(*choice) for choice in choices)


def scene_of(trial: Trial, variant: Variant, seed: int = 0) -> Scene:
    """The scene of one variant. Raises `InputError` that names the test and its file."""
    azimuth, base, friction = _perturbation(trial, variant, seed)
    azimuth += trial.azimuths_deg[variant.azimuth]
    chosen = trial.frictions[variant.friction]
    scene = _base_scene(trial)
    statue = _turned(trial, azimuth, base) if azimuth or base else scene.statue
    contact = scene.contact if chosen is None else replace(scene.contact, statue=chosen)
    contact = replace(contact, statue=contact.statue * friction)
    return scene.but(title=trial.name, statue=statue, contact=contact)


def _perturbation(trial: Trial, variant: Variant, seed: int) -> tuple[float, float, float]:
    """Azimuth in degrees, base's edge in m, factor on friction; a stream of its own for each test and sample."""
    if variant.sample == 0:
        return 0.0, 0.0, 1.0
    stream = np.random.default_rng([seed, variant.sample, *trial.name.encode()])
    turn, edge, rough = stream.standard_normal(3)
    return AZIMUTH_SD_DEG * float(turn), BASE_SD_M * float(edge), math.exp(FRICTION_SD * float(rough))


def inset(statue: Statue, by_m: float) -> Statue:
    """A statue known by its numbers alone, with every edge of its base moved inwards by `by_m` (outwards where negative)."""
    footprint = _inwards(statue.footprint_m, statue.footprint_m, by_m)
    section = np.insert(statue.section_m, 1, 0.0, axis=1)
    low = section[:, 2] <= statue.footprint_m[:, 2].max() + 1e-9
    section[low] = _inwards(section[low], statue.footprint_m, by_m)
    return replace(
        statue,
        corner_left_m=-float(footprint[:, 0].min()),
        corner_right_m=float(footprint[:, 0].max()),
        footprint_m=footprint,
        section_m=section[:, [0, 2]],
    )


@lru_cache(maxsize=1024)
def _base_scene(trial: Trial) -> Scene:
    """The scene of a test before its body is turned: what its scene file says, or its mesh alone on the floor."""
    if trial.scene is not None:
        scene = load.load_scene(trial.scene)
        base_excitation = scene.base_excitation if trial.motion is None else _base_excitation(trial)
    else:
        base_excitation = _base_excitation(trial)
        statue = _turned(trial, 0.0, 0.0)
        scene = Scene(trial.name, 1.0, GRAVITY_M_S2, Form(), statue, None, Contact(0.2, 0.15, 1.0), base_excitation)
    if trial.duration_s is not None:
        duration = trial.duration_s
    elif trial.motion is not None and math.isfinite(base_excitation.end_s):
        duration = base_excitation.end_s + RING_DOWN_S
    else:
        duration = scene.duration_s
    return scene.but(base_excitation=base_excitation, duration_s=duration)


def _turned(trial: Trial, azimuth_deg: float, inwards_m: float) -> Statue:
    """The body of a trial, turned, every edge of its base moved inwards."""
    if trial.mesh is not None:
        return _statue(trial.mesh, trial.unit, trial.up, trial.density_kg_m3, azimuth_deg, inwards_m)
    statue = _base_scene(trial).statue
    if statue.solid is not None:
        return statue_of(_pared(statue.solid.rotated(azimuth_deg), inwards_m))
    if azimuth_deg:
        wanted = "0: the scene's statue is given by numbers alone, which say nothing of other directions"
        raise InputError(Mistake(str(trial.scene), f"test {trial.name}: azimuth_deg", wanted, f"{azimuth_deg:g}"))
    return inset(statue, inwards_m)


@lru_cache(maxsize=128)
def _statue(path: Path, unit: str, up: str, density_kg_m3: float, azimuth_deg: float, inwards_m: float) -> Statue:
    solid = _solid(path, unit, up, density_kg_m3)
    try:
        return statue_of(_pared(solid.rotated(azimuth_deg) if azimuth_deg else solid, inwards_m))
    except meshes.MeshError as error:
        raise InputError(Mistake(str(path), f"azimuth {azimuth_deg:g}", "a body that can stand", str(error))) from error


def _pared(solid: meshes.Solid, inwards_m: float) -> meshes.Solid:
    """The solid with the vertices of its base moved inwards; mass and inertia stay."""
    if inwards_m == 0.0:
        return solid
    vertices = solid.vertices_m.copy()
    low = vertices[:, 2] <= solid.contact_tolerance_m
    vertices[low] = _inwards(vertices[low], solid.footprint_m, inwards_m)
    return replace(solid, vertices_m=vertices, footprint_m=_inwards(solid.footprint_m, solid.footprint_m, inwards_m))


def _inwards(points_m: Array, footprint_m: Array, by_m: float) -> Array:
    """Points (n, 3) moved towards the middle of the base so that its edges move by `by_m`, at most a tenth of the base."""
    middle = 0.5 * (footprint_m.min(axis=0) + footprint_m.max(axis=0))
    half = 0.5 * np.ptp(footprint_m, axis=0)
    shrink = 1.0 - np.clip(by_m / np.maximum(half, 1e-9), -0.1, 0.1)
    moved = points_m.copy()
    moved[:, :2] = (middle + (points_m - middle) * shrink)[:, :2]
    return moved


@lru_cache(maxsize=16)
def _solid(path: Path, unit: str, up: str, density_kg_m3: float) -> meshes.Solid:
    try:
        return meshes.load_solid(path, unit=unit, up=up, density_kg_m3=density_kg_m3)
    except meshes.MeshError as error:
        raise InputError(Mistake(str(path), "", "a mesh that can be computed", str(error))) from error


def _base_excitation(trial: Trial) -> BaseExcitation:
    if trial.motion is None:
        raise InputError(Mistake(trial.body, f"test {trial.name}: motion", "a file with the table's motion", "nothing"))
    x = _component(trial.motion, trial.column, trial.motion_unit, trial.sign, trial.scale)
    y, z = (
        ZeroExcitation() if column is None else _component(trial.motion, column, trial.motion_unit, sign, trial.scale)
        for column, sign in ((trial.column_y, trial.sign), (trial.column_z, 1))
    )
    return BaseExcitation(x, y, z)


@lru_cache(maxsize=256)
def _component(path: Path, column: str | None, unit: str | None, sign: int, scale: float) -> Excitation:
    content = {"kind": "record", "file": str(path), "column": column, "unit": unit, "sign": sign, "scale": scale}
    component = RecordSpec.model_validate({name: value for name, value in content.items() if value is not None})
    return prepare(SceneMotion(component, path.parent, str(path), "motion")).excitation


def intensity(trial: Trial) -> Intensity:
    """Peaks of a test's motion along the rocking plane."""
    motion = _base_scene(trial).base_excitation.x
    return _intensity(motion, _base_scene(trial).duration_s)


@lru_cache(maxsize=256)
def _intensity(motion: Excitation, duration_s: float) -> Intensity:
    samples = getattr(motion, "t_s", None)
    t_s = np.linspace(0.0, duration_s, 20_001) if samples is None else np.asarray(samples)
    pgv = float(np.max(np.abs(np.asarray(motion.velocity_m_s(t_s)))))
    return Intensity(motion.peak_m_s2 / GRAVITY_M_S2, pgv)


def digest_of(trial: Trial) -> str:
    """What names a test's input: the bytes of its files, and what its row says of them."""
    files = [None if path is None else _file_digest(path) for path in (trial.mesh, trial.motion)]
    files.append(None if trial.scene is None else _scene_digest(trial.scene))
    said = (trial.unit, trial.up, trial.density_kg_m3, trial.column, trial.column_y, trial.column_z)
    said_too = (trial.motion_unit, trial.sign, trial.scale, trial.duration_s, trial.name)
    return hashlib.sha256(repr((files, said, said_too)).encode()).hexdigest()


@lru_cache(maxsize=4096)
def _file_digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@lru_cache(maxsize=64)
def _scene_digest(path: Path) -> str:
    # An engine that looks at everything: the digest then covers all that any engine could see.
    return scene_key(load.load_scene(path), Capabilities(3, uses_mesh=True, statue_slips=True))
