"""The page of one run: verdict, picture, replay, histories, outcomes, scores, limits, settings."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.model.run import MANY, EngineRunRecord
from harness.records.run import RunRecord
from reports.charts.histories import histories_figure, pattern_words
from reports.charts.palette import PATTERN_LOOKS, look
from reports.drawing.replay import default_model, replay_payload
from reports.drawing.scene_picture import scene_svg
from reports.messages import ENGLISH
from reports.pages.assets import source_text, three_js
from reports.source import RunSource, source_of
from reports.text.glossary import score_rows
from reports.text.limits import by_severity, fall_times, limit_rows, plan_rows, skipped_rows
from reports.text.wording import run_verdict


def context(folder: Path, record: RunRecord) -> dict[str, object]:
    """Everything that the run template shows."""
    source = source_of(folder, record)
    answered = [] if record.answer is None else [each.text for each in record.answer.findings]
    names, asked = list(source.runs), record.scene.toml.get("motion")
    return {
        "kind": "run",
        "verdict": run_verdict(source),
        "chips": [chip(name, names, run, balance_share(source, name)) for name, run in source.runs.items()],
        "picture": scene_svg(source.scene, record.motion.accel_m_s2, source.mesh),
        "motion_words": asked if isinstance(asked, dict) else {},
        "patterns": [
            {"words": words, "name": name, "colour": PATTERN_LOOKS[name][0]}
            for name, words in pattern_words(record.scene).items()
            if any(which == name for run in source.runs.values() for _, _, which in run.patterns)
        ],
        "replay": replay_values(source) if source.histories else None,
        "figure": histories_figure(source) if source.histories else None,
        "names": names,
        "score_rows": score_rows(record.scores),
        "validity": limit_rows(source),
        "fall": fall_times(source),
        "plan": plan_rows(record.plan),
        "skipped": skipped_rows(source.runs),
        "notes": by_severity(
            each for each in record.findings if not each.code.startswith("pair_") and each.text not in answered
        ),
        "toml": toml_text(source.scene.toml) if source.scene.toml else None,
        "command": command(source),
    }


def chip(
    name: str, names: list[str], run: EngineRunRecord | None = None, share: float | None = None
) -> dict[str, object]:
    """One model beside the verdict: its colour, and of its run outcome and largest lean, per cent of the balance angle."""
    said: dict[str, object] = {}
    if run is not None:
        outcome = ENGLISH.strings[f"short.{run.outcome.value}"]
        said = {"sentence": outcome, "labels": run.labels, "failed": run.outcome.failed}
        said["share"] = None if share is None else round(100.0 * share)
    return {"name": name, "colour": look(name, names).colour, "sentence": "", "labels": (), "failed": False, **said}


def balance_share(source: RunSource, name: str) -> float | None:
    """A model's largest lean as a share of the balance angle on its side; None without a history, and of a fall."""
    run, history = source.runs[name], source.histories.get(name)
    if history is None or run.outcome.overturned:
        return None
    statue = source.scene.statue
    right, left = (float((side * history.theta_rad).max()) / statue.slenderness_rad(side) for side in (1, -1))
    return max(right, left, 0.0)


def replay_values(source: RunSource) -> dict[str, object]:
    """What the replay's part of the page shows: the models, the packed data, what is drawn."""
    names = list(source.histories)
    solid = default_model(source)
    ghost = "analytic" if "analytic" in names and solid != "analytic" else ""
    return {
        "names": names,
        "solid": solid,
        "ghost": ghost,
        "own_mesh": source.mesh is not None,
        "data": replay_payload(source),
        "library": three_js(),
        "script": source_text("replay.js"),
    }


def command(source: RunSource) -> str:
    """The command that repeats the run (accuracy or step as the settings say)."""
    file = source.scene.file or "scene.toml"
    engines: Sequence[str] = [f"-e {name}" for name in source.runs]
    return f"rockcheck run {shlex.quote(file)} {' '.join(engines)}"


def toml_text(content: Mapping[str, object]) -> str:
    """TOML of nested mappings of strings, numbers, booleans and lists; keys without a value are left out, long lists counted."""
    import tomli_w

    return tomli_w.dumps(_stated(content))


def _stated(content: Mapping[str, object]) -> dict[str, object]:
    return {
        key: _stated(value) if isinstance(value, Mapping) else _counted(value)
        for key, value in content.items()
        if value is not None
    }


def _counted(value: object) -> object:
    """A value, of a long list its length: `result.json` has it whole."""
    return f"{len(value)} numbers" if isinstance(value, list) and len(value) > MANY else value
