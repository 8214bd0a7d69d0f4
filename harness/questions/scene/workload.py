"""What runs will take, told before they begin: processor time and memory; work without an end is refused."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from harness.accuracy.forecast import (
    CERTIFIED_S,
    START_S,
    Range,
    first_settings,
    moving_s,
    run_s,
    worth_a_process,
)
from harness.model import Scene, require
from harness.questions.scene.left_out import TAKEN_AWAY
from harness.questions.scene.witness import BUDGET, plain_names
from harness.records.run import PLAIN
from harness.runs.progress import duration_words, forecast_words

HORIZON_RUNS: Final = 17
"""Runs by which a model's horizon is found: of four sizes four perturbations each."""
RESULT_S: Final = 2.2
"""To score the pairs, to write the result and its pages."""
CAUSE_SHARE: Final = 0.3
"""Of a climb in space its last run once more, up to where it is known: so much for each thing that the plane leaves out, where
a difference is found."""
LONGEST_S: Final = 24 * 3600.0
"""Longer work is refused, or begun only when that is asked for."""
REPORTED_FROM_S: Final = 20.0
"""Work that takes less at most is not announced."""
COLUMNS: Final = {2: 5, 3: 16}
"""Columns of a history by an engine's dimensions."""
NUMBER_S: Final = 2.5e-6
NUMBER_BYTES: Final = 200
"""Each number of a history, from the engine to the page: 1.6 to 3.4 µs, and 200 bytes."""


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
    *,
    assess: bool = False,
    witness: bool = False,
    horizon: bool = False,
    spent_s: float = 0.0,
) -> str:
    """What a run with engines (their dimensions by name) will take, in words; empty where that is not worth a word.

    `spent_s` of processor time are spent already. Counted are also the probability, the witness and the horizons that are asked,
    and the runs that find what the plane leaves out; a finer run is not, for few scenes need one.
    Raises `InputError` naming the key of what would take more than a day, or more memory than there is (`memory_bytes`, by
    default this machine's).
    """
    wanted = numbers(scene, list(engines.values()))
    there = _memory_bytes() if memory_bytes is None else memory_bytes
    require(
        wanted * NUMBER_BYTES <= there,
        where,
        f"histories that the memory here holds ({there / 1e9:.2g} GB)",
        f"{scene.output_dt_s:g}: {scene.duration_s / scene.output_dt_s:.2g} samples of each model, "
        f"about {wanted * NUMBER_BYTES / 1e9:.2g} GB",
        "a longer step, a shorter duration_s, fewer engines",
        key="output.dt_s",
    )
    runs = {name: run_s(name, scene, accuracy_rad, dt_s) for name in engines}
    in_space = {name for name, dimensions in engines.items() if dimensions == 3 and len(engines) > 1}
    beside = {name for name in in_space if worth_a_process(name, runs[name])}
    apart = [each.and_also(START_S) for name, each in runs.items() if name in beside]
    asked = [
        BUDGET * each.least for name, each in runs.items() if witness and name + PLAIN in plain_names(list(engines))
    ]
    asked += [
        HORIZON_RUNS * (run_s(name, scene, dt_s=first_settings(name, scene, accuracy_rad, dt_s).dt_s).least)
        for name in engines
        if horizon and name not in CERTIFIED_S
    ]
    asked += [HORIZON_RUNS * runs[name].least for name in engines if name in CERTIFIED_S and len(engines) > 1]
    stepped = in_space - CERTIFIED_S.keys() if 2 in engines.values() else ()
    causes = sum(take(scene) is not None for take in TAKEN_AWAY.values()) if stepped else 0
    known = [Range(0.0, CAUSE_SHARE * causes * runs[name].most) for name in stepped]
    if assess:
        from harness.questions.assess.probability import assessed_s  # else not loaded

        asked.append(assessed_s(scene))
    written = Range(*moving_s(scene)).times(NUMBER_S * wanted / scene.duration_s)
    own = written.and_also(
        spent_s, RESULT_S, *asked, *known, *(each for name, each in runs.items() if name not in beside)
    )
    total = own.and_also(*apart)
    require(
        total.middle <= LONGEST_S,
        where,
        f"work of at most {duration_words(LONGEST_S)}",
        forecast_words(*total),
        "a shorter motion, a coarser --accuracy or --dt, or fewer engines",
        key="duration_s" if dt_s is None else "--dt",
    )
    if total.most < REPORTED_FROM_S:
        return ""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    longest = Range(*map(max, zip(own, *apart, strict=True))) if apart else own
    clock = longest if cores > len(apart) else Range(*(max(a / cores, b) for a, b in zip(total, longest, strict=True)))
    return (
        f"this takes {forecast_words(*total)} of processor time, {forecast_words(*clock)} by the clock (cores: {cores})"
    )


def _memory_bytes() -> float:
    """This machine's memory, or what its container leaves of it."""
    memory_b = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    try:
        return min(memory_b, float(Path("/sys/fs/cgroup/memory.max").read_text(encoding="ascii")))
    except (OSError, ValueError):  # no such limit, or "max"
        return memory_b
