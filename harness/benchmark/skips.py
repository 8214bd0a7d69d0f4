"""What every skip gains and that it changes nothing: the same work with the skip on and off, on the real records."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness import engines
from harness.benchmark.scenes import COLUMN, PAESTUM, PEDESTAL, harmonic, record, scene_of
from harness.benchmark.timing import cost
from harness.engine import SKIPS, Engine, Settings, Want
from harness.errors import InputError
from harness.record import Run
from harness.scene import Scene
from harness.uncertainty import run_to_accuracy

Row = dict[str, Any]

RECORDS: Final = (
    ("elcentro1940_NS.csv", "a_NS_ms2", 31.18),
    ("coalinga1983_PFZ14.csv", "a_90_ms2", 64.98),
    ("kaikoura2016_WTMC.csv", "a_N28W_ms2", 69.98),
)
"""The records as they come, whole and without padding: file, column, duration in s."""
SHARES: Final = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Peak accelerations in units of the least g b/h: from nothing moves to overturning."""
ENGINE_SHARES: Final = (0.5, 1.5, 4.0)
ENGINE_ACCURACY_RAD: Final = 1e-2
"""What an outcome needs: a rung coarse enough for a study, not a history."""
GRAVITY_M_S2: Final = 9.81
ALL: Final = Want(history=False)
NONE: Final = Want(history=True, skips=frozenset())


def outcome_scenes(shares: Sequence[float]) -> Iterator[Scene]:
    """A block and the paper's statue under each record, scaled across overturning. Raises `InputError` without the records."""
    for file, column, duration in RECORDS:
        for name, statue in (("block", COLUMN), ("Paestum", PAESTUM)):
            limit = min(statue["corner_left_m"], statue["corner_right_m"]) / statue["centroid_height_m"]
            for share in shares:
                motion = {"x": record(file, column, pga_g=share * limit)}
                content = {"duration_s": duration, "statue": statue, "motion": motion}
                yield scene_of(f"{name}, {file.split('_')[0]}, {share:g} g b/h", content)


def together(quick: bool, told: Callable[[str], None]) -> Iterator[Row]:
    """All skips together on the outcome study, for each engine; the outcomes with and without must be the same."""
    for name, shares in (("analytic", SHARES), ("pymunk", ENGINE_SHARES), ("pybullet", ENGINE_SHARES)):
        if quick and name == "pybullet":
            continue
        told(f"skips: {name}")
        engine = engines.load(name)
        if engine.missing() is not None:
            continue
        scenes = list(outcome_scenes(shares[1:2] if quick else shares))
        yield _together(engine, scenes)


def _together(engine: Engine, scenes: Sequence[Scene]) -> Row:
    certifies = engine.capabilities.certifies
    simulate(engine, scenes[0], ALL)
    on_s = off_s = 0.0
    changed: list[str] = []
    unsettled: list[str] = []
    outcomes = set()
    for scene in scenes:
        kept: dict[bool, Run] = {}
        repeats = 3 if certifies else 1
        on_s += cost(partial(_keep, kept, engine, scene, True), repeats).cpu_s
        off_s += cost(partial(_keep, kept, engine, scene, False), repeats).cpu_s
        outcomes.add(kept[True].outcome.value)
        if kept[True].outcome is not kept[False].outcome:
            said = f"{scene.title}: {kept[True].outcome.value}, without skips {kept[False].outcome.value}"
            (unsettled if _unsettled(engine, scene, kept[False]) else changed).append(said)
    return {
        "skip": "all together", "engine": engine.name, "scenes": len(scenes), "on_s": on_s, "off_s": off_s,
        "gain": off_s / on_s, "same": not changed, "changed": changed, "unsettled": unsettled, "outcomes": sorted(outcomes),
    }  # fmt: skip


def _unsettled(engine: Engine, scene: Scene, run: Run) -> bool:
    """Whether the engine's own finer settings, without any skip, end otherwise: then this rung decides nothing here."""
    if engine.capabilities.certifies:
        return False
    probes = engine.probes(scene, _rung(engine, scene))
    return any(engine.simulate(scene, probe, NONE).outcome is not run.outcome for probe in probes)


def _rung(engine: Engine, scene: Scene) -> Settings:
    ladder = engine.ladder(scene)
    return next((item for item in ladder if item.expected_error_rad <= ENGINE_ACCURACY_RAD), ladder[-1])


def _keep(kept: dict[bool, Run], engine: Engine, scene: Scene, skip: bool) -> None:
    kept[skip] = simulate(engine, scene, ALL if skip else NONE)


def simulate(engine: Engine, scene: Scene, want: Want) -> Run:
    """One run of the outcome study: certified, or on the rung that an outcome needs."""
    if engine.capabilities.certifies:
        return run_to_accuracy(engine, scene, 1e-3, want)
    return engine.simulate(scene, _rung(engine, scene), want)


def single(told: Callable[[str], None]) -> Iterator[Row]:
    """Each skip alone on a scene where it applies: its gain, and whether the result is the same."""
    file, column, duration = RECORDS[1]
    motion = {"x": record(file, column, pga_g=0.3)}
    real = scene_of("Coalinga", {"duration_s": duration, "statue": COLUMN, "motion": motion})
    fell = scene_of(
        "falls", {"duration_s": duration, "statue": COLUMN, "motion": {"x": record(file, column, pga_g=2.0)}}
    )
    short = {"x": {"kind": "pulse", "shape": "one_sine", "amplitude_g": 0.28, "duration_s": 0.5}}
    pulse = scene_of("pulse", {"duration_s": 20.0, "statue": COLUMN, "motion": short})
    on_pedestal = {"duration_s": 2.0, "statue": PAESTUM, "pedestal": PEDESTAL, "motion": harmonic(0.3, 3.0)}
    stand = scene_of("on a pedestal", on_pedestal)
    cases = (
        ("quiet_start", "analytic", real), ("quiet_start", "pymunk", real),
        ("quiet_end", "analytic", pulse), ("quiet_end", "pymunk", pulse), ("quiet_end", "pybullet", pulse),
        ("energy_outcome", "analytic", pulse), ("no_history", "analytic", real),
        ("base_only", "pybullet", stand), ("stop_at_overturn", "pymunk", fell),
    )  # fmt: skip
    for skip, name, scene in cases:
        told(f"skip {skip}: {name}")
        yield _single(skip, engines.load(name), scene)
    yield from (_imports(), _cached(), _planar(pulse))


