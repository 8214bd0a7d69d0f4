"""From a test of the table to the scenes that are run: its motion, each unknown input, each small perturbation."""

import csv
import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from pydantic import ValidationError

import meshes
from analytic.block import GRAVITY_M_S2 as GRAVITY_M_S2
from analytic.excitation import Excitation, SampledAcceleration, ZeroExcitation
from harness.input import scene_file as load
from harness.input.files import decimals, decoded, read_bytes
from harness.input.mesh_statue import statue_of
from harness.input.motions import RecordSpec, SceneMotion, prepare
from harness.model import (
    Array,
    BaseExcitation,
    Capabilities,
    Contact,
    Form,
    InputError,
    Mistake,
    Scene,
    Statue,
    require,
    required,
    translated,
)
from harness.questions.study.rocking_spectrum import RING_DOWN_S
from harness.questions.validate.table import Inputs, Trial
from harness.runs.task import scene_key

# The motion of a test: its table's columns, treated as the row says, and how strong it is.

MOST_READ: Final = 512
"""Motions that are kept once they are read: of 39 000 samples they take 300 MB."""


@dataclass(frozen=True)
class Intensity:
    """Peaks of the motion along the rocking plane; PGV/PGA tells its dominant period."""

    pga_g: float
    pgv_m_s: float

    @property
    def ratio_s(self) -> float:
        """PGV/PGA in s."""
        return self.pgv_m_s / (self.pga_g * GRAVITY_M_S2) if self.pga_g else 0.0


def scaled(motion: BaseExcitation, sign: int, scale: float) -> BaseExcitation:
    """A motion times a factor, turned about the vertical where the sign is −1."""
    if sign == 1 and scale == 1.0:
        return motion
    along = sign * scale
    return BaseExcitation(motion.x.scaled(along), motion.y.scaled(along), motion.z.scaled(scale))


SHIFT_M: Final = 1e-5
"""How far a motion of fewer samples may be from its record at any time, in displacement: a hundredth of what the base's edge
scatters by."""
MERGED: Final = (64, 32, 16, 8, 4, 2)
"""Samples that become one, the most that is possible."""


@lru_cache(maxsize=MOST_READ)
def _thinned(path: Path, column: str | None, treatment: tuple[Any, ...]) -> Excitation:
    return thinned(_component(path, column, treatment))


def thinned(motion: Excitation) -> Excitation:
    """A record in as few samples as keep its displacement: of a fast logger's most say nothing of a stone."""
    if isinstance(motion, SampledAcceleration):
        displacement_m = motion.displacement_m(motion.t_s)
        for size in MERGED:
            if len(motion.t_s) > 2 * size:
                fewer = _merged(motion, size)
                if np.max(np.abs(fewer.displacement_m(motion.t_s) - displacement_m)) <= SHIFT_M:
                    return fewer
    return motion


def _merged(motion: SampledAcceleration, size: int) -> SampledAcceleration:
    """The line through every `size`-th time of a record, and its last, that is nearest to it in least squares: so it keeps the
    velocity and the displacement at the end.
    """
    from scipy.linalg import solveh_banded

    t, a = motion.t_s, motion.samples_m_s2
    knots_s = np.append(t[:-1:size], t[-1])
    cell, width, step = np.arange(len(t) - 1) // size, np.diff(knots_s), np.diff(t)
    # Each line of the record lies in one cell, where both are straight: ∫ fg = (2 f₀g₀ + f₀g₁ + f₁g₀ + 2 f₁g₁) Δt/6.
    ends = np.stack([2.0 * a[:-1] + a[1:], a[:-1] + 2.0 * a[1:]]) * step / 6.0
    after = np.stack([t[:-1] - knots_s[cell], t[1:] - knots_s[cell]]) / width[cell]
    right, total = (np.bincount(cell, each.sum(axis=0)) for each in (ends * after, ends))
    moments = np.append(total - right, 0.0) + np.append(0.0, right)
    inner = np.append(width, 0.0) + np.append(0.0, width)
    return SampledAcceleration(knots_s, solveh_banded(np.stack([np.append(0.0, width / 6.0), inner / 3.0]), moments))


