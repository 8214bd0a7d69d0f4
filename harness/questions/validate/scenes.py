"""From a table of experiments (CSV, one row for each test on a shake table) to what is run: scenes, and what names their runs."""

import csv
import hashlib
import io
import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache, partial
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from pydantic import JsonValue, ValidationError

import meshes
from analytic.block import GRAVITY_M_S2 as GRAVITY_M_S2
from analytic.excitation import Excitation, SampledAcceleration, ZeroExcitation
from harness import engines
from harness.accuracy.refinement import DEFAULT_ACCURACY_RAD, check_target, simulate
from harness.comparison.statistics import FELL
from harness.input.files import decimals, decoded, existing_file, numbers, read_bytes
from harness.input.mesh_statue import statue_of
from harness.input.motions import SceneMotion, prepare
from harness.input.motions.spec import RecordSpec
from harness.input.scene_file import load_scene
from harness.model import (
    Array,
    BaseExcitation,
    Capabilities,
    Contact,
    Form,
    InputError,
    Mistake,
    Outcome,
    Run,
    RunOptions,
    Scene,
    Statue,
    check_known,
    grouped,
    nearest,
    refuse,
    require,
    required,
    translated,
    versions,
)
from harness.questions.study.rocking_spectrum import RING_DOWN_S
from harness.records.study import CaseRun
from harness.runs.runner import Crash
from harness.runs.task import RunRequest, Task, TaskResult, key_of, lost_answer, lost_run, run_request, scene_key

LARGEST: Final = 1e6
"""Larger than any azimuth, density, friction, factor on a motion or duration of a test."""
LIST: Final = ";"
"""What parts several values of a column."""
OBSERVED: Final = (FELL, *(outcome.value for outcome in Outcome if outcome is Outcome.STANDS or outcome.overturned))
NUMBERED: Final[Mapping[str, str]] = {"0": Outcome.STANDS.value, "1": FELL}
"""Outcomes as a logbook writes them."""
SIGNS: Final[Mapping[str, int]] = {"1": 1, "-1": -1, "+1": 1}

# What makes a value of a cell's text; `InputError` for a text of which it makes none.


def one_of(*known: str, meaning: Mapping[str, Any] | None = None) -> Callable[[str], Any]:
    """Reads one of these texts, by what it means where that is another thing."""

    def read(text: str) -> Any:
        check_known(text, known, "")
        return (meaning or {}).get(text, text)

    return read


def number(wanted: str, above: float = -math.inf) -> Callable[[str], float]:
    """Reads a number above a limit, no larger than any that is measured."""

    def read(text: str) -> float:
        (value,) = numbers([text])
        require(abs(value) <= LARGEST and value > above, "", wanted, repr(text))
        return value

    return read


POSITIVE: Final = number(f"one number above 0, at most {LARGEST:g}", 0.0)
POSITIVES: Final = number(f"a finite number above 0, at most {LARGEST:g} (several with {LIST})", 0.0)
NUMBERS: Final = number(f"a finite number, at most {LARGEST:g} (several with {LIST})")


def band(text: str) -> tuple[float, float] | None:
    """Reads two corner frequencies, or none."""
    ends = numbers(text.split(LIST))
    good = len(ends) == 2 and 0.0 < ends[0] < ends[1] <= LARGEST
    require(good or text in ("", "none"), "", "two frequencies, low;high (several with |)", repr(text))
    return (ends[0], ends[1]) if good else None


@dataclass(frozen=True)
class Column:
    """What a column says, what reads one of its values (a `Path`: of an existing file), and what parts several of them."""

    says: str
    read: Callable[[str], Any] = str
    parted: str = ""


