"""Real scans in pybullet beside a baseline loop of the same shapes: `python -m tests.measures.real_scans` prints times real time.

Maria under three components of a record, twice as strong as recorded so that it rocks, and a stone of 200 base vertices.
"""

import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
import pybullet
import trimesh

from harness import InputError, RunOptions, Scene, engines
from harness.engines.pybullet.run_phases import quiet_start_s
from harness.engines.pybullet.settings import BulletSettings
from harness.engines.pybullet.statue import Setup, prepare
from harness.engines.pybullet.world import World, reader
from harness.engines.stepping.trajectory import Schedule
from harness.questions.bench.standard_scenes import MESHES, record, scene_of

BEST_OF: Final = 3
TWICE: Final = 2.0
"""The record as it comes moves nothing."""
VERTICES: Final = 200
COLUMNS: Final = {"x": "a_90_ms2", "y": "a_0_ms2", "z": "a_UP_ms2"}


def shaken(title: str, file: str) -> Scene:
    """A scan under the record of `scenes/maria.toml`. Raises `InputError` without the data."""
    motion = {axis: record("coalinga1983_PFZ14.csv", column, scale=TWICE) for axis, column in COLUMNS.items()}
    mesh = {"file": file, "unit": "m", "density_kg_m3": 2700.0}
    content = {"duration_s": 40.0, "statue": {"mesh": mesh}, "contact": {"statue": 0.7}, "motion": motion}
    return scene_of(title, content)


def stone(folder: Path) -> str:
    """A stone that tapers upwards, on a regular polygon of `VERTICES` corners, written to `folder`."""
    angles = np.arange(VERTICES) * (2.0 * np.pi / VERTICES)
    ring = 0.12 * np.column_stack([np.cos(angles), np.sin(angles)])
    rings = [np.column_stack([share * ring, np.full(VERTICES, z)]) for z, share in ((0.0, 1.0), (0.9, 0.8))]
    file = folder / "stone.ply"
    trimesh.Trimesh(np.vstack(rings)).convex_hull.export(file)
    return str(file)


def measure() -> dict[str, float]:
    """Times real time by processor time of each scan at its step, and of a baseline loop of as many steps (needs the data)."""
    rates: dict[str, float] = {}
    with tempfile.TemporaryDirectory(prefix="rockcheck-bench-") as name:
        for title, dt_s, file in (
            ("Maria at 1 ms", 1e-3, f"{MESHES}/maria_acephalous.obj"),
            ("stone at 2 ms", 2e-3, stone(Path(name))),
        ):
            try:
                scene = shaken(title, file)
            except InputError:
                continue
            rates |= {f"{title}{what}": rate for what, rate in _rates(scene, dt_s).items()}
    return rates


def _rates(scene: Scene, dt_s: float) -> Mapping[str, float]:
    engine = engines.load("pybullet")
    level = engine.settings_for_dt(scene, dt_s)
    if not isinstance(level, BulletSettings):
        raise TypeError("pybullet's settings are wanted")
    setup, spent = prepare(scene), []
    for _ in range(BEST_OF):
        begin = time.process_time()
        run = engine.simulate(scene, level, RunOptions())
        spent.append(time.process_time() - begin)
    baseline_s = min(baseline_loop(scene, level, setup, run.steps) for _ in range(BEST_OF))
    return {", baseline loop": run.end_s / baseline_s, "": run.end_s / min(spent)}


def baseline_loop(scene: Scene, level: BulletSettings, setup: Setup, steps: int) -> float:
    """Processor seconds of so many of Bullet's own steps from where the motion begins to move something, with gravity and the
    statue's state read: the same shapes and settings, and nothing else."""
    first = int(quiet_start_s(scene, setup) / level.dt_s)
    gravity = Schedule(scene, level.dt_s, first, first + steps).coarse
    with World(level, setup) as world:
        world.build(scene)
        read, client = reader(world), world.client
        begin = time.process_time()
        for pull in gravity:
            pybullet.setGravity(*pull, client)
            pybullet.stepSimulation(client)
            read()
        return time.process_time() - begin


if __name__ == "__main__":
    for name, rate in measure().items():
        print(f"{name}: {rate:.1f} times real time")
