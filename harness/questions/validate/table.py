"""The table of experiments: one row for each test on a shake table, as CSV."""

import csv
import io
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from harness.comparison.statistics import FELL
from harness.input.files import decoded, existing_file, numbers, read_bytes
from harness.model import InputError, Mistake, Outcome, check_known, grouped, nearest, refuse, require

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