COLUMNS: Final[Mapping[str, Column]] = {
    "test": Column("name of the test, each once"),
    "scene": Column("scene file (TOML) whose statue, pedestal and contact are meant; or", Path),
    "mesh": Column("file of the body's surface, standing on the floor", Path),
    "unit": Column("unit of the mesh: m, dm, cm, mm, in, ft (default m)", one_of("m", "dm", "cm", "mm", "in", "ft")),
    "up": Column("vertical axis of the mesh's file (default z)", one_of("x", "y", "z", "-x", "-y", "-z")),
    "density_kg_m3": Column("density of the body (default 2700; without a pedestal it changes nothing)", POSITIVE),
    "mass_kg": Column("mass of the body of a mesh as weighed (default: from its density)", POSITIVE),
    "contact_tolerance_m": Column(
        "height above a mesh's lowest point within which it touches (default 0.001)", POSITIVES, LIST
    ),
    "inset_m": Column("how far the base's edge is worn inwards (default 0)", NUMBERS, LIST),
    "azimuth_deg": Column("turn of the body about the vertical (default 0)", NUMBERS, LIST),
    "friction": Column("friction of the body on its support (default: the scene's)", POSITIVES, LIST),
    "motion": Column("file of the table's motion, any format that a scene may name (default: the scene's)", Path),
    "column": Column("channel along the rocking plane"),
    "column_y": Column("channel across it"),
    "column_z": Column("vertical channel"),
    "motion_unit": Column(
        "unit of the motion where its file does not state it: m/s2, cm/s2, mm/s2, g",
        one_of("m/s2", "cm/s2", "mm/s2", "g"),
    ),
    "time_column": Column("column of times of a motion's table, by its header or number, where no reader knows it"),
    "baseline": Column(
        "what is taken off the motion: none, mean, linear, quadratic, rest (default none)",
        one_of("none", "mean", "linear", "quadratic", "rest"),
        LIST,
    ),
    "bandpass_hz": Column(
        "filter of the motion: two corner frequencies, low;high, or none; several with | (default none)", band, "|"
    ),
    "sign": Column(
        "1 or -1: whether the table's positive direction is the scene's (default 1)",
        one_of(*SIGNS, meaning=SIGNS),
        LIST,
    ),
    "scale": Column("factor on the motion (default 1)", POSITIVES, LIST),
    "duration_s": Column("time to simulate (default: the motion's end and a while for rocking to die down)", POSITIVE),
    "observed": Column(
        "0 or stands, 1 or overturned, or with its side: overturned_left, _right, _front, _back",
        one_of(*NUMBERED, *OBSERVED, meaning=NUMBERED),
    ),
    "history": Column("file of the measured rotation (columns t_s, theta_rad)", Path),
    "history_uncertainty_rad": Column("standard uncertainty of the measured rotation", POSITIVE),
    "day": Column("day of testing, or whatever else was set up at once (default: all tests of a body)"),
    "share": Column(
        "name of the part of the tests that this one belongs to (unknown inputs are fitted on one named share)"
    ),
}
OF_MESH: Final = ("unit", "up", "density_kg_m3", "mass_kg", "contact_tolerance_m")
OF_MOTION: Final = ("column", "column_y", "column_z", "motion_unit", "time_column", "baseline", "bandpass_hz")
"""What is said of a body's mesh, and of a motion's file."""


@dataclass(frozen=True)
class Inputs:
    """One value of each column that may list several, in which case it is not known: it is fitted, and drawn."""

    azimuth_deg: float = 0.0
    contact_tolerance_m: float | None = None
    inset_m: float = 0.0
    friction: float | None = None
    sign: int = 1
    scale: float = 1.0
    baseline: str = "none"
    bandpass_hz: tuple[float, float] | None = None


OF_BODY: Final = ("contact_tolerance_m", "inset_m", "friction")
"""What a body keeps from day to day; the others are each day's own."""


