"""The page of a stress run (`harness/records/stress.py`): each engine's stability map, the hard scenes, the mutated inputs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from harness.records.stress import Cell, StressRecord
from reports.text.numbers import count_word
from reports.text.wording import Verdict

SIGNS: Final = {"stable": "●", "inaccurate": "◐", "drifting": "↗", "diverged": "✕"}


def context(_folder: Path, record: StressRecord) -> dict[str, object]:
    """Everything that the stress template shows."""
    engines = list(dict.fromkeys(cell.engine for cell in record.cells))
    return {
        "verdict": stress_verdict(record),
        "maps": [(engine, *stability_map(engine, record.cells), notes(engine, record.cells)) for engine in engines],
        "signs": SIGNS,
        "engines": list(dict.fromkeys(name for scene in record.scenes for name in scene.got)),
    }


def stress_verdict(record: StressRecord) -> Verdict:
    """How many hard scenes came out as they must, what the maps hold, what the mutated inputs did."""
    scenes = record.scenes
    wrong = [scene.name for scene in scenes if not scene.holds]
    counts = Counter(cell.category for cell in record.cells)
    unexplained = [cell for cell in record.cells if cell.unexplained]
    held = ", ".join(f"{counts[name]} {name}" for name in SIGNS if counts[name])
    points = [f"Cells of the stability maps: {held}."] if counts else []
    if unexplained:
        points.append(f"{len(unexplained)} cells of the maps that are not stable stand without an explanation.")
    points += [f"{name} was not run: {why}." for name, why in record.absent.items()]
    known = [scene.name for scene in scenes if scene.known]
    if known:
        points.append(f"Known failures, each with the setting that avoids it: {', '.join(known)}.")
    inputs, bad = sum(item.inputs for item in record.fuzz), sum(item.harm for item in record.fuzz)
    if inputs:
        points.append(f"Of {inputs} mutated inputs {bad} ended in a traceback, a hang or a half-written output.")
    left = [f"{part.part} ({len(part.left)} to do)" for part in record.parts if part.left]
    if left:
        points.append(f"Not measured yet: {', '.join(left)}.")
    if not scenes:
        return Verdict("No hard scene was run", "differ", points)
    if wrong:
        headline = f"{count_word(len(wrong)).capitalize()} of {len(scenes)} hard scenes did not come out as they must"
        return Verdict(headline, "failed", [*(f"Wrong: {name}." for name in wrong), *points])
    return Verdict(
        f"All {len(scenes)} hard scenes come out as they must",
        "differ" if unexplained or bad or left else "agree",
        points,
    )


def stability_map(engine: str, cells: Sequence[Cell]) -> tuple[list[str], list[tuple[str, list[Cell | None]]]]:
    """The settings across, and one row per difficulty with its cells (None: not tried)."""
    mine = [cell for cell in cells if cell.engine == engine]
    settings = list(dict.fromkeys(cell.setting for cell in mine))
    difficulties = list(dict.fromkeys(cell.difficulty for cell in mine))
    by_place = {(cell.difficulty, cell.setting): cell for cell in mine}
    return settings, [(row, [by_place.get((row, column)) for column in settings]) for row in difficulties]


def notes(engine: str, cells: Sequence[Cell]) -> list[str]:
    """Each explanation of an engine's map once, with the difficulty and the settings that it explains."""
    by_note: dict[tuple[str, str], list[str]] = {}
    for cell in cells:
        if cell.engine == engine and cell.explained:
            by_note.setdefault((cell.difficulty, cell.explained), []).append(cell.setting)
    return [f"{words}, {'; '.join(settings)}: {text}" for (words, text), settings in by_note.items()]
