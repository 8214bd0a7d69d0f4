"""The motion of a test: its table's columns, treated as the row says, and how strong it is."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from pydantic import ValidationError

from analytic.block import GRAVITY_M_S2
from analytic.excitation import Excitation, SampledAcceleration, ZeroExcitation
from harness.input.motions import SceneMotion, prepare
from harness.input.motions.spec import RecordSpec
from harness.input.text_file import decimals, decoded, read_bytes
from harness.model.errors import InputError, Mistake
from harness.model.history import Array
from harness.model.scene import BaseExcitation
from harness.questions.validate.table import Inputs, Trial

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

    def times(self, scale: float) -> Intensity:
        """Of the motion times a factor."""
        return Intensity(scale * self.pga_g, scale * self.pgv_m_s)


def shaking(trial: Trial, inputs: Inputs, fewer: bool = False) -> BaseExcitation:
    """The motion that a test's file holds, treated as its inputs say but for sign and scale; `fewer`: in as few samples as say as
    much. Raises `InputError`.
    """
    if trial.motion is None:
        raise InputError(Mistake(trial.body, f"test {trial.name}: motion", "a file with the table's motion", "nothing"))
    treatment = (trial.motion_unit, trial.time_column, inputs.baseline, inputs.bandpass_hz)
    read = _thinned if fewer else _component
    x = read(trial.motion, trial.column, treatment)
    y, z = (
        ZeroExcitation() if column is None else read(trial.motion, column, treatment)
        for column in (trial.column_y, trial.column_z)
    )
    return BaseExcitation(x, y, z)


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
    text = decoded(read_bytes(path, "a motion"), str(path), "a table with a header")
    rows: list[list[str]] = []
    first = None
    for place, line in enumerate(text.splitlines()):
        rows.append(_cells(line))
        if _numeric(rows[-1]):
            first = place
            break
    if first is None:
        advice = "leave out columns of words"
        raise InputError(Mistake(str(path), f"line {len(rows)}", "numbers in all columns", ", ".join(rows[-1]), advice))
    above = [row for row in reversed(rows[:first]) if any(row)] or [[]]
    headers = next((row for row in above if time_column in row), above[0])
    numbered = [str(number + 1) for number in range(len(rows[first]))]

    def number(name: str, key: str) -> int:
        for names in (headers, numbered):
            if name in names:
                return names.index(name) + 1
        raise InputError(Mistake(str(path), key, f"a column of {', '.join(headers or numbered)}", repr(name)))

    if column is None:
        raise InputError(Mistake(str(path), "column", f"a column of {', '.join(headers or numbered)}", "nothing"))
    times, values = number(time_column, "time_column"), number(column, "column")
    return {"time_column": times, "columns": f"{values}:a", "column": "a", "skip_lines": first}


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
    """Peaks of a motion; PGV without the drift of its velocity, for an offset of the record is no shaking."""
    samples = getattr(motion, "t_s", None)
    t_s = np.linspace(0.0, duration_s, 20_001) if samples is None else np.asarray(samples)
    velocity = detrended(t_s, np.asarray(motion.velocity_m_s(t_s)))
    return Intensity(motion.peak_m_s2 / GRAVITY_M_S2, float(np.max(np.abs(velocity))))


def detrended(t_s: Array, velocity_m_s: Array) -> Array:
    """Velocity (n,) less the drift c t that fits it best: a record's offset c integrates to it, and a table begins at rest."""
    since = t_s - t_s[0]
    weight = float(since @ since)
    return np.asarray(velocity_m_s - (float(since @ velocity_m_s) / weight if weight else 0.0) * since)