@dataclass(frozen=True)
class Trial:
    """One test of the table, paths resolved; None where a column is left empty and the scene decides.

    `first` are the first values of its inputs, `lists` all of each input of which there are several.
    """

    name: str
    row: int
    observed: str
    scene: Path | None = None
    mesh: Path | None = None
    unit: str = "m"
    up: str = "z"
    density_kg_m3: float = 2700.0
    mass_kg: float | None = None
    first: Inputs = Inputs()
    lists: tuple[tuple[str, tuple[Any, ...]], ...] = ()
    motion: Path | None = None
    column: str | None = None
    column_y: str | None = None
    column_z: str | None = None
    motion_unit: str | None = None
    time_column: str | None = None
    duration_s: float | None = None
    history: Path | None = None
    history_uncertainty_rad: float | None = None
    day: str = ""
    share: str = ""

    @cached_property
    def body(self) -> str:
        """What names the body."""
        return str(self.mesh or self.scene)

    @cached_property
    def body_name(self) -> str:
        """The body's file, wherever it lies."""
        return Path(self.body).name

    @cached_property
    def unknown(self) -> dict[str, tuple[Any, ...]]:
        """The columns of this row that list several values, with them."""
        return dict(self.lists)

    def inputs(self, chosen: Inputs | None = None) -> Inputs:
        """The row's values; of what it does not know the chosen ones (none: the first of each list)."""
        if chosen is None or not self.unknown:
            return self.first
        return replace(self.first, **{name: getattr(chosen, name) for name in self.unknown})

    @property
    def fell(self) -> bool:
        """Whether the body was seen to overturn, whichever way."""
        return self.observed != Outcome.STANDS.value


def read_table(path: Path) -> list[Trial]:
    """Read a table of experiments; raises `InputError` with every mistake, each with its row and column."""
    text = decoded(
        read_bytes(path, "a table of experiments"), str(path), "a CSV file with a header and at least one test"
    )
    head = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    mark = next((each for each in "\t;," if each in head), ",")
    try:
        rows = csv.reader(io.StringIO(text, newline=""), delimiter=mark)
        lines = [line for line in rows if line and not line[0].lstrip().startswith("#")]
    except csv.Error as error:
        raise InputError(Mistake(str(path), "", "a readable CSV file", type(error).__name__, str(error))) from error
    require(len(lines) >= 2, str(path), "a header line and at least one test", f"{len(lines)} lines")
    names = [name.strip() for name in lines[0]]
    mistakes = _header(path, names)
    refuse(mistakes)
    tests = []
    for row, cells in enumerate(lines[1:], 1):
        if len(cells) != len(names):
            mistakes.append(Mistake(str(path), f"row {row}", f"{len(names)} cells", f"{len(cells)}"))
        # A table that is not parted by commas may have decimal commas.
        named = {name: cell.strip() for name, cell in zip(names, cells, strict=False)}
        tests.append(_trial(path, row, named, "," if mark == "," else ".", mistakes))
    mistakes += _set_of_tests(path, tests)
    refuse(mistakes)
    return tests


def _header(path: Path, names: Sequence[str]) -> list[Mistake]:
    known, counts = f"a known column ({', '.join(COLUMNS)})", Counter(names)
    told: list[tuple[str, ...]] = [
        *((known, repr(name), nearest(name, COLUMNS)) for name in names if name not in COLUMNS),
        *(("each column once", f"{name} {count} times") for name, count in counts.items() if count > 1),
        *((f"a column {name}", "none") for name in ("test", "observed") if name not in counts),
    ]
    if not {"scene", "mesh"} & counts.keys():
        told.append(("a column scene or mesh", "neither"))
    return [Mistake(str(path), "header", *each) for each in told]


def _set_of_tests(path: Path, tests: Sequence[Trial]) -> list[Mistake]:
    """Mistakes that only the rows together show."""
    seen: dict[str, int] = {}
    mistakes = [
        Mistake(str(path), f"row {test.row}: test", "a name of its own", f"{test.name!r}, as row {first}")
        for test in tests
        if (first := seen.setdefault(test.name, test.row)) != test.row
    ]
    lists = grouped(((test.body, column), values) for test in tests for column, values in test.unknown.items())
    return mistakes + [
        Mistake(
            str(path),
            column,
            f"one list of values for {Path(body).name}, wherever it is not known",
            f"{len(set(several))} different lists",
        )
        for (body, column), several in lists.items()
        if len(set(several)) > 1
    ]


