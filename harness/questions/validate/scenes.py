"""From a test of the table to the scenes that are run: each unknown input, each small perturbation."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np

import meshes
from analytic.block import GRAVITY_M_S2 as GRAVITY_M_S2
from harness.input import scene_file as load
from harness.input.mesh_statue import statue_of
from harness.model.errors import InputError, Mistake
from harness.model.history import Array
from harness.model.run import Capabilities
from harness.model.scene import BaseExcitation, Contact, Form, Scene, Statue
from harness.questions.study.rocking_spectrum import RING_DOWN_S
from harness.questions.validate.motions import Intensity, intensity, scaled, shaking
from harness.questions.validate.table import Inputs, Trial
from harness.runs.task import scene_key

AZIMUTH_SD_DEG: Final = 2.0
"""Scatter of the body's azimuth on the table: what placing by hand leaves."""
BASE_SD_M: Final = 0.001
"""Scatter of the base's edge: what a scan resolves and a placement crushes."""
FRICTION_SD: Final = 0.05
"""Relative scatter of the friction: the spread of repeated tilt tests."""
LEAST_SCORES: Final = 128
"""Draws that are made at once."""
BARE: Final = Contact(0.2, 0.15, 1.0)
"""Of a stone that no scene has: it stands on the table, and a row says its friction."""


@dataclass(frozen=True)
class Variant:
    """A test at one value of all its inputs: as it is, or a draw (`sample` from 1 on) of what no table knows, its scatter times
    `width`. `stated`: its numerical error is wanted too.
    """

    inputs: Inputs
    sample: int = 0
    width: float = 1.0
    stated: bool = False


def scene_of(trial: Trial, variant: Variant, seed: int = 0, motion: BaseExcitation | None = None) -> Scene:
    """The scene of one variant, its `motion` as `motion_of` has it read already. Raises `InputError` that names test and file."""
    inputs, (turn_deg, edge_m, rough) = variant.inputs, _scatter(trial, variant, seed)
    shaken = scaled(motion_of(trial, inputs) if motion is None else motion, inputs.sign, inputs.scale)
    own = None if trial.scene is None else _scene(trial.scene)
    if own is not None and own.statue.solid is None:
        turn_deg = 0.0  # numbers of one plane say nothing of others: only a turn that the table asks for is refused
    statue = _turned(trial, inputs.azimuth_deg + turn_deg, inputs.inset_m + edge_m, inputs.contact_tolerance_m)
    contact = BARE if own is None else own.contact
    contact = replace(contact, statue=rough * (contact.statue if inputs.friction is None else inputs.friction))
    duration_s = _duration_s(trial, shaken, 1.0 if own is None else own.duration_s)
    if own is None:
        return Scene(trial.name, duration_s, GRAVITY_M_S2, Form(), statue, None, contact, shaken)
    return replace(own, title=trial.name, duration_s=duration_s, statue=statue, contact=contact, base_excitation=shaken)


def _duration_s(trial: Trial, motion: BaseExcitation, otherwise_s: float) -> float:
    if trial.duration_s is not None:
        return trial.duration_s
    return motion.end_s + RING_DOWN_S if trial.motion is not None and math.isfinite(motion.end_s) else otherwise_s


def motion_of(trial: Trial, inputs: Inputs, fewer: bool = False) -> BaseExcitation:
    """The motion of a test before its sign and scale: of its file (see `shaking`), or of its scene. Raises `InputError`."""
    if trial.motion is None and trial.scene is not None:
        return _scene(trial.scene).base_excitation
    return shaking(trial, inputs, fewer)


