"""The page of a stress run (`harness/records/stress.py`): each engine's stability map, the hard scenes, the mutated inputs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from harness.records.stress import Cell, StressRecord
from reports.charts import Json
from reports.charts.palette import INK
from reports.text.limits import by_severity
from reports.text.wording import Verdict

SIGNS: Final = {"stable": "●", "inaccurate": "◐", "drifting": "↗", "diverged": "✕"}
SHADES: Final = ("#bfe0ee", "#f8e1b8", "#E69F00", "#c8562d")
"""Of each sign on paper, where its word stands in the cell too."""


def context(_folder: Path, record: StressRecord) -> dict[str, object]:
    """Everything that the stress template shows."""
    engines = list(dict.fromkeys(cell.engine for cell in record.cells))
    return {
        "verdict": stress_verdict(record),
        "notes": by_severity(record.findings),
        "maps": [(engine, *stability_map(engine, record.cells), notes(engine, record.cells)) for engine in engines],
        "signs": SIGNS,
        "charts": [stability_chart(engine, record.cells) for engine in engines],
        "engines": list(dict.fromkeys(name for scene in record.scenes for name in scene.got)),
    }


def stress_verdict(record: StressRecord) -> Verdict:
    """How many hard scenes came out as they must."""
    text, code = ("", "open") if record.answer is None else (record.answer.text, record.answer.code)
    return Verdict(text, {"wrong": "failed", "sound": "agree"}.get(code, "differ"), [])


def stability_map(engine: str, cells: Sequence[Cell]) -> tuple[list[str], list[tuple[str, list[Cell | None]]]]:
    """The settings across, and one row per difficulty with its cells (None: not tried)."""
    mine = [cell for cell in cells if cell.engine == engine]
    settings = list(dict.fromkeys(cell.setting for cell in mine))
    difficulties = list(dict.fromkeys(cell.difficulty for cell in mine))
    by_place = {(cell.difficulty, cell.setting): cell for cell in mine}
    return settings, [(row, [by_place.get((row, column)) for column in settings]) for row in difficulties]


def stability_chart(engine: str, cells: Sequence[Cell]) -> tuple[str, str, Json]:
    """The map for print, where a page has its table: name, title and figure."""
    settings, rows = stability_map(engine, cells)
    known = list(SIGNS)
    levels = [[math.nan if cell is None else known.index(cell.category) for cell in row] for _, row in rows]
    trace = {
        "type": "heatmap", "x": settings, "y": [words for words, _ in rows], "z": levels, "zmin": 0, "zmax": len(known) - 1,
        "colorscale": [[k / (len(known) - 1), shade] for k, shade in enumerate(SHADES)], "showscale": False,
    }  # fmt: skip
    words = [
        {"x": setting, "y": difficulty, "text": cell.category, "font": {"color": INK}, "showarrow": False}
        for difficulty, row in rows
        for setting, cell in zip(settings, row, strict=True)
        if cell is not None
    ]
    layout = {"height": 90 + 44 * len(rows), "annotations": words, "yaxis": {"autorange": "reversed"}}
    return (
        f"stability-{engine.replace(':', '-')}",
        f"{engine}: what becomes of hard scenes, by setting",
        {"data": [trace], "layout": layout},
    )


def notes(engine: str, cells: Sequence[Cell]) -> list[str]:
    """Each explanation of an engine's map once, with the difficulty and the settings that it explains."""
    by_note: dict[tuple[str, str], list[str]] = {}
    for cell in cells:
        if cell.engine == engine and cell.explained:
            by_note.setdefault((cell.difficulty, cell.explained), []).append(cell.setting)
    return [f"{words}, {'; '.join(settings)}: {text}" for (words, text), settings in by_note.items()]
