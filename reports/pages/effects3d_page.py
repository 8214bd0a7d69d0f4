"""The page of an effects study: what the third dimension changes, by direction, against what a survey does not know."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Final

from harness.records.effects3d import BASELINE, EffectsRecord
from reports.drawing.effects_figures import changes, curves, directions, rose
from reports.drawing.scene_picture import scene_svg
from reports.messages import ENGLISH
from reports.pages.run_page import chip, replay_values
from reports.source import run_source
from reports.text.limits import by_severity
from reports.text.wording import Verdict

ROSE_WORDS: Final = (
    "Least peak acceleration of the floor that overturns the statue, by direction of shaking, in every model."
)
CHANGES_WORDS: Final = (
    "Change of the overturning amplitude under each condition, in per cent, one dot for each direction."
)


def context(folder: Path, record: EffectsRecord) -> dict[str, object]:
    """Everything that the template shows."""
    engines = record.engines
    source = run_source(folder / record.replay.folder) if record.replay else None
    replay = replay_values(source) if source is not None and source.histories else None
    return {
        "verdict": effects_verdict(record),
        "notes": by_severity(record.findings),
        "chips": [chip(name, engines) for name in engines],
        "picture": scene_svg(record.scene),
        "directions": source and directions(record, source),
        "rose": rose(record).svg(ROSE_WORDS),
        "keys": curves(record),
        "engines": engines,
        "peaks": {name: {row.azimuth_deg: row.peak_g for row in record.amplitudes(name, BASELINE)} for name in engines},
        "band_at": {row.azimuth_deg: row for row in record.bands},
        "falls": {
            row.azimuth_deg: row.outcome.removeprefix("overturned_")
            for row in record.amplitudes(record.solid_engine, BASELINE)
        },
        "changes": changes(record).svg(CHANGES_WORDS, style="min-width: 700px"),
        "effect_engines": list(dict.fromkeys(item.engine for item in record.effects)),
        "change": _change,
        "solid": record.solid_engine,
        "replay": replay,
        "chosen": record.replay,
        "replay_ends": record.replay
        and [f"{ENGLISH.word(end)} ({name})" for name, end in record.replay.outcomes.items()],
        "command": f"rockcheck study {shlex.quote(record.file)}",
    }


def effects_verdict(record: EffectsRecord) -> Verdict:
    """The record's answer; green where the planar model is nowhere too safe."""
    first, *points = [each.text for each in record.answer.findings] if record.answer else [""]
    safe = record.answer is not None and record.answer.code == "plane_safe"
    return Verdict(first, "agree" if safe else "differ", points)


def _change(relative: float | None) -> str:
    """A relative change in per cent with its sign."""
    if relative is None:
        return "–"
    text = f"{100.0 * relative:+.1f}"
    return f"{'0.0' if float(text) == 0.0 else text.replace('-', '−')} %"
