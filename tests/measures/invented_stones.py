"""Invented tests of stones on a shaking table, of which the truth is known: `python -m tests.measures.invented_stones [--alike]`.

Each stone's contact tolerance, worn edge, sign and strength of the motion are drawn from the lists that its rows give; every test
has its own azimuth, base and friction within the scatter that `validate` assumes. Half of the tests, drawn at random, are the
share that is fitted on. "More runs" is the fit by nine times the runs, each for its own setting alone, and the true scatter,
scored in five times the draws: about what these tests can teach. "Truth known" is what the true probability of each test says,
from draws at the true inputs.
"""

import argparse
import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from unittest.mock import patch

import numpy as np
import trimesh
from numpy.typing import NDArray

from harness import RunOptions, simulate
from harness.comparison.statistics import reliability
from harness.questions.validate import scoring as fit
from harness.questions.validate.scenes import Inputs, Trial, TrialVariant, read_table, scene_of
from tests.harness.questions.validate.experiments import validate, write_table
from tests.measures.pages import renew, table

LISTS: Final[Mapping[str, Sequence[float]]] = {
    "contact_tolerance_m": (0.002, 0.004, 0.007),
    "inset_m": (0.0, 0.002, 0.004, 0.006),
    "sign": (1, -1),
    "scale": (0.8, 0.9, 1.0, 1.1, 1.2),
}
TRUTH_SEED: Final = 1_000_000
"""Of the draw that each test's truth is: no draw of a validation is one of these."""
TRUE_DRAWS: Final = 101
SAMPLES: Final = 20
MORE: Final[Mapping[str, Any]] = {"TRIED": 960, "DRAWS": 8, "WIDTHS": (1.0,), "NEAR": {}}
MORE_SAMPLES: Final = 100
MODULE: Final = "tests.measures.invented_stones"


def write_scan(path: Path, seed: int) -> None:
    """A stone of some 0.25 × 0.2 × 0.7 m with 2 500 vertices: a dented sphere cut flat with some roughness."""
    stream = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=4)
    points = ball.vertices * (0.125, 0.1, 0.35) * stream.uniform(0.9, 1.1, 3)
    for _ in range(12):
        direction = stream.standard_normal(3)
        direction /= np.linalg.norm(direction)
        points *= 1.0 + 0.06 * stream.standard_normal() * np.maximum(ball.vertices @ direction, 0.0)[:, None] ** 2
    low = -0.25 + 0.0005 * stream.standard_normal(len(points))
    points[:, 2] = np.maximum(points[:, 2], low)
    trimesh.Trimesh(points, ball.faces).convex_hull.export(path)


def write_shaking(path: Path, seed: int, lines: int) -> None:
    """A burst of a sine with noise in a record of 49 s, as a table writes it."""
    stream = np.random.default_rng([7, seed])
    times = 49.0 * np.arange(lines) / lines
    strength, frequency = stream.uniform(1.2, 4.0), stream.uniform(1.2, 4.5)
    swell = np.exp(-(((times - 15.0) / 3.0) ** 2))
    wave = np.sin(2.0 * np.pi * frequency * times) + 0.5 * np.sin(2.0 * np.pi * 1.7 * frequency * times + 1.0)
    noise = np.interp(times, np.linspace(0.0, 49.0, 981), 0.3 * stream.standard_normal(981))
    table = np.column_stack([times, strength * swell * (wave + noise)])
    np.savetxt(path, table, delimiter=",", header="time_s,table", comments="", fmt="%.6g")


