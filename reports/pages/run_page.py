"""The page of one run: verdict, picture, replay, histories, outcomes, scores, limits, settings."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final

from harness.model.scene import Initial
from harness.records.run import EngineRunRecord, RunRecord
from harness.records.scene import MotionRecord, SceneRecord
from harness.records.witness import sentences
from reports.charts.histories import histories_figure
from reports.charts.palette import PATTERN_LOOKS, look
from reports.charts.patterns import pattern_words
from reports.drawing.replay import default_model, replay_payload
from reports.drawing.scene_picture import scene_svg
from reports.pages.assets import source_text, three_js
from reports.source import RunSource, source_of
from reports.text.glossary import score_rows
from reports.text.limits import fall_sentence, limit_rows, plan_rows, skipped_rows
from reports.text.numbers import angle, digits, given, label, length, plain, short, unit
from reports.text.weights import weighed
from reports.text.wording import run_verdict

OUTCOME_ROWS: Final[Sequence[tuple[Callable[[EngineRunRecord], float | None], str, str]]] = (
    (lambda run: run.no_return_time_s, "passes its balance point for good", "s"),
    (lambda run: run.overturn_time_s, "counts as overturned", "s"),
    (lambda run: run.peak_theta_rad, "largest rotation", "rad"),
    (lambda run: run.peak_time_s, "at", "s"),
    (lambda run: run.peak_slip_m, "largest slip of the pedestal", "m"),
    (lambda run: run.residual_slip_m, "slip that remains", "m"),
    (lambda run: run.end_s, "computed until", "s"),
    (lambda run: run.numerical_uncertainty_rad, "numerical error of the rotation ±", "rad"),
    (lambda run: run.slip_uncertainty_m, "numerical error of the slip ±", "m"),
    (lambda run: run.reliable_until_s, "stated until", "s"),
    (lambda run: run.steps, "integration steps", ""),
    (lambda run: run.wall_s, "time to compute", "s"),
)


def context(folder: Path, record: RunRecord) -> dict[str, object]:
    """Everything that the run template shows."""
    source = source_of(folder, record)
    names = list(source.runs)
    return {
        "kind": "run",
        "verdict": run_verdict(source),
        "chips": [
            {
                "name": name,
                "colour": look(name, names).colour,
                "sentence": run.outcome_sentence,
                "labels": run.labels,
                "failed": run.outcome.failed,
            }
            for name, run in source.runs.items()
        ],
        "picture": scene_svg(source.scene, record.motion.accel_m_s2, source.mesh),
        "scene_rows": scene_rows(source),
        "motion_rows": motion_rows(record.motion, source.scene),
        "patterns": [
            {"words": words, "name": name, "colour": PATTERN_LOOKS[name][0]}
            for name, words in pattern_words(record.scene).items()
            if any(which == name for run in source.runs.values() for _, _, which in run.patterns)
        ],
        "replay": replay_values(source) if source.histories else None,
        "figure": histories_figure(source) if source.histories else None,
        "names": names,
        "outcome_rows": outcome_rows(source.runs),
        "pair_names": [pair.replace("_vs_", " – ") for pair in record.scores],
        "score_rows": score_rows(record.scores),
        "score_sentences": [
            (pair.replace("_vs_", " against "), scores.verdict, scores.verdict_sentence)
            for pair, scores in record.scores.items()
        ],
        "witness": sentences(record.witness or {}),
        "validity": limit_rows(source),
        "fall": fall_sentence(source),
        "plan": plan_rows(record.plan),
        "skipped": skipped_rows(source.runs),
        "notes": weighed([*record.warnings, *record.notes]) if record.warnings or record.notes else {},
        "settings": {
            name: [(label(k), plain(v)) for k, v in run.settings.items()] for name, run in source.runs.items()
        },
        "toml": toml_text(source.scene.toml) if source.scene.toml else None,
        "command": command(source),
    }


def replay_values(source: RunSource) -> dict[str, object]:
    """What the replay's part of the page shows: the models, the packed data, what is drawn."""
    names = list(source.histories)
    solid = default_model(source)
    ghost = "analytic" if "analytic" in names and solid != "analytic" else ""
    shape = (
        "the statue's own mesh"
        if source.mesh is not None
        else "a block with the statue's silhouette (the scene has no mesh)"
    )
    caption = (
        f"Drawn: {shape}, moved by each model's recorded rotation and slip, seen from the moving floor; the arrow is the "
        "floor's acceleration, the grid is 25 cm. Drag to turn; a click into the histories sets the time here."
    )
    return {
        "names": names,
        "solid": solid,
        "ghost": ghost,
        "caption": caption,
        "data": replay_payload(source),
        "library": three_js(),
        "script": source_text("replay.js"),
    }


