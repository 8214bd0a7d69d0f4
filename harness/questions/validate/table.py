"""The table of experiments: one row for each test on a shake table, as CSV."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from harness.comparison.statistics.outcomes import FELL
from harness.input import paths
from harness.input.text_file import decimal, decoded, read_bytes
from harness.model.errors import InputError, Mistake, nearest, refuse
from harness.model.history import Outcome
from harness.model.run_set import grouped

COLUMNS: Final[Mapping[str, str]] = {
    "test": "name of the test, each once",
    "scene": "scene file (TOML) whose statue, pedestal and contact are meant; or",
    "mesh": "file of the body's surface, standing on the floor",
    "unit": "unit of the mesh: m, dm, cm, mm, in, ft (default m)",
    "up": "vertical axis of the mesh's file (default z)",
    "density_kg_m3": "density of the body (default 2700; without a pedestal it changes nothing)",
    "mass_kg": "mass of the body of a mesh as weighed (default: from its density)",
    "contact_tolerance_m": "height above a mesh's lowest point within which it touches (default 0.001)",
    "inset_m": "how far the base's edge is worn inwards (default 0)",
    "azimuth_deg": "turn of the body about the vertical (default 0)",
    "friction": "friction of the body on its support (default: the scene's)",
    "motion": "file of the table's motion, any format that a scene may name (default: the scene's)",
    "column": "channel along the rocking plane",
    "column_y": "channel across it",
    "column_z": "vertical channel",
    "motion_unit": "unit of the motion where its file does not state it: m/s2, cm/s2, mm/s2, g",
    "time_column": "column of times of a motion's table, by its header or number, where no reader knows it",
    "baseline": "what is taken off the motion: none, mean, linear, quadratic, rest (default none)",
    "bandpass_hz": "filter of the motion: two corner frequencies, low;high, or none; several with | (default none)",
    "sign": "1 or -1: whether the table's positive direction is the scene's (default 1)",
    "scale": "factor on the motion (default 1)",
    "duration_s": "time to simulate (default: the motion's end and a while for rocking to die down)",
    "observed": "0 or stands, 1 or overturned, or with its side: overturned_left, _right, _front, _back",
    "history": "file of the measured rotation (columns t_s, theta_rad)",
    "history_uncertainty_rad": "standard uncertainty of the measured rotation",
    "day": "day of testing, or whatever else was set up at once (default: all tests of a body)",
    "share": "name of the part of the tests that this one belongs to (unknown inputs are fitted on one named share)",
}
OF_MESH: Final = ("unit", "up", "density_kg_m3", "mass_kg", "contact_tolerance_m")
OF_MOTION: Final = ("column", "column_y", "column_z", "motion_unit", "time_column", "baseline", "bandpass_hz")
"""What is said of a body's mesh, and of a motion's file."""
OBSERVED: Final = (FELL, *(outcome.value for outcome in Outcome if outcome is Outcome.STANDS or outcome.overturned))
NUMBERED: Final[Mapping[str, str]] = {"0": Outcome.STANDS.value, "1": FELL}
"""Outcomes as a logbook writes them."""
BASELINES: Final = ("none", "mean", "linear", "quadratic", "rest")


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


OPEN: Final = tuple(item.name for item in fields(Inputs))
OF_BODY: Final = ("contact_tolerance_m", "inset_m", "friction")
"""What a body keeps from day to day; the others are each day's own."""
LARGEST: Final = 1e6
"""Larger than any azimuth, density, friction, factor on a motion or duration of a test."""
LIST_SEPARATOR: Final = ";"
DEFAULT_DENSITY_KG_M3: Final = 2700.0


