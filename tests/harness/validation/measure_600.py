"""600 tests on scanned stones at 800 Hz in one call: `python -m tests.harness.validation.measure_600 [MODEL...]`.

With `--folder DIR` the table and the results stay there, and a call that was ended goes on where it stopped; `--jobs N` runs at a
time. The stones are spheres dented at random and cut flat with some roughness, as photogrammetry gives them; the motions are sine
bursts of random frequency and strength. The observations are those of the first model; tests that it does not decide (a lift-off)
are left out, and told.
"""

from __future__ import annotations

import argparse
import json
import resource
import tempfile
import time
from pathlib import Path

import numpy as np
import trimesh

from harness.validation.table import OBSERVED
from tests.harness.validation.experiments import validate, write_motion, write_table

STONES, MOTIONS = 6, 100


def write_scan(path: Path, seed: int) -> None:
    """A stone of some 0.25 × 0.2 × 0.7 m with 2 500 vertices."""
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


def write_tests(folder: Path) -> list[dict[str, object]]:
    """The scans and motions of the table, and its rows, all of them still said to have stood."""
    stream = np.random.default_rng(1)
    for stone in range(STONES):
        write_scan(folder / f"stone{stone}.ply", stone)
    for motion in range(MOTIONS):
        amplitude, frequency = stream.uniform(1.0, 12.0), stream.uniform(1.0, 5.0)
        write_motion(folder / f"motion{motion}.csv", amplitude_m_s2=amplitude, frequency_hz=frequency, cycles=5)
    return [
        {"test": f"s{stone}m{motion}", "mesh": f"stone{stone}.ply", "motion": f"motion{motion}.csv", "column": "table",
         "motion_unit": "m/s2", "observed": "stands", "friction": 0.6, "duration_s": 8}
        for stone in range(STONES) for motion in range(MOTIONS)
    ]  # fmt: skip


def main() -> None:
    """Write the table, run it, print what it took and what came out."""
    parser = argparse.ArgumentParser()
    parser.add_argument("models", nargs="*", default=["analytic", "pymunk@dt=0.001", "pybullet@dt=0.001"])
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--jobs", type=int)
    asked = parser.parse_args()
    folder = asked.folder or Path(tempfile.mkdtemp(prefix="validation-"))
    folder.mkdir(parents=True, exist_ok=True)
    rows = write_tests(folder)
    out, table = folder / "out", folder / "tests.csv"
    first = validate(write_table(table, rows), out, models=asked.models[:1], jobs=asked.jobs, quiet=True)
    said = [result["predicted"][asked.models[0]] for result in first["rows"]]
    rows = [row | {"observed": outcome} for row, outcome in zip(rows, said, strict=True) if outcome in OBSERVED]
    print(json.dumps({"tests": len(said), "decided by the first model": len(rows)}))
    start = time.perf_counter()
    found = validate(write_table(table, rows), out, models=asked.models, jobs=asked.jobs, resume=True)
    print(json.dumps({"seconds": time.perf_counter() - start, "runs": found["runs"], "first_s": first["seconds"]}))
    print(json.dumps({"peak_memory_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0}))
    for name, model in found["models"].items():
        scores = model["outcomes"]
        told = {
            key: scores[key] for key in ("accuracy", "side_accuracy", "matthews", "within_uncertainty", "undecided")
        }
        print(name, model["failed"], json.dumps(told | {"probability": model["probability"]}))
    for pair in found["pairs"]:
        print(pair["a"], "and", pair["b"], json.dumps(pair["verdicts"]), pair["flips"])
    print("baseline", json.dumps(found["baseline"]["outcomes"]["accuracy"]), found["baseline"]["threshold_m_s"])


if __name__ == "__main__":
    main()