@lru_cache(maxsize=MOST_READ)
def _component(path: Path, column: str | None, treatment: tuple[Any, ...]) -> Excitation:
    unit, time_column, baseline, bandpass_hz = treatment
    keys: dict[str, object] = {"column": column, "unit": unit, "bandpass_hz": bandpass_hz}
    if time_column is not None:
        keys |= _columns(path, time_column, column)
    given = {name: value for name, value in keys.items() if value is not None}
    try:
        component = RecordSpec(kind="record", file=str(path), baseline=baseline, **given)  # type: ignore[arg-type]
    except ValidationError as error:
        reasons = "; ".join(f"{'.'.join(map(str, item['loc']))}: {item['msg']}" for item in error.errors())
        raise InputError(Mistake(str(path), "motion", "a motion that can be read", reasons)) from error
    return prepare(SceneMotion(component, path.parent, str(path), "motion")).excitation


def _columns(path: Path, time_column: str, column: str | None) -> dict[str, int | str]:
    """Where times and accelerations stand in a table whose headers no reader knows, counted from 1; both by header or number.

    The headers are the line above the numbers that names the column of times, or the last one; comments and units may stand
    around it.
    """
    lines = decoded(read_bytes(path, "a motion"), str(path), "a table with a header").splitlines()
    found = next((place for place, line in enumerate(lines) if _numeric(_cells(line))), None)
    last, advice = ", ".join(_cells(lines[-1])), "leave out columns of words"
    first = required(found, str(path), "numbers in all columns", last, advice, key=f"line {len(lines)}")
    above = [row for row in map(_cells, reversed(lines[:first])) if any(row)] or [[]]
    headers = next((row for row in above if time_column in row), above[0])
    numbered = [str(place + 1) for place in range(len(_cells(lines[first])))]
    # The first of equal names; a header goes before a number.
    every = [*reversed([*enumerate(numbered, 1)]), *reversed([*enumerate(headers, 1)])]
    places: dict[str | None, int] = {name: place for place, name in every}
    for key, name in (("time_column", time_column), ("column", column)):
        wanted, got = f"a column of {', '.join(headers or numbered)}", repr(name) if name else "nothing"
        require(name in places, str(path), wanted, got, key=key)
    return {"time_column": places[time_column], "columns": f"{places[column]}:a", "column": "a", "skip_lines": first}


def _cells(line: str) -> list[str]:
    """The cells of a line between tabs, semicolons or commas, else between blanks; a comment's mark is no part of them."""
    bare = line.strip().lstrip("#% ")
    mark = next((each for each in "\t;," if each in bare), None)
    cells = bare.split() if mark is None else next(csv.reader([bare], delimiter=mark, skipinitialspace=True))
    return [cell.strip() for cell in cells]


def _numeric(cells: Sequence[str]) -> bool:
    """Whether two cells or more are numbers, with a point or a comma, and none is anything else."""
    try:
        return len(decimals([cell.replace(",", ".") for cell in cells if cell])) > 1
    except ValueError:
        return False


@lru_cache(maxsize=1024)
def intensity(motion: Excitation, duration_s: float) -> Intensity:
    """Peaks of a motion; a record's PGV without the drift of its velocity, for an offset of it is no shaking."""
    if isinstance(motion, SampledAcceleration):
        velocity = _peaks_m_s(motion)
    else:
        velocity = np.asarray(motion.velocity_m_s(np.linspace(0.0, duration_s, 20_001)))
    return Intensity(motion.peak_m_s2 / GRAVITY_M_S2, float(np.max(np.abs(velocity))))