@dataclass(frozen=True)
class Trial:
    """One test of the table, paths resolved; None where a column is left empty and the scene decides."""

    name: str
    row: int
    observed: str
    scene: Path | None = None
    mesh: Path | None = None
    unit: str = "m"
    up: str = "z"
    density_kg_m3: float = DEFAULT_DENSITY_KG_M3
    mass_kg: float | None = None
    azimuth_deg: tuple[float, ...] = (0.0,)
    contact_tolerance_m: tuple[float | None, ...] = (None,)
    inset_m: tuple[float, ...] = (0.0,)
    friction: tuple[float | None, ...] = (None,)
    sign: tuple[int, ...] = (1,)
    scale: tuple[float, ...] = (1.0,)
    baseline: tuple[str, ...] = ("none",)
    bandpass_hz: tuple[tuple[float, float] | None, ...] = (None,)
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
        return {name: values for name in OPEN if len(values := getattr(self, name)) > 1}

    def inputs(self, chosen: Inputs | None = None) -> Inputs:
        """The row's values; of what it does not know the chosen ones (none: the first of each list)."""
        if chosen is None or not self.unknown:
            return self._first
        return replace(self._first, **{name: getattr(chosen, name) for name in self.unknown})

    @cached_property
    def _first(self) -> Inputs:
        return Inputs(**{name: getattr(self, name)[0] for name in OPEN})

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
    if len(lines) < 2:
        raise InputError(Mistake(str(path), "", "a header line and at least one test", f"{len(lines)} lines"))
    names = [name.strip() for name in lines[0]]
    mistakes = _header(path, names)
    refuse(mistakes)
    tests = [_Row(path, number, names, cells, mark, mistakes).trial() for number, cells in enumerate(lines[1:], 1)]
    mistakes += _set_of_tests(path, tests)
    refuse(mistakes)
    return tests


def _header(path: Path, names: Sequence[str]) -> list[Mistake]:
    known = f"a known column ({', '.join(COLUMNS)})"
    mistakes = [
        Mistake(str(path), "header", known, repr(name), nearest(name, COLUMNS)) for name in names if name not in COLUMNS
    ]
    mistakes += [
        Mistake(str(path), "header", "each column once", f"{name} {names.count(name)} times")
        for name in dict.fromkeys(names)
        if names.count(name) > 1
    ]
    mistakes += [
        Mistake(str(path), "header", f"a column {name}", "none") for name in ("test", "observed") if name not in names
    ]
    if "scene" not in names and "mesh" not in names:
        mistakes.append(Mistake(str(path), "header", "a column scene or mesh", "neither"))
    return mistakes


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