def _trial(path: Path, row: int, cells: Mapping[str, str], comma: str, mistakes: list[Mistake]) -> Trial:
    """The test of a row, with whatever could be read of it; what is wrong goes to the table's mistakes."""
    given: dict[str, list[Any]] = {}
    for name, cell in ((name, cell) for name, cell in cells.items() if cell):
        column, key = COLUMNS[name], f"row {row}: {name}"
        values: list[Any] = []
        for text in map(str.strip, cell.split(column.parted) if column.parted else [cell]):
            try:
                if column.read is Path:
                    values.append(existing_file(text, base_dir=path.parent, where=str(path), key=key))
                else:
                    values.append(column.read(text if column.read is str else text.replace(",", comma)))
            except InputError as error:
                mistakes += [replace(each, where=str(path), key=key) for each in error.mistakes]
        if values:
            given[name] = list(dict.fromkeys(values))
    scene, mesh, motion = (bool(cells.get(name)) for name in ("scene", "mesh", "motion"))
    of_mesh, of_motion = (" and ".join(name for name in names if cells.get(name)) for names in (OF_MESH, OF_MOTION))
    elsewhere = "say it in its own file"
    rules = [
        *((not cells.get(name), name, COLUMNS[name].says, "nothing", "") for name in ("test", "observed")),
        (scene == mesh, "scene", "either a scene or a mesh", "both" if scene else "neither", ""),
        (mesh and not motion, "motion", "a file with the table's motion", "nothing", ""),
        (
            of_motion and not mesh and not motion,
            "motion",
            f"{of_motion} of a file",
            "the scene's own motion",
            elsewhere,
        ),
        (of_mesh and scene, "scene", f"{of_mesh} of a mesh", "a scene", elsewhere),
    ]
    mistakes += [Mistake(str(path), f"row {row}: {column}", *told) for broken, column, *told in rules if broken]
    inputs = {item.name: given.pop(item.name) for item in fields(Inputs) if item.name in given}
    first = Inputs(**{name: values[0] for name, values in inputs.items()})
    lists = tuple((name, tuple(values)) for name, values in inputs.items() if len(values) > 1)
    (name,), (observed,) = given.pop("test", [f"row {row}"]), given.pop("observed", [""])
    return Trial(name, row, observed, first=first, lists=lists, **{key: value for key, (value,) in given.items()})


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

    The first column's base, 2, is left to the settings of unknown inputs (`harness.questions.validate.scoring`).
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


_scene = lru_cache(maxsize=64)(load_scene)


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
    files = [
        *(None if path is None else _file_digest(path) for path in (trial.mesh, trial.motion)),
        None if trial.scene is None else _scene_digest(trial.scene),
    ]
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


# The runs of a validation: which are wanted, what names them, and what a worker does.

BATCH: Final = {"analytic": 32, "pymunk": 8}
"""Runs handed to a worker at a time: enough that sending them costs little beside computing them; of other engines"""
BATCH_OTHERWISE: Final = 2


@dataclass(frozen=True)
class Model:
    """An engine with one setting; `name` is how the user wrote it (`pymunk`, `pymunk@accuracy=1e-4`, `pybullet@dt=5e-4`,
    `spatial@near=analytic`: asked only where draws of the model `near` disagree).
    """

    name: str
    engine: str
    accuracy_rad: float | None
    dt_s: float | None
    near: str = ""


def parse_model(text: str) -> Model:
    """A model as written on the command line. Raises `InputError`."""
    engine, _, setting = text.partition("@")
    engines.load(engine)
    name, _, value = setting.partition("=")
    if not setting or (name == "near" and value):
        return Model(text, engine, DEFAULT_ACCURACY_RAD, None, value)
    try:
        number = float(value)
    except ValueError:
        number = float("nan")
    wanted = "ENGINE, ENGINE@accuracy=RAD, ENGINE@dt=S or ENGINE@near=MODEL"
    require(name in ("accuracy", "dt") and number == number, "--engine", wanted, repr(text))
    accuracy, step = (number, None) if name == "accuracy" else (None, number)
    check_target(accuracy, step)
    return Model(text, engine, accuracy, step)


class Drawn(NamedTuple):
    """What is kept of a draw's run: a draw is counted, not judged."""

    outcome: Outcome
    peak_theta_rad: float


