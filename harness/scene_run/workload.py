"""What runs will take, told before they begin: seconds (to an order of magnitude) and memory; work without an end is refused."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from harness.accuracy.outlook import outgrows
from harness.accuracy.refinement import LONG_STEPS, START_SHARE, first_level, most_steps, second_level
from harness.campaign.progress import duration_words
from harness.engines import load
from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene

CERTIFIED_S: Final[Mapping[str, float]] = {"analytic": 6e-5, "spatial": 0.05}
"""Seconds of one core per second of motion of models that certify their own error: an order of magnitude."""
STEP_S: Final[Mapping[str, tuple[float, float]]] = {
    "pymunk": (1.1e-5, 1.7e-5),
    "pymunk:plain": (1.0e-5, 1.8e-5),
    "pybullet": (2.6e-5, 1.1e-4),
    "pybullet:plain": (1.0e-4, 5e-4),
}
"""Seconds of one core of a step of a contact engine, without and with a pedestal, on the statue of the shipped scenes."""
CALM_TIMES: Final = 4.2
"""Steps of a climb over those of its first level, where that and the run that checks it agree: both, and the third one."""
OUTGROWN_TIMES: Final = 1.7
"""Steps of a climb over those of its one whole run, where errors outgrow every level: 1.4 to 2.0 on the paper's conditions."""
ASKED_S: Final = 30.0
"""The model is asked of so much of a scene at most: what does not outgrow by then hardly does."""
AIM_RAD: Final = 1e-3
LONGEST_S: Final = 24 * 3600.0
"""Longer work is refused, or begun only when that is asked for."""
REPORTED_FROM_S: Final = 20.0
"""Work of less is not announced."""
COLUMNS: Final = {2: 5, 3: 16}
"""Columns of a history by an engine's dimensions."""
NUMBER_S: Final = 4e-6
NUMBER_BYTES: Final = 200
"""Each number of a history, from the engine to the page: 3.4 µs and 200 bytes at a million samples of any engine."""


def run_s(engine: str, scene: Scene, accuracy_rad: float | None = None, dt_s: float | None = None) -> float:
    """Roughly the seconds of one core that an engine takes for a scene, without what its history takes."""
    if engine in CERTIFIED_S:
        return CERTIFIED_S[engine] * scene.duration_s
    return _step_s(engine, scene) * expected_steps(engine, scene, accuracy_rad, dt_s)


def expected_steps(name: str, scene: Scene, accuracy_rad: float | None = None, dt_s: float | None = None) -> float:
    """Steps of all runs that a contact engine is expected to make of a scene, to a target or with an expert's own step."""
    if dt_s is not None:
        return scene.duration_s / dt_s
    target_rad, levels = accuracy_rad or AIM_RAD, load(name).refinement_levels(scene)
    first, index = first_level(levels, target_rad, START_SHARE)
    second = levels[second_level(levels, index)]
    asked = replace(scene, duration_s=min(scene.duration_s, ASKED_S))
    if scene.duration_s >= LONG_STEPS * second.dt_s and outgrows(asked, levels[-1].expected_error_rad, target_rad):
        return OUTGROWN_TIMES * scene.duration_s / second.dt_s
    return CALM_TIMES * scene.duration_s / first.dt_s


def _step_s(engine: str, scene: Scene) -> float:
    return STEP_S[engine][scene.pedestal is not None] if engine in STEP_S else 0.0


def numbers(scene: Scene, dimensions: Sequence[int]) -> float:
    """Numbers in the histories of engines of these dimensions."""
    return scene.duration_s / scene.output_dt_s * sum(COLUMNS[each] for each in dimensions)


def check(
    scene: Scene,
    engines: Mapping[str, int],
    where: str,
    accuracy_rad: float | None = None,
    dt_s: float | None = None,
    memory_bytes: float | None = None,
) -> str:
    """What runs of engines (their dimensions by name) will take, in words; empty where that is not worth a word.

    Raises `InputError` naming the key of what would take more than a day, or more memory than there is (`memory_bytes`, by
    default this machine's).
    """
    wanted = numbers(scene, list(engines.values()))
    there = _memory_bytes() if memory_bytes is None else memory_bytes
    if wanted * NUMBER_BYTES > there:
        got = (
            f"{scene.output_dt_s:g}: {scene.duration_s / scene.output_dt_s:.2g} samples of each model, "
            f"about {wanted * NUMBER_BYTES / 1e9:.2g} GB"
        )
        mistake = f"histories that the memory here holds ({there / 1e9:.2g} GB)"
        raise InputError(
            Mistake(where, "output.dt_s", mistake, got, "a longer step, a shorter duration_s, fewer engines")
        )
    spent = {name: run_s(name, scene, accuracy_rad, dt_s) for name in engines}
    writing_s = NUMBER_S * wanted
    total = sum(spent.values()) + writing_s
    if total > LONGEST_S:
        key = "duration_s" if dt_s is None else "--dt"
        advice = "a shorter motion, a coarser --accuracy or --dt, or fewer engines"
        raise InputError(
            Mistake(
                where, key, f"work of at most {duration_words(LONGEST_S)}", f"about {duration_words(total)}", advice
            )
        )
    most = (
        {} if dt_s is not None else {name: most_steps(load(name), scene, accuracy_rad or AIM_RAD) for name in engines}
    )
    if max(total, sum(_step_s(name, scene) * steps for name, steps in most.items())) < REPORTED_FROM_S:
        return ""
    parts = [
        f"{name} {duration_words(each)}" + (f" in at most {most[name]:.2g} steps" if most.get(name) else "")
        for name, each in spent.items()
        if each >= 1.0
    ]
    parts += (
        [f"the histories' {scene.duration_s / scene.output_dt_s:.2g} samples {duration_words(writing_s)}"]
        if writing_s >= 1.0
        else []
    )
    return f"this may take about {duration_words(total)} ({', '.join(parts)})"


def _memory_bytes() -> float:
    """This machine's memory, or what its container leaves of it."""
    memory_b = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    try:
        return min(memory_b, float(Path("/sys/fs/cgroup/memory.max").read_text(encoding="ascii")))
    except (OSError, ValueError):  # no such limit, or "max"
        return memory_b
