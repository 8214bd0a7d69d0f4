"""A table of experiments made for tests: a lopsided stone on a table shaken by sine bursts at 800 Hz."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from harness import Outcome, RunOptions, simulate
from harness.questions.validate.scenes import Inputs, Trial, TrialVariant, scene_of
from harness.questions.validate.validation_run import run_validation
from harness.records.base import as_file

RATE_HZ = 800.0
BASE = np.array([[-0.10, -0.14], [0.12, -0.13], [0.13, 0.10], [-0.02, 0.16], [-0.11, 0.09]])


def write_stone(path: Path, *, height_m: float = 0.8, lean: float = 0.02) -> None:
    """A convex stone on a five-cornered base, its top smaller and shifted."""
    top = 0.6 * BASE + [lean, 0.0]
    points = np.vstack(
        (np.column_stack((BASE, np.zeros(5))), np.column_stack((top, np.full(5, height_m)))),
    )
    trimesh.Trimesh(points).convex_hull.export(path)


def write_motion(path: Path, *, amplitude_m_s2: float, frequency_hz: float, cycles: int = 4) -> None:
    """A sine burst with a linear rise, a row of 800 a second, columns `time_s` and `table`."""
    t = np.arange(int(RATE_HZ * (cycles / frequency_hz + 0.2))) / RATE_HZ
    wave = amplitude_m_s2 * np.sin(2 * np.pi * frequency_hz * t) * np.clip(t * frequency_hz, 0.0, 1.0)
    wave[t > cycles / frequency_hz] = 0.0
    np.savetxt(path, np.column_stack((t, wave)), delimiter=",", header="time_s,table", comments="", fmt="%.9g")


def write_table(path: Path, rows: Sequence[Mapping[str, Any]]) -> Path:
    """A table with every column that any row names."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, names, restval="")
        writer.writeheader()
        writer.writerows(rows)
    return path


def write_experiments(folder: Path, amplitudes: Sequence[float], **columns: Any) -> Path:
    """One stone, one burst at 2 Hz for each amplitude; every test is said to have stood until told otherwise."""
    write_stone(folder / "stone.ply")
    rows = []
    for number, amplitude in enumerate(amplitudes):
        write_motion(folder / f"burst{number}.csv", amplitude_m_s2=amplitude, frequency_hz=2.0)
        row = {"test": f"t{number}", "mesh": "stone.ply", "motion": f"burst{number}.csv", "column": "table"}
        rows.append(row | {"motion_unit": "m/s2", "observed": "stands"} | columns)
    return write_table(folder / "experiments.csv", rows)


def read_rows(path: Path) -> list[dict[str, Any]]:
    """The rows of a table as they stand in it."""
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def listing(trial: Trial, **lists: Sequence[Any]) -> Trial:
    """A test with other lists of values of these inputs, as its table may have them."""
    every = trial.unknown | {name: tuple(values) for name, values in lists.items()}
    first = replace(trial.first, **{name: values[0] for name, values in lists.items()})
    names = [item.name for item in fields(Inputs) if len(every.get(item.name, ())) > 1]
    return replace(trial, first=first, lists=tuple((name, every[name]) for name in names))


def seen(trial: Trial, **chosen: Any) -> Outcome:
    """How the analytic model says that a test ends at these values of what it does not know."""
    scene = scene_of(trial, variant(trial, **chosen))
    return simulate(scene, "analytic", options=RunOptions(history=False)).outcome


def variant(trial: Trial, sample: int = 0, **chosen: Any) -> TrialVariant:
    """A test at these values of what it does not know, or a draw of it."""
    return TrialVariant(trial.inputs(replace(trial.inputs(), **chosen)), sample)


def validate(experiments: Path, folder: Path, **options: Any) -> dict[str, Any]:
    """The record of a validation as plain values, as its file has it."""
    return as_file(run_validation(experiments, folder, **options))