class _Row:
    """One line being read; its mistakes go to the table's list."""

    def __init__(
        self, path: Path, number: int, names: list[str], cells: list[str], mark: str, mistakes: list[Mistake]
    ) -> None:
        self._path, self._number, self._mistakes = path, number, mistakes
        self._comma = "," if mark == "," else "."  # a table that is not parted by commas may have decimal commas
        if len(cells) != len(names):
            self._wrong("", f"{len(names)} cells", f"{len(cells)}")
        self._cells = {name: cell.strip() for name, cell in zip(names, cells, strict=False)}

    def trial(self) -> Trial:
        """The test of this row, with whatever could be read of it."""
        scene, mesh = self._file("scene"), self._file("mesh")
        if not self._cell("test"):
            self._wrong("test", COLUMNS["test"], "nothing")
        if bool(self._cell("scene")) == bool(self._cell("mesh")):
            self._wrong("scene", "either a scene or a mesh", "both" if self._cell("scene") else "neither")
        motion = self._file("motion")
        if self._cell("mesh") and not self._cell("motion"):
            self._wrong("motion", "a file with the table's motion", "nothing")
        elif not self._cell("motion") and (said := self._said(OF_MOTION)):
            self._wrong("motion", f"{said} of a file", "the scene's own motion", "say it in its own file")
        if scene and (said := self._said(OF_MESH)):
            self._wrong("scene", f"{said} of a mesh", "a scene", "say it in its own file")
        return Trial(
            name=self._cell("test") or f"row {self._number}",
            row=self._number,
            observed=NUMBERED.get(self._cell("observed")) or self._choice("observed", (*NUMBERED, *OBSERVED), ""),
            scene=scene,
            mesh=mesh,
            unit=self._choice("unit", ("m", "dm", "cm", "mm", "in", "ft"), "m"),
            up=self._choice("up", ("x", "y", "z", "-x", "-y", "-z"), "z"),
            density_kg_m3=self._number_in("density_kg_m3", DEFAULT_DENSITY_KG_M3),
            mass_kg=self._number_in("mass_kg") or None,
            azimuth_deg=tuple(self._numbers("azimuth_deg")) or (0.0,),
            contact_tolerance_m=tuple(self._numbers("contact_tolerance_m", above=0.0)) or (None,),
            inset_m=tuple(self._numbers("inset_m")) or (0.0,),
            friction=tuple(self._numbers("friction", above=0.0)) or (None,),
            sign=tuple(int(each) for each in self._choices("sign", ("1", "-1", "+1"), "1")),
            scale=tuple(self._numbers("scale", above=0.0)) or (1.0,),
            baseline=tuple(self._choices("baseline", BASELINES, "none")),
            bandpass_hz=self._bands(),
            motion=motion,
            column=self._cell("column") or None,
            column_y=self._cell("column_y") or None,
            column_z=self._cell("column_z") or None,
            motion_unit=self._choice("motion_unit", ("m/s2", "cm/s2", "mm/s2", "g"), "") or None,
            time_column=self._cell("time_column") or None,
            duration_s=self._number_in("duration_s") or None,
            history=self._file("history"),
            history_uncertainty_rad=self._number_in("history_uncertainty_rad") or None,
            day=self._cell("day"),
            share=self._cell("share"),
        )

    def _said(self, columns: Sequence[str]) -> str:
        """Those of the columns in which something stands."""
        return " and ".join(name for name in columns if self._cell(name))

    def _cell(self, name: str) -> str:
        return self._cells.get(name, "")

    def _wrong(self, column: str, wanted: str, got: str, advice: str = "") -> None:
        key = f"row {self._number}: {column}" if column else f"row {self._number}"
        self._mistakes.append(Mistake(str(self._path), key, wanted, got, advice))

    def _file(self, column: str) -> Path | None:
        if not self._cell(column):
            return None
        key = f"row {self._number}: {column}"
        try:
            return paths.resolve(self._cell(column), base_dir=self._path.parent, where=str(self._path), key=key)
        except InputError as error:
            self._mistakes.extend(error.mistakes)
            return None

    def _choice(self, column: str, known: Sequence[str], otherwise: str) -> str:
        return self._known(column, self._cell(column) or otherwise, known, otherwise)

    def _choices(self, column: str, known: Sequence[str], otherwise: str) -> list[str]:
        cells = (self._cell(column) or otherwise).split(LIST_SEPARATOR)
        return list(dict.fromkeys(self._known(column, cell.strip(), known, otherwise) for cell in cells))

    def _known(self, column: str, cell: str, known: Sequence[str], otherwise: str) -> str:
        if cell in known or (cell == otherwise and column != "observed"):
            return cell
        self._wrong(column, f"one of {', '.join(known)}", repr(cell), nearest(cell, known))
        return otherwise or known[0]

    def _bands(self) -> tuple[tuple[float, float] | None, ...]:
        bands: list[tuple[float, float] | None] = []
        for cell in self._cell("bandpass_hz").split("|"):
            if cell.strip() in ("", "none"):
                bands.append(None)
                continue
            band = self._parsed("bandpass_hz", cell, 0.0)
            if len(band) == 2 and band[0] < band[1]:
                bands.append((band[0], band[1]))
            else:
                self._wrong("bandpass_hz", "two frequencies, low;high (several with |)", repr(cell.strip()))
        return tuple(dict.fromkeys(bands)) or (None,)

    def _numbers(self, column: str, above: float = -math.inf) -> list[float]:
        return list(dict.fromkeys(self._parsed(column, self._cell(column), above)))

    def _parsed(self, column: str, cell: str, above: float) -> list[float]:
        numbers = []
        for text in cell.split(LIST_SEPARATOR) if cell else []:
            try:
                value = decimal(text.replace(",", self._comma))
            except ValueError:
                value = math.nan
            if not (abs(value) <= LARGEST and value > above):
                limit = "" if above == -math.inf else f" above {above:g}"
                wanted = f"a finite number{limit}, at most {LARGEST:g} (several with {LIST_SEPARATOR})"
                self._wrong(column, wanted, repr(text.strip()))
                continue
            numbers.append(value)
        return numbers

    def _number_in(self, column: str, otherwise: float = 0.0) -> float:
        numbers = self._numbers(column, above=0.0)
        if len(numbers) > 1:
            self._wrong(column, "one number", self._cell(column))
        return numbers[0] if numbers else otherwise