def _scatter(trial: Trial, variant: Variant, seed: int) -> tuple[float, float, float]:
    """What a draw adds to the azimuth in degrees and the base's edge in m, and its factor on friction.

    A statue is drawn once for all tests of its body and day: making one costs more than a run of the model. Friction is each
    test's own.
    """
    if variant.sample == 0:
        return 0.0, 0.0, 1.0
    set_up = f"{trial.body_name}{trial.day and '/'}{trial.day}"
    # The first draws are the same whatever the number: one sequence serves most.
    size = max(LEAST_SCORES, 1 << variant.sample.bit_length())
    turn, edge = variant.width * _scores(set_up, seed, size)[variant.sample, 1:3]
    rough = variant.width * _scores(trial.name, seed, size)[variant.sample, 3]
    return AZIMUTH_SD_DEG * float(turn), BASE_SD_M * float(edge), math.exp(FRICTION_SD * float(rough))


@lru_cache(maxsize=4096)
def _scores(name: str, seed: int, size: int) -> Array:
    """Normal scores (size, 4) of a Halton sequence scrambled by a name: few draws fill what they scatter over evenly.

    The first column's base, 2, is left to the settings of unknown inputs (`harness.questions.validate.fit`).
    """
    from scipy.special import ndtri
    from scipy.stats.qmc import Halton

    return np.asarray(ndtri(Halton(4, rng=np.random.default_rng([seed, *name.encode()])).random(size)))


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


_scene = lru_cache(maxsize=64)(load.load_scene)


def _turned(trial: Trial, azimuth_deg: float, inwards_m: float, tolerance_m: float | None) -> Statue:
    """The body of a trial, turned, every edge of its base moved inwards."""
    if trial.scene is None:
        density = None if trial.mass_kg is not None else trial.density_kg_m3
        solid = _solid(Path(trial.body), trial.unit, trial.up, density, trial.mass_kg, tolerance_m)
        return _statue(solid, trial.body, azimuth_deg, inwards_m)
    statue = _scene(trial.scene).statue
    if not azimuth_deg and not inwards_m:
        return statue
    if statue.solid is not None:
        return _statue(statue.solid, trial.body, azimuth_deg, inwards_m)
    if azimuth_deg:
        wanted = "0: the scene's statue is given by numbers alone, which say nothing of other directions"
        raise InputError(Mistake(str(trial.scene), f"test {trial.name}: azimuth_deg", wanted, f"{azimuth_deg:g}"))
    return inset(statue, inwards_m)


@lru_cache(maxsize=1024)
def _statue(solid: meshes.Solid, file: str, azimuth_deg: float, inwards_m: float) -> Statue:
    try:
        return statue_of(_pared(solid.rotated(azimuth_deg) if azimuth_deg else solid, inwards_m))
    except meshes.MeshError as error:
        place = f"azimuth {azimuth_deg:g}"
        raise InputError(Mistake(file, place, "a body that can stand", str(error))) from error


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
    """Peaks of a test's motion along the rocking plane, at the first value of each list; reads all of the test's files.

    Raises `InputError` where the body does not stand within one of its tolerances too.
    """
    inputs = trial.inputs()
    otherwise_s = 1.0 if trial.scene is None else _scene(trial.scene).duration_s
    for tolerance in trial.contact_tolerance_m:
        _turned(trial, inputs.azimuth_deg, inputs.inset_m, tolerance)
    motion = motion_of(trial, inputs)
    return intensity(motion.x, _duration_s(trial, motion, otherwise_s)).times(inputs.scale)


def digest_of(trial: Trial) -> str:
    """What names a test's input but for what a variant chooses: the bytes of its files, and what its row says of them."""
    files = [None if path is None else _file_digest(path) for path in (trial.mesh, trial.motion)]
    files.append(None if trial.scene is None else _scene_digest(trial.scene))
    body = (trial.unit, trial.up, trial.density_kg_m3, trial.mass_kg, trial.body_name, trial.day)
    motion = (trial.column, trial.column_y, trial.column_z, trial.motion_unit, trial.time_column)
    return hashlib.sha256(repr((files, body, motion, trial.duration_s, trial.name)).encode()).hexdigest()


@lru_cache(maxsize=4096)
def _file_digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@lru_cache(maxsize=64)
def _scene_digest(path: Path) -> str:
    # An engine that looks at everything: the digest then covers all that any engine could see.
    return scene_key(_scene(path), Capabilities(3, uses_mesh=True, statue_slips=True))