DRAWS: Final = "draws"
"""Kind of a result that is the draws of a test."""
TOGETHER: Final = {"analytic": 100}
"""Draws of one test that are one result; of other engines a single one: each takes longer than keeping it."""


@dataclass(frozen=True)
class TrialTask:
    """A task, and the variants of a test that it answers."""

    task: Task
    trial: Trial
    variants: Sequence[TrialVariant]

    def read(self, stored: Mapping[str, Any]) -> Iterator[tuple[tuple[str, TrialVariant], CaseRun | Drawn]]:
        """The answers, as they are stored."""
        runs: list[CaseRun | Drawn]
        if self.variants[0].stated:
            runs = [CaseRun.stored(stored)]
        else:
            ended = zip(stored["outcome"], stored["peak_theta_rad"], strict=True)
            runs = [Drawn(Outcome(outcome), peak) for outcome, peak in ended]
        return zip([(self.trial.name, variant) for variant in self.variants], runs, strict=True)


def asked_of(pairs: Sequence[tuple[Trial, TrialVariant]], model: Model, seed: int) -> list[TrialTask]:
    """The runs of variants of tests, each keyed by all that decides its answer.

    A draw's own error changes an outcome only near the boundary, where draws fall either way, and so does what is left out of its
    motion. Only a nominal run of the chosen inputs states its error.
    """
    of_code = [versions().get(name) for name in ("rockcheck", "numpy", "numba", model.engine)]
    by_test = grouped(((trial.name, variant.stated), variant) for trial, variant in pairs)
    trials = {trial.name: trial for trial, _ in pairs}
    found = []
    for (name, stated), variants in by_test.items():
        trial, digest = trials[name], digest_of(trials[name])
        size = 1 if stated else TOGETHER.get(model.engine, 1)
        # A history is wanted where a measured one is there to compare, in the nominal run.
        history = stated and trial.history is not None
        setting = model.engine, model.accuracy_rad, model.dt_s, history, None if stated else SHIFT_M
        for start in range(0, len(variants), size):
            some = variants[start : start + size]
            key = key_of(digest, repr(some), None if stated else seed, setting, of_code)
            # The motion is read once, for all processes.
            made = [
                partial(scene_of, trial, each, seed, motion_of(trial, each.inputs, fewer=not stated)) for each in some
            ]
            asked = model.engine, model.accuracy_rad, model.dt_s, history, stated
            runs = [RunRequest(each, *asked) for each in made]
            if stated:
                task = Task(key, run_request, runs[0], model.engine, lost_answer)
            else:
                # Draws that are together go to a worker by few, those alone by as many as nominal runs.
                group = f"{model.engine} draws" if size > 1 else model.engine
                task = Task(key, run_draws, runs, group, lost_draws, len(some))
            found.append(TrialTask(task, trial, some))
    return found


def run_draws(wanted: Sequence[RunRequest]) -> TaskResult:
    """Run each for its outcome and peak."""
    begin, inside_s, runs = time.perf_counter(), 0.0, []
    options = RunOptions(history=False, stated=False)
    for each in wanted:
        scene, start = each.made(), time.perf_counter()
        runs.append(simulate(scene, each.engine, accuracy_rad=each.accuracy_rad, dt_s=each.dt_s, options=options))
        inside_s += time.perf_counter() - start
    return _drawn(runs, time.perf_counter() - begin, inside_s)


def lost_draws(wanted: Sequence[RunRequest], crash: Crash) -> TaskResult:
    """The answer of draws whose worker died or hung."""
    return _drawn([lost_run(each.engine, crash) for each in wanted], 0.0, 0.0)


def _drawn(runs: Sequence[Run], seconds: float, inside_s: float) -> TaskResult:
    kept: dict[str, JsonValue] = {
        "outcome": [each.outcome.value for each in runs],
        "peak_theta_rad": [each.peak_theta_rad for each in runs],
    }
    return TaskResult(DRAWS, kept, seconds, inside_s=inside_s, failed=sum(each.outcome.failed for each in runs))
