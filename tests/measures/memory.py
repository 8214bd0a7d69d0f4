"""What contact engines keep: memory over a thousand runs in one process, place over a minute at rest.

`python -m tests.measures.memory memory|creep [ENGINE...]` prints the rows of either.
"""

from __future__ import annotations

import gc
import json
import resource
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness import engines
from harness.engines.base import Engine, Settings
from harness.model.run import RunOptions
from tests.measures.contact_engines import paper_scene

RUNS: Final = (100, 1000)
"""Runs after which the resident memory is read."""
SHORT_S: Final = 0.05
STEP_S: Final = 1e-3
REST_S: Final = 60.0
MOST_STEPS: Final = 60_000
"""A finer level rests for so many steps only; its creep is multiplied up to a minute."""
SETTLED: Final = 1.0 / 3.0
"""Share of a rest in which the contact's first penetration settles."""
PLACES: Final = ("slip_m", "statue_y_m", "corner_right_x_m")
TURNS: Final = ("theta_rad", "yaw_rad", "out_of_plane_rad", "pedestal_tilt_rad")
NOTHING_SKIPPED: Final = RunOptions(skips=frozenset())
HALF: Final = RunOptions(skips=frozenset({"base_only", "mirror"}))
"""Half of a scene that is its own mirror image, where an engine computes that; every step of it."""


def resident_kib() -> float:
    """Resident memory of this process now, KiB (Linux; the largest so far elsewhere)."""
    gc.collect()
    status = Path("/proc/self/statm")
    if not status.exists():
        return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    return int(status.read_text(encoding="ascii").split()[1]) * resource.getpagesize() / 1024.0


def memory(engine: Engine, counts: Sequence[int] = RUNS) -> dict[str, Any]:
    """Resident memory, KiB, after each of the growing `counts` of runs: floor, pedestal and two frictions in turn."""
    kinds = ((False, 0.15), (True, 0.15), (True, 0.20))
    scenes = [paper_scene(0.429, 3.0, pedestal=on, static=mu, duration_s=SHORT_S) for on, mu in kinds]
    row: dict[str, Any] = {"engine": engine.name}
    for number in range(1, counts[-1] + 1):
        scene = scenes[number % len(scenes)]
        engine.simulate(scene, engine.settings_for_dt(scene, STEP_S), NOTHING_SKIPPED)
        if number in counts:
            row[f"kib_after_{number}"] = resident_kib()
    grown = row[f"kib_after_{counts[-1]}"] - row[f"kib_after_{counts[0]}"]
    return {**row, "kib_a_run": grown / (counts[-1] - counts[0])}


def creep(engine: Engine) -> Iterator[dict[str, Any]]:
    """Largest change of place, m, and of rotation, rad, over a minute at rest, for each level, on the floor and on a pedestal.

    For an engine with the skip `mirror` with it (`half`) and without.
    """
    kinds = (HALF, NOTHING_SKIPPED) if "mirror" in engine.capabilities.skips else (NOTHING_SKIPPED,)
    for pedestal in (False, True):
        for options in kinds:
            for level in engine.refinement_levels(paper_scene(0.0, 1.0, pedestal=pedestal, static=0.15)):
                about = {"engine": engine.name, "pedestal": pedestal, "half": options is HALF}
                yield {**about, **_rest(engine, level, pedestal, options)}


def _rest(engine: Engine, level: Settings, pedestal: bool, options: RunOptions) -> dict[str, Any]:
    long_s = min(REST_S, MOST_STEPS * level.dt_s)
    scene = paper_scene(0.0, 1.0, pedestal=pedestal, static=0.15, duration_s=long_s)
    history = engine.simulate(scene, level, options).history
    if history is None:
        raise RuntimeError(f"{engine.name} kept no history")
    columns = history.columns()
    late = history.t_s >= SETTLED * long_s
    factor = REST_S / ((1.0 - SETTLED) * long_s)
    found = {name: factor * float(np.ptp(columns[name][late])) for name in (*PLACES, *TURNS) if name in columns}
    return {
        "dt_s": level.dt_s,
        "expected_error_rad": level.expected_error_rad,
        "rested_s": long_s,
        "creep_m": max(value for name, value in found.items() if name in PLACES),
        "creep_rad": max(value for name, value in found.items() if name in TURNS),
    }


def main(arguments: Sequence[str]) -> None:
    """Print a line of JSON for each row."""
    what, *names = arguments
    rows: dict[str, Callable[[Engine], Iterator[dict[str, Any]]]] = {
        "memory": lambda engine: iter([memory(engine)]),
        "creep": creep,
    }
    for name in names or ("pymunk", "pybullet"):
        for row in rows[what](engines.load(name)):
            sys.stdout.write(json.dumps(row) + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
