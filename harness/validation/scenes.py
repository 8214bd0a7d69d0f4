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
from harness.input import scene_file as load
from harness.input.mesh_statue import statue_of
from harness.model.errors import InputError, Mistake
from harness.model.history import Array
from harness.model.options import Capabilities
from harness.model.scene import Contact, Form, Scene, Statue
from harness.runs.cache_key import scene_key
from harness.studies.rocking_spectrum import RING_DOWN_S
from harness.validation.motions import Intensity, intensity, shaking
from harness.validation.table import UNKNOWN, Trial

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
    tolerance: int = 0
    inset: int = 0
    sample: int = 0


INPUTS: Final = {
    "azimuth": "azimuth_deg", "friction": "friction", "tolerance": "contact_tolerance_m", "inset": "inset_m",
}  # fmt: skip
"""The table's column of each input of a variant, in the variant's order."""


def settings(trial: Trial) -> Iterator[Variant]:
    """Every choice of a test's unknown inputs, each nominal."""
    counts = (len(getattr(trial, UNKNOWN[column])) for column in INPUTS.values())
    return (Variant(*choice) for choice in itertools.product(*map(range, counts)))


def scene_of(trial: Trial, variant: Variant, seed: int = 0) -> Scene:
    """The scene of one variant. Raises `InputError` that names the test and its file."""
    turn_deg, edge_m, friction = _perturbation(trial, variant, seed)
    scene = _base_scene(trial)
    if scene.statue.solid is None:
        turn_deg = 0.0  # numbers of one plane say nothing of others: only a turn that the table asks for is refused
    turn_deg += trial.azimuths_deg[variant.azimuth]
    edge_m += trial.insets_m[variant.inset]
    chosen = trial.frictions[variant.friction]
    statue = _turned(trial, turn_deg, edge_m, trial.contact_tolerances_m[variant.tolerance])
    contact = scene.contact if chosen is None else replace(scene.contact, statue=chosen)
    contact = replace(contact, statue=contact.statue * friction)
    return replace(scene, title=trial.name, statue=statue, contact=contact)


def _perturbation(trial: Trial, variant: Variant, seed: int) -> tuple[float, float, float]:
    """Azimuth in degrees, base's edge in m, factor on friction.

    A statue is drawn once for all tests of its body: making one costs more than a run of the model. Friction is each test's own.
    """
    if variant.sample == 0:
        return 0.0, 0.0, 1.0
    turn, edge = np.random.default_rng([seed, variant.sample, *trial.body_name.encode()]).standard_normal(2)
    rough = np.random.default_rng([seed, variant.sample, *trial.name.encode()]).standard_normal()
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
        base_excitation = scene.base_excitation if trial.motion is None else shaking(trial)
    else:
        base_excitation = shaking(trial)
        statue = _turned(trial, 0.0, 0.0, None)
        scene = Scene(trial.name, 1.0, GRAVITY_M_S2, Form(), statue, None, Contact(0.2, 0.15, 1.0), base_excitation)
    if trial.duration_s is not None:
        duration = trial.duration_s
    elif trial.motion is not None and math.isfinite(base_excitation.end_s):
        duration = base_excitation.end_s + RING_DOWN_S
    else:
        duration = scene.duration_s
    return replace(scene, base_excitation=base_excitation, duration_s=duration)


def _turned(trial: Trial, azimuth_deg: float, inwards_m: float, tolerance_m: float | None) -> Statue:
    """The body of a trial, turned, every edge of its base moved inwards."""
    if trial.mesh is not None:
        density = None if trial.mass_kg is not None else trial.density_kg_m3
        solid = _solid(trial.mesh, trial.unit, trial.up, density, trial.mass_kg, tolerance_m)
        return _statue(solid, trial.mesh, azimuth_deg, inwards_m)
    statue = _base_scene(trial).statue
    if not azimuth_deg and not inwards_m:
        return statue
    if statue.solid is not None:
        return statue_of(_pared(statue.solid.rotated(azimuth_deg), inwards_m))
    if azimuth_deg:
        wanted = "0: the scene's statue is given by numbers alone, which say nothing of other directions"
        raise InputError(Mistake(str(trial.scene), f"test {trial.name}: azimuth_deg", wanted, f"{azimuth_deg:g}"))
    return inset(statue, inwards_m)


@lru_cache(maxsize=256)
def _statue(solid: meshes.Solid, file: Path, azimuth_deg: float, inwards_m: float) -> Statue:
    try:
        return statue_of(_pared(solid.rotated(azimuth_deg) if azimuth_deg else solid, inwards_m))
    except meshes.MeshError as error:
        place = f"azimuth {azimuth_deg:g}"
        raise InputError(Mistake(str(file), place, "a body that can stand", str(error))) from error


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


@lru_cache(maxsize=64)
def _solid(
    path: Path, unit: str, up: str, density_kg_m3: float | None, mass_kg: float | None, tolerance_m: float | None
) -> meshes.Solid:
    touching = {} if tolerance_m is None else {"contact_tolerance_m": tolerance_m}
    try:
        return meshes.load_solid(path, unit=unit, up=up, density_kg_m3=density_kg_m3, mass_kg=mass_kg, **touching)
    except meshes.MeshError as error:
        raise InputError(Mistake(str(path), "", "a mesh that can be computed", str(error))) from error


def intensity_of(trial: Trial) -> Intensity:
    """Peaks of a test's motion along the rocking plane."""
    scene = _base_scene(trial)
    return intensity(scene.base_excitation.x, scene.duration_s)


def digest_of(trial: Trial) -> str:
    """What names a test's input: the bytes of its files, and what its row says of them."""
    files = [None if path is None else _file_digest(path) for path in (trial.mesh, trial.motion)]
    files.append(None if trial.scene is None else _scene_digest(trial.scene))
    body = (trial.unit, trial.up, trial.density_kg_m3, trial.mass_kg, trial.body_name)
    motion = (trial.column, trial.column_y, trial.column_z, trial.motion_unit, trial.time_column, trial.sign)
    treated = (trial.baseline, trial.bandpass_hz, trial.scale, trial.duration_s, trial.name)
    return hashlib.sha256(repr((files, body, motion, treated)).encode()).hexdigest()


@lru_cache(maxsize=4096)
def _file_digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@lru_cache(maxsize=64)
def _scene_digest(path: Path) -> str:
    # An engine that looks at everything: the digest then covers all that any engine could see.
    return scene_key(load.load_scene(path), Capabilities(3, uses_mesh=True, statue_slips=True))
