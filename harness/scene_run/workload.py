"""What runs will take, told before they begin: seconds (to an order of magnitude) and memory; work without an end is refused."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from harness.accuracy.refinement import most_steps
from harness.campaign.progress import duration_words
from harness.engines import load
from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene

SECONDS: Final[Mapping[str, tuple[float, float]]] = {
    "analytic": (6e-5, 6e-5),
    "pymunk": (0.08, 0.08),
    "pybullet": (0.06, 0.5),
    "spatial": (0.05, 0.05),
}
"""Seconds of one core per second of motion to 1e-3 rad, without and with a pedestal: an order of magnitude (docs/studies.md)."""
STEP_S: Final = 5e-5
"""A step of a contact engine by the expert's own step: what these seconds are at steps of a millisecond or so."""
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
    each = SECONDS.get(engine.split(":")[0], max(SECONDS.values()))[scene.pedestal is not None] * scene.duration_s
    if engine == "analytic":
        return each
    if dt_s is not None:
        return STEP_S * scene.duration_s / dt_s
    # The contact engines' errors fall about in proportion to their steps, of which the finest is some thirty times the coarsest.
    return each * min(max(AIM_RAD / (accuracy_rad or AIM_RAD), 1.0), 30.0)


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
    if max(total, STEP_S * sum(most.values())) < REPORTED_FROM_S:
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