def _single(skip: str, engine: Engine, scene: Scene) -> Row:
    history = skip not in ("energy_outcome", "no_history")
    # The history itself is what `no_history` leaves out: its other side is the run that keeps it.
    on = Want(history=history)
    off = Want(history=True) if skip == "no_history" else Want(history=history, skips=frozenset(SKIPS) - {skip})
    first, second = simulate(engine, scene, on), simulate(engine, scene, off)
    on_s = cost(lambda: simulate(engine, scene, on), 3).cpu_s
    off_s = cost(lambda: simulate(engine, scene, off), 3).cpu_s
    apart = abs(first.peak_theta_rad - second.peak_theta_rad)
    if first.history is not None and second.history is not None:
        times = np.linspace(0.0, min(first.end_s, second.end_s), 4000)
        apart = float(np.max(np.abs(first.history.at(times) - second.history.at(times))))
    return {
        "skip": skip, "engine": engine.name, "scenes": 1, "on_s": on_s, "off_s": off_s, "gain": off_s / on_s,
        "same": first.outcome is second.outcome or _unsettled(engine, scene, second),
        "changed": [], "apart_rad": apart, "steps": [first.steps, second.steps],
    }  # fmt: skip


def _imports() -> Row:
    """Seconds of processor time to be ready to answer `--help`, against importing all simulators as well."""
    lazy = "import reports.cli"
    eager = lazy + "\nfrom harness.engines import REGISTRY, load\nfor name in REGISTRY: load(name).missing()"
    on_s, off_s = _fresh_s(lazy), _fresh_s(eager)
    return {
        "skip": "lazy_engines", "engine": "*", "scenes": 1, "on_s": on_s, "off_s": off_s, "gain": off_s / on_s,
        "same": True, "changed": [],
    }  # fmt: skip


def _fresh_s(code: str) -> float:
    """Least processor time of a fresh interpreter over three tries."""
    tail = "\nimport time; print(time.process_time())"
    tries = [subprocess.run([sys.executable, "-c", code + tail], capture_output=True, text=True) for _ in range(3)]
    return min(float(done.stdout.split()[-1]) for done in tries)


def _cached() -> Row:
    """A study of sixteen runs, then the same study again from its store."""
    from harness.executors import LocalPool
    from harness.store import Store
    from harness.study import run_study
    from harness.study_file import load_study

    with tempfile.TemporaryDirectory(prefix="rockcheck-bench-") as name:
        folder = Path(name)
        (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
        (folder / "study.toml").write_text(STUDY, encoding="utf-8")
        path = folder / "study.toml"
        study = load_study(path)
        with Store(folder / "store.sqlite") as store:
            seen = []

            def work() -> None:
                seen.append(run_study(study, path, store, LocalPool(1)))

            off_s, on_s = cost(work, 1).wall_s, cost(work, 3).wall_s
    again = seen[-1]
    return {
        "skip": "cached", "engine": "analytic", "scenes": seen[0].wanted, "on_s": on_s, "off_s": off_s,
        "gain": off_s / on_s, "same": again.computed == 0 and again.found == again.distinct, "changed": [],
    }  # fmt: skip


SCENE: Final = """
title = "block"
duration_s = 5.0
[statue]
mass_kg = 300.0
centroid_height_m = 0.5
corner_left_m = 0.1
corner_right_m = 0.1
inertia_kg_m2 = 26.0
[motion.x]
kind = "harmonic"
amplitude_g = 0.3
frequency_hz = 2.0
"""
STUDY: Final = """
title = "sixteen"
scene = "scene.toml"
[[vary]]
key = "motion.x.amplitude_g"
start = 0.2
stop = 0.5
count = 16
[[variant]]
name = "block"
engines = ["analytic"]
"""


def _planar(scene: Scene) -> Row:
    """A planar question answered in the plane, against the same in three dimensions."""
    flat, solid = engines.load("pymunk"), engines.load("pybullet")
    first, second = run_to_accuracy(flat, scene, 1e-3, ALL), run_to_accuracy(solid, scene, 1e-3, ALL)
    on_s = cost(lambda: run_to_accuracy(flat, scene, 1e-3, ALL), 3).cpu_s
    off_s = cost(lambda: run_to_accuracy(solid, scene, 1e-3, ALL), 2).cpu_s
    return {
        "skip": "planar", "engine": "pymunk for pybullet", "scenes": 1, "on_s": on_s, "off_s": off_s,
        "gain": off_s / on_s, "same": first.outcome is second.outcome, "changed": [],
        "apart_rad": abs(abs(first.peak_theta_rad) - abs(second.peak_theta_rad)),
    }  # fmt: skip


def rows(quick: bool, told: Callable[[str], None]) -> list[Row]:
    """All rows; without the records one row says so."""
    try:
        found = list(together(quick, told))
        return found if quick else [*found, *single(told)]
    except InputError as error:
        return [{"skip": "all together", "engine": "*", "failed": str(error)}]