def _peaks_m_s(motion: SampledAcceleration) -> Array:
    """Velocities at the samples and where the acceleration passes zero between them, less the drift c t that fits those best:
    a record's offset c integrates to it, and a table begins at rest."""
    since, velocity = motion.t_s - motion.t_s[0], np.asarray(motion.velocity_m_s(motion.t_s))
    weight = float(since @ since)
    drift_m_s2 = float(since @ velocity) / weight if weight else 0.0
    velocity, accel = velocity - drift_m_s2 * since, motion.samples_m_s2 - drift_m_s2
    k = np.flatnonzero(accel[:-1] * accel[1:] < 0.0)
    between = velocity[k] + 0.5 * (since[k + 1] - since[k]) * accel[k] ** 2 / (accel[k] - accel[k + 1])
    return np.concatenate([velocity, between])


# The scene of a test at one value of what is not known.

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
class TrialVariant:
    """A test at one value of all its inputs: as it is, or a draw (`sample` from 1 on) of what no table knows, its scatter times
    `width`. `stated`: its numerical error is wanted too.
    """

    inputs: Inputs
    sample: int = 0
    width: float = 1.0
    stated: bool = False


def scene_of(trial: Trial, variant: TrialVariant, seed: int = 0, motion: BaseExcitation | None = None) -> Scene:
    """The scene of one variant, its `motion` as `motion_of` has it read already. Raises `InputError` that names test and file."""
    inputs, (turn_deg, edge_m, rough) = variant.inputs, _scatter(trial, variant, seed)
    shaken = scaled(motion_of(trial, inputs) if motion is None else motion, inputs.sign, inputs.scale)
    own = None if trial.scene is None else _scene(trial.scene)
    if own is not None and own.statue.solid is None:
        turn_deg = 0.0  # numbers of one plane say nothing of others: only a turn that the table asks for is refused
    statue = _turned(trial, replace(inputs, azimuth_deg=inputs.azimuth_deg + turn_deg), edge_m)
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
    """The motion of a test before its sign and scale: of its file, treated as its inputs say, or of its scene.

    `fewer`: a file's in as few samples as say as much. Raises `InputError`.
    """
    if trial.motion is None:
        assert trial.scene is not None
        return _scene(trial.scene).base_excitation
    treatment = (trial.motion_unit, trial.time_column, inputs.baseline, inputs.bandpass_hz)
    read = _thinned if fewer else _component
    x = read(trial.motion, trial.column, treatment)
    y, z = (
        ZeroExcitation() if column is None else read(trial.motion, column, treatment)
        for column in (trial.column_y, trial.column_z)
    )
    return BaseExcitation(x, y, z)


def _scatter(trial: Trial, variant: TrialVariant, seed: int) -> tuple[float, float, float]:
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


def inset(statue: Statue, inset_m: float, edge_m: float) -> Statue:
    """A statue known by its numbers alone, with every edge of its base moved inwards (outwards where negative)."""
    footprint = _inwards(statue.footprint_m, statue.footprint_m, inset_m, edge_m)
    section = np.insert(statue.section_m, 1, 0.0, axis=1)
    low = section[:, 2] <= statue.footprint_m[:, 2].max() + 1e-9
    section[low] = _inwards(section[low], statue.footprint_m, inset_m, edge_m)
    return replace(
        statue,
        corner_left_m=-float(footprint[:, 0].min()),
        corner_right_m=float(footprint[:, 0].max()),
        footprint_m=footprint,
        section_m=section[:, [0, 2]],
    )


_scene = lru_cache(maxsize=64)(load.load_scene)