def write_tests(
    folder: Path, stones: int, motions: int, lines: int, seed: int, alike: bool = False
) -> tuple[Path, list[Inputs]]:
    """The table of tests, with what was observed, and each test's true inputs."""
    stream = np.random.default_rng(seed)
    truth = [Inputs(**{name: stream.choice(values).item() for name, values in LISTS.items()}) for _ in range(stones)]
    truth = truth[:1] * stones if alike else truth
    for stone in range(stones):
        write_scan(folder / f"stone{stone}.ply", 100 * seed + stone)
    for motion in range(motions):
        write_shaking(folder / f"motion{motion}.csv", 1000 * seed + motion, lines)
    listed = {name: ";".join(f"{each:g}" for each in values) for name, values in LISTS.items()}
    rows: list[dict[str, Any]] = [
        {"test": f"s{stone}m{motion}", "mesh": f"stone{stone}.ply", "motion": f"motion{motion}.csv", "column": "table",
         "motion_unit": "m/s2", "observed": "stands", "friction": 0.6, "share": "fit" if stream.random() < 0.5 else "rest"}
        | listed for stone in range(stones) for motion in range(motions)
    ]  # fmt: skip
    path = write_table(folder / "tests.csv", rows)
    known, inputs = list[dict[str, Any]](), list[Inputs]()
    for k, (row, trial) in enumerate(zip(rows, read_table(path), strict=True)):
        own = truth[k // motions]
        fell = _falls(trial, TrialVariant(trial.inputs(own), k + 1), TRUTH_SEED)
        if fell is not None:  # of a body that flies off, which the model does not follow, it is not known
            known.append(row | {"observed": str(int(fell))})
            inputs.append(own)
    return write_table(path, known), inputs


def _falls(trial: Trial, variant: TrialVariant, seed: int) -> bool | None:
    run = simulate(scene_of(trial, variant, seed), "analytic", options=RunOptions(history=False, stated=False))
    return run.outcome.fell


@dataclass(frozen=True, eq=False)
class Scored:
    """What was said of the scored tests of one table, and what is true."""

    p: Mapping[str, NDArray[np.float64]]
    """Each test's probability of falling: fitted, by more runs, and the true one."""
    fell: NDArray[np.bool_]
    held: Mapping[str, Sequence[bool]]
    """Whether each bin of the reliability diagram is in its band, by the same."""
    hits: Mapping[str, Sequence[bool]]
    """Whether the most probable value is the true one, by input and stone."""
    fit: str
    runs: int
    more_runs: int
    processor_s: float


def score(table_file: Path, inputs: Sequence[Inputs], out: Path) -> Scored:
    """Validate the table by the analytic model, as it does and by more runs, and draw its tests at their true inputs."""
    begin = sum(os.times()[:4])
    found = _validated(table_file, out / "own", SAMPLES)
    spent = sum(os.times()[:4]) - begin
    with patch.multiple(fit, **MORE):
        more = _validated(table_file, out / "more", MORE_SAMPLES)
    trials = [trial for trial in read_table(table_file) if trial.share != "fit"]
    own, most = (
        np.array([row["probability"]["analytic"] for row in each["rows"] if row["share"] != "fit"])
        for each in (found, more)
    )
    by_name = {row["test"]: each for row, each in zip(found["rows"], inputs, strict=True)}
    true = np.array([_true(trial, by_name[trial.name]) for trial in trials])
    fitted, fell = found["models"]["analytic"]["fitted"], np.array([trial.fell for trial in trials])
    truth = {(Path(trial.body).name, name): getattr(by_name[trial.name], name) for trial in trials for name in LISTS}
    hits: dict[str, list[bool]] = {name: [] for name in LISTS}
    for each in fitted["inputs"]:
        hits[each["input"]].append(each["value"] == truth[each["body"], each["input"]])
    return Scored(
        {"fitted": own, "more runs": most, "truth known": true},
        fell,
        {
            "fitted": _held(found),
            "more runs": _held(more),
            "truth known": [each.holds for each in reliability(true, fell)],
        },
        hits,
        f"{fitted['width']:g}, {fitted['counts']:.2g}",
        found["runs"]["computed"],
        more["runs"]["computed"],
        spent,
    )


def told(scored: Sequence[Scored]) -> str:
    """All tables together: scores of what was said, the diagram's bins, and the most probable values."""
    fell = np.concatenate([each.fell for each in scored])
    p = {name: np.concatenate([each.p[name] for each in scored]) for name in scored[0].p}
    true, tests = p["truth known"], str(len(fell))
    scores: list[tuple[str, Callable[[Any], Any]]] = [
        ("right by P ≥ ½, as it came", lambda p: (p >= 0.5) == fell),
        ("right by P ≥ ½, expected", lambda p: np.where(p >= 0.5, true, 1.0 - true)),
        ("Brier's score", lambda p: (p - fell) ** 2),
    ]
    lines = [[name, tests, *(f"{np.mean(of(each)):.3f}" for each in p.values())] for name, of in scores]
    held = [[holds for each in scored for holds in each.held[name]] for name in p]
    bins = [f"{sum(of)} of {len(of)}" for of in held]
    lines.append(["bins of each set's reliability diagram in their band", tests, *bins])
    hits = {name: [hit for each in scored for hit in each.hits[name]] for name in LISTS}
    shares = ", ".join(f"{np.mean(hit):.2f}" for hit in hits.values())
    lines.append([f"most probable value is true ({', '.join(hits)})", str(len(hits["sign"])), shares, "–", "1"])
    spent = sum(each.processor_s for each in scored)
    runs, more = (sum(getattr(each, name) for each in scored) for name in ("runs", "more_runs"))
    chosen = f"Fitted scatter (the true one is 1) and counts: {'; '.join(each.fit for each in scored)}."
    cost = f"{runs} runs, {spent:.0f} s of processor; {more} runs with more."
    return f"{table(['score', 'tests', *p], lines)}\n\n{chosen} {cost}"


def _validated(table_file: Path, out: Path, samples: int) -> Any:
    return validate(table_file, out, models=["analytic"], samples=samples, jobs=1, quiet=True)


def _held(found: Any) -> list[bool]:
    bins = found["models"]["analytic"]["probability"]["reliability"]
    return [each["band_low"] <= each["fell"]["value"] <= each["band_high"] for each in bins]


def _true(trial: Trial, own: Inputs) -> float:
    """The probability of a fall at the true inputs."""
    draws = [TrialVariant(trial.inputs(own), k) for k in range(1, TRUE_DRAWS)]
    return float(np.mean([fell for each in draws if (fell := _falls(trial, each, 2 * TRUTH_SEED)) is not None]))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--stones", type=int, default=10)
    parser.add_argument("--motions", type=int, default=50)
    parser.add_argument("--lines", type=int, default=4900)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--alike", action="store_true", help="what is unknown is the same of all stones")
    asked = parser.parse_args()
    scored = []
    for seed in asked.seeds:
        with tempfile.TemporaryDirectory() as folder:
            made = write_tests(Path(folder), asked.stones, asked.motions, asked.lines, seed, asked.alike)
            scored.append(score(*made, Path(folder) / "out"))
    of_each = f"{asked.stones} stones, {asked.motions} motions of {asked.lines} lines"
    title = f"Seeds {', '.join(map(str, asked.seeds))}, each {of_each}; {SAMPLES} draws of each test."
    command = f"{MODULE} --alike" if asked.alike else MODULE
    renew("measured/invented_stones.md", command, f"{title}\n\n{told(scored)}")
