"""How time and memory grow with duration, mesh vertices, number of runs and workers; each point in a fresh process."""

import math
import os
import resource
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from harness.accuracy.refinement import simulate
from harness.model import Finding, Scene, grouped, info
from harness.questions.bench.parts import cost, peak_memory_mb, processor_s
from harness.questions.bench.skips import written_study
from harness.questions.bench.standard_scenes import COLUMN, harmonic, scene_of
from harness.records.bench import ScalingRow
from harness.runs.runner import LIMIT_S, LocalPool
from harness.runs.task import call

Point = tuple[str, str, float]

DURATIONS_S: Final = (2.0, 8.0, 32.0)
VERTICES: Final = (16, 128, 1024)
RUNS: Final = (100, 1000, 10_000)
STUDY_RUNS: Final = 32
"""Runs of the study whose time is taken with one worker and with all."""


def tasks(quick: bool) -> list[str]:
    """The points that are timed by processor time, each named by its engine, quantity and value."""
    few = 1 if quick else None
    engines = ("analytic", "pymunk", "pybullet")
    points = [(engine, "duration_s", value) for engine in engines for value in DURATIONS_S[:few]]
    points += [(engine, "mesh_vertices", float(value)) for engine in engines for value in VERTICES[:few]]
    points += [("analytic", "runs", float(value)) for value in RUNS[:few]]
    return [f"{engine} {quantity} {value:g}" for engine, quantity, value in points]


def worker_tasks(quick: bool) -> list[str]:
    """The points that are timed by the clock: one worker, and all."""
    return [] if quick else [f"pymunk workers {value}" for value in sorted({1, os.cpu_count() or 1})]


def compute(task: str) -> list[ScalingRow]:
    """One point, in a process of its own, so that memory is that point's."""
    engine, quantity, value = task.split()
    point = engine, quantity, float(value)
    seconds, memory_mb, cpu_s = call(measure, (point,), timeout_s=LIMIT_S)
    return [ScalingRow(engine, quantity, point[2], seconds, memory_mb, cpu_s)]


def measure(point: Point) -> tuple[float, float, float]:
    """Seconds by the clock, peak memory in MB and processor seconds of one point."""
    engine, quantity, value = point
    if quantity == "workers":
        return _workers(int(value))
    if quantity == "runs":
        work = _ensemble(int(value))
    else:
        content = {"duration_s": value, "statue": COLUMN, "motion": harmonic(0.25, 2.0)}
        scene = _prism(int(value)) if quantity == "mesh_vertices" else scene_of("longer", content)
        work = partial(simulate, scene, engine)
    # Once before it is timed: what is compiled and loaded then is no run's.
    work()
    spent = cost(work, 3)
    return spent.wall_s, peak_memory_mb(), spent.cpu_s


def _prism(vertices: int) -> Scene:
    """A prism on a polygon of half so many corners, under a motion that makes it rock."""
    import trimesh

    angles = np.arange(vertices // 2) * (2.0 * np.pi / (vertices // 2))
    ring = 0.12 * np.column_stack([np.cos(angles), np.sin(angles)])
    bodies = [np.column_stack([ring, np.full(len(ring), z)]) for z in (0.0, 0.9)]
    with tempfile.TemporaryDirectory(prefix="rockcheck-bench-") as name:
        file = Path(name) / "prism.ply"
        trimesh.Trimesh(np.vstack(bodies)).convex_hull.export(file)
        mesh = {"file": str(file), "unit": "m", "density_kg_m3": 2700.0}
        return scene_of("prism", {"duration_s": 2.0, "statue": {"mesh": mesh}, "motion": harmonic(0.35, 2.0)})


def _ensemble(runs: int) -> Callable[[], object]:
    """So many outcomes of the analytic model, over amplitudes."""
    from analytic import ensemble
    from harness.model import block_of

    scene = scene_of("many", {"duration_s": 10.0, "statue": COLUMN, "motion": harmonic(0.25, 2.0)})
    sweep = {"amplitude_m_s2": np.linspace(0.1, 0.5, runs) * scene.gravity_m_s2}
    return partial(ensemble, block_of(scene), scene.base_excitation.x, sweep=sweep, duration_s=10.0, threads=1)


def _workers(jobs: int) -> tuple[float, float, float]:
    with written_study(STUDY_RUNS, "pymunk") as run, closing(LocalPool(jobs)) as pool:
        begin = time.perf_counter()
        run(pool)
        wall_s = time.perf_counter() - begin
    return wall_s, peak_memory_mb() + jobs * peak_memory_mb(resource.RUSAGE_CHILDREN), processor_s()


def findings(rows: Sequence[ScalingRow]) -> list[Finding]:
    """The power of each quantity with which time grows between its two largest values; of workers how much faster they are."""
    found = []
    asked = grouped(((row.engine, row.quantity), row) for row in rows)
    for (engine, quantity), mine in asked.items():
        if len(mine) < 2:
            continue
        less, more = sorted(mine, key=lambda row: row.value)[-2:]
        if quantity == "workers":
            times = less.wall_s / more.wall_s
            found.append(info("workers_faster", workers=more.value, fewer=less.value, times=times))
        else:
            times_s = [row.wall_s if row.cpu_s is None else row.cpu_s for row in (less, more)]
            power = math.log(times_s[1] / times_s[0]) / math.log(more.value / less.value)
            found.append(info("time_grows", power=power, quantity=quantity).of(engine))
    return found