def _turned(trial: Trial, inputs: Inputs, edge_m: float = 0.0) -> Statue:
    """The body of a trial, turned, every edge of its base moved inwards, and by what a draw adds."""
    azimuth_deg, inset_m = inputs.azimuth_deg, inputs.inset_m
    if trial.scene is None:
        density = None if trial.mass_kg is not None else trial.density_kg_m3
        tolerance_m = inputs.contact_tolerance_m
        solid = _solid(Path(trial.body), trial.unit, trial.up, density, trial.mass_kg, tolerance_m)
        return _statue(solid, trial.body, azimuth_deg, inset_m, edge_m)
    statue = _scene(trial.scene).statue
    if not azimuth_deg and not inset_m and not edge_m:
        return statue
    if statue.solid is not None:
        return _statue(statue.solid, trial.body, azimuth_deg, inset_m, edge_m)
    wanted = "0: the scene's statue is given by numbers alone, which say nothing of other directions"
    require(not azimuth_deg, str(trial.scene), wanted, f"{azimuth_deg:g}", key=f"test {trial.name}: azimuth_deg")
    return inset(statue, inset_m, edge_m)


@lru_cache(maxsize=1024)
def _statue(solid: meshes.Solid, file: str, azimuth_deg: float, inset_m: float, edge_m: float) -> Statue:
    with translated(meshes.MeshError, file, "a body that can stand", key=f"azimuth {azimuth_deg:g}"):
        return statue_of(_pared(solid.rotated(azimuth_deg) if azimuth_deg else solid, inset_m, edge_m))


def _pared(solid: meshes.Solid, inset_m: float, edge_m: float) -> meshes.Solid:
    """The solid with the vertices of its base moved inwards; mass and inertia stay."""
    if inset_m == edge_m == 0.0:
        return solid
    vertices, footprint = solid.vertices_m.copy(), solid.footprint_m
    low = vertices[:, 2] <= solid.contact_tolerance_m
    vertices[low] = _inwards(vertices[low], footprint, inset_m, edge_m)
    return replace(solid, vertices_m=vertices, footprint_m=_inwards(footprint, footprint, inset_m, edge_m))


def _inwards(points_m: Array, footprint_m: Array, inset_m: float, edge_m: float) -> Array:
    """Points (n, 3) moved towards the middle of the base so that its edges move by `inset_m`, and by `edge_m`, which is chance:
    by at most a tenth of the base. Of one that is worn away its middle is left.
    """
    low, high = footprint_m[:, :2].min(axis=0), footprint_m[:, :2].max(axis=0)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    shrink = 1.0 - inset_m / half - np.clip(edge_m / half, -0.1, 0.1)
    moved = points_m.copy()
    moved[:, :2] = middle + (points_m[:, :2] - middle) * (shrink if shrink.min() > 0.0 else 0.0)
    return moved


@lru_cache(maxsize=64)
def _solid(
    path: Path, unit: str, up: str, density_kg_m3: float | None, mass_kg: float | None, tolerance_m: float | None
) -> meshes.Solid:
    touching = {} if tolerance_m is None else {"contact_tolerance_m": tolerance_m}
    with translated(meshes.MeshError, str(path), "a mesh that can be computed"):
        return meshes.load_solid(path, unit=unit, up=up, density_kg_m3=density_kg_m3, mass_kg=mass_kg, **touching)


def intensity_of(trial: Trial) -> Intensity:
    """Peaks of a test's motion along the rocking plane, at the first value of each list; reads all of the test's files.

    Raises `InputError` where the body does not stand at a value of another list too.
    """
    inputs = trial.inputs()
    otherwise_s = 1.0 if trial.scene is None else _scene(trial.scene).duration_s
    of_body = {name: trial.unknown.get(name, ()) for name in ("azimuth_deg", "contact_tolerance_m", "inset_m")}
    for each in [inputs, *(replace(inputs, **{name: value}) for name in of_body for value in of_body[name])]:
        statue = _turned(trial, each)
        wanted, stands = (
            "an inset that leaves a base under the centroid",
            min(statue.corner_left_m, statue.corner_right_m),
        )
        require(stands > 0.0, trial.body, wanted, f"{each.inset_m:g}", key=f"test {trial.name}: inset_m")
    motion = motion_of(trial, inputs)
    peaks = intensity(motion.x, _duration_s(trial, motion, otherwise_s))
    return Intensity(inputs.scale * peaks.pga_g, inputs.scale * peaks.pgv_m_s)


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