def scene_rows(source: RunSource) -> list[tuple[str, str]]:
    """The scene in words and numbers."""
    scene = source.scene
    statue, pedestal, contact = scene.statue, scene.pedestal, scene.contact
    rows = [
        (
            "Statue",
            f"{given(statue.mass_kg, 'kg')}, {length(statue.height_m)} high, {length(statue.depth_m)} deep",
        ),
        ("Centroid", f"{length(statue.centroid_height_m)} above the base"),
        ("Inertia J", f"{unit(statue.inertia_kg_m2, 'kg m²', 4)} about the centroid"),
        (
            "Balances at",
            f"{angle(statue.slenderness_left_rad)} left, {angle(statue.slenderness_right_rad)} right",
        ),
    ]
    mesh = statue.mesh
    rows.append(("Mesh", "none: a block by its numbers" if mesh is None else f"{mesh.faces} faces"))
    if pedestal is None:
        rows.append(("Pedestal", "none: the statue stands on the floor"))
    else:
        size = f"{length(pedestal.width_m)} × {length(pedestal.depth_m)}, {length(pedestal.height_m)} high"
        rows.append(("Pedestal", f"{given(pedestal.mass_kg, 'kg')}, {size}"))
        friction = f"μₛ {short(contact.floor_static)}, μₖ {short(contact.floor_kinetic)}"
        rows.append(("Floor friction", friction))
    rows.append(("Statue friction", short(contact.statue)))
    law = contact.restitution
    rows.append(("Impact", "angular momentum" if law is None else f"prescribed ratio {short(law)}"))
    if scene.wall is not None:
        rows.append(("Wall", f"{scene.wall.side}, {length(scene.wall.distance_m)} from the base"))
    if scene.initial != Initial():
        rows.append(("Start", start_words(scene.initial)))
    return rows


def start_words(start: Initial) -> str:
    """How the statue begins: rotation and rate in the plane, or the centroid's place and velocities in space."""
    pose = start.pose
    if pose is None:
        return f"{unit(start.theta_rad, 'rad')}, {unit(start.theta_rate_rad_s, 'rad/s')}"
    parts = (
        (pose.position_m, "m"),
        (pose.quaternion_wxyz, "(w first)"),
        (pose.velocity_m_s, "m/s"),
        (pose.angular_velocity_rad_s, "rad/s"),
    )
    return "; ".join(f"({', '.join(short(value) for value in values)}) {name}" for values, name in parts)


def motion_rows(motion: MotionRecord, scene: SceneRecord) -> list[tuple[str, str]]:
    """What the floor does, by direction, in the scene file's own terms."""
    rows = []
    asked = scene.toml.get("motion")
    for axis, where in (("x", "in the rocking plane"), ("y", "across it"), ("z", "vertical")):
        if axis in motion.accel_m_s2:
            peak = motion.peak_m_s2(axis) / scene.gravity_m_s2
            sentence = plain(asked[axis]) if isinstance(asked, dict) and axis in asked else motion.words(axis)
            rows.append((f"Floor {axis}, {where}", f"peak {unit(peak, 'g')} — {sentence}"))
    return rows


def outcome_rows(runs: Mapping[str, EngineRunRecord]) -> list[tuple[str, list[str]]]:
    """The table of outcomes: one row per quantity, one cell per model."""
    rows = [("outcome", [run.outcome.replace("_", " ") for run in runs.values()])]
    for value_of, words, name in OUTCOME_ROWS:
        values = [value_of(run) for run in runs.values()]
        if all(value is None for value in values):
            continue
        heading = f"{words} [{name}]" if name else words
        rows.append((heading, [str(v) if isinstance(v, int) else digits(v, 4) for v in values]))
    rows.append(("impacts", [str(len(run.impact_times_s)) for run in runs.values()]))
    return rows


def command(source: RunSource) -> str:
    """The command that repeats the run (accuracy or step as the settings say)."""
    file = source.scene.file or "scene.toml"
    engines: Sequence[str] = [f"-e {name}" for name in source.runs]
    return f"rockcheck run {shlex.quote(file)} {' '.join(engines)}"


def toml_text(content: Mapping[str, object]) -> str:
    """TOML of nested mappings of strings, numbers, booleans and lists; keys without a value are left out."""
    import tomli_w

    return tomli_w.dumps(_stated(content))


def _stated(content: Mapping[str, object]) -> dict[str, object]:
    return {
        key: _stated(value) if isinstance(value, Mapping) else value
        for key, value in content.items()
        if value is not None
    }
