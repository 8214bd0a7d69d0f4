"""The page of one run: verdict, replay, histories, each model's answer, the scene; scores, limits and settings folded away."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np

from harness.model import MANY, RUN_FIELDS, SOLID_COLUMNS, Array, History, Run
from harness.records.run import RunRecord, balance_share, outside_domain
from harness.records.scene import MotionRecord, SceneRecord
from reports.blocks import (
    Block,
    Chart,
    Chip,
    Details,
    Drawing,
    Facts,
    Group,
    Replay,
    Table,
    Text,
    command_line,
    facts,
    notes,
    repeat,
    section,
    turned,
    words,
)
from reports.charts.figure import look
from reports.charts.histories import histories_figure, packed_array
from reports.drawing import kinematics
from reports.drawing.pictures import scene_svg
from reports.messages import Language
from reports.pages.assets import packed_json, three_js
from reports.source import RunSource, run_event_s, source_of
from reports.text.wording import limits, plan_lines, run_verdict, score_rows

ANSWERS: Final = [
    *(each.name for each in RUN_FIELDS if each.single and each.name not in ("engine", "message")),
    "impacts",
]
"""What the table of models holds of each."""


def blocks(folder: Path, record: RunRecord, say: Language) -> list[Block]:
    """The blocks of a run's page."""
    source = source_of(folder, record)
    names = list(source.runs)
    chips = [chip(name, names, run, say, _balance_share(source, name)) for name, run in source.runs.items()]
    first = run_verdict(source, chips, say)
    answered = [] if record.answer is None else [each.text for each in record.answer.findings]
    told = [each for each in record.findings if not each.code.startswith("pair_") and each.text not in answered]
    pairs = [
        (f"{each.a} – {each.b}", each.verdict_sentence) for each in record.scores.values() if each.verdict_sentence
    ]
    # A run that never began has no largest rotation of nought.
    stands_on = source.scene.pedestal
    begun = [
        dict.fromkeys(ANSWERS) | {"outcome": run.outcome} if run.outcome.failed and not run.end_s else run
        for run in source.runs.values()
    ]
    models = turned(say, "answers", names, [each for each in ANSWERS if stands_on or "slip" not in each], begun, 4)
    return [
        Group("beginning", [first, replay(source, chips)]) if source.histories else first,
        *(section(say, "histories", *_histories(source, say)) if source.histories else ()),
        *section(say, "outcomes", Details(models.caption, [models], fold=True)),
        *section(say, "pairs", Facts(pairs, "sentences") if pairs else None),
        *section(say, "notes", *notes(say, told)),
        *section(say, "scene", _scene(source, say)),
        *section(say, "details", *_details(source, say)),
    ]


def _histories(source: RunSource, say: Language) -> list[Block]:
    """The histories of all models."""
    drawn = Chart("histories", say("text.histories_chart"), histories_figure(source, say), 1060, "time")
    return [drawn, words(say, "histories", "caption")]


def _scene(source: RunSource, say: Language) -> Group:
    """The scene's picture, its numbers and its motion."""
    scene, motion = source.scene, source.record.motion
    statue, stone, contact, start, wall = scene.statue, scene.pedestal, scene.contact, scene.initial, scene.wall
    pose, asked = start.pose, scene.toml.get("motion")
    posed = pose and (pose.position_m, pose.quaternion_wxyz, pose.velocity_m_s, pose.angular_velocity_rad_s)
    pairs = {
        "statue": say(
            "text.statue", mass=say.given(statue.mass_kg, "kg"), height=say.length(statue.height_m),
            depth=say.length(statue.depth_m),
        ),
        "centroid": say("text.above_base", height=say.length(statue.centroid_height_m)),
        "inertia": say("text.about_centroid", inertia=say.unit(statue.inertia_kg_m2, "kg m²", 4)),
        "balances_at": say(
            "text.balances", left=say.value(statue.slenderness_left_rad, "angle"),
            right=say.value(statue.slenderness_right_rad, "angle"),
        ),
        "mesh": say("text.no_mesh") if statue.mesh is None else say("text.faces", count=statue.mesh.faces),
        "stone": say("text.no_pedestal") if stone is None else say(
            "text.pedestal", mass=say.given(stone.mass_kg, "kg"), width=say.length(stone.width_m),
            depth=say.length(stone.depth_m), height=say.length(stone.height_m),
        ),
        "floor_friction": stone and f"μₛ {say.short(contact.floor_static)}, μₖ {say.short(contact.floor_kinetic)}",
        "statue_friction": say.short(contact.statue),
        "impact": say("text.momentum") if contact.restitution is None else say(
            "text.prescribed", ratio=say.short(contact.restitution)
        ),
        "wall": wall and say("text.wall", side=say(f"side.{wall.side}"), distance=say.length(wall.distance_m)),
        "start": (start.theta_rad or start.theta_rate_rad_s or None) and f"{say.unit(start.theta_rad, 'rad')}, "
        f"{say.unit(start.theta_rate_rad_s, 'rad/s')}",
        "start_pose": posed and "; ".join(
            f"({say.row([*map(say.short, values)])}) {name}"
            for values, name in zip(posed, ("m", "(w, x, y, z)", "m/s", "rad/s"), strict=True)
        ),
    }  # fmt: skip
    pushes = {
        f"floor_{axis}": say(
            "text.floor", peak=say.unit(motion.peak_m_s2(axis) / scene.gravity_m_s2, "g"),
            words=say.plain(asked[axis]) if isinstance(asked, dict) and axis in asked else motion.words(axis),
        )
        for axis in motion.accel_m_s2
    }  # fmt: skip
    told = [facts(say, each, style) for each, style in ((pairs, ""), (pushes, "motion")) if each]
    picture = Drawing(scene_svg(scene, say, motion.accel_m_s2, source.mesh), [say("text.scene")])
    return Group("split", [picture, Details(say("text.scene_numbers"), told, fold=True)])


def _details(source: RunSource, say: Language) -> list[Block]:
    """Scores, limits, what was left out, settings, how to repeat it: each folded away."""
    record = source.record
    met = {name: facts(say, limits(run, source.histories.get(name), say)) for name, run in source.runs.items()}
    known = [Group("", [each], name) for name, each in met.items() if each.pairs]
    rows = score_rows(record.scores, say)
    scores = Table(say("table.scores"), ["", *(f"{each.a} – {each.b}" for each in record.scores.values())], rows)
    settings = Group("columns", [Group("", [facts(say, run.settings)], name) for name, run in source.runs.items()])
    command = command_line("run", source.scene.file or "scene.toml", *(record.asked or ()), e=[*source.runs])
    again = [command, *as_run(source.scene, say)]
    made = repeat(say, record)[0].blocks
    return [
        *([Details(say("section.scores"), [scores], "scores")] if rows else ()),
        *([Details(say("text.limits"), [Group("columns", known)], "limits")] if known else ()),
        Details(say("text.left_out"), [Text(plan_lines(record, say), "plan")], "skips"),
        Details(say("text.settings"), [settings]),
        Details(say("section.repeat"), [Text(again, "command")], "repeat"),
        *made,
    ]


def chip(name: str, names: list[str], run: Run | None, say: Language, share: float | None = None) -> Chip:
    """One model beside the verdict: its colour, and of its run outcome and largest lean, per cent of the balance angle."""
    colour = look(name, names).colour
    if run is None:
        return Chip(name, colour)
    percent = None if share is None else round(100.0 * share)
    outcome = say(f"short.{run.outcome.value}")
    told = f"({outcome})" if outside_domain(run) else outcome
    return Chip(name, colour, told, [*map(say.word, run.labels)], run.outcome.failed, percent)


def _balance_share(source: RunSource, name: str) -> float | None:
    """A model's largest lean as a share of the balance angle in its direction; None without a history, and of a fall."""
    run, history = source.runs[name], source.histories.get(name)
    if history is None or run.outcome.overturned:
        return None
    return balance_share(run, history.theta_rad, source.scene.statue.slenderness_rad)


def replay(source: RunSource, chips: list[Chip]) -> Replay:
    """The replay of a run's histories."""
    names, solid = list(source.histories), default_model(source)
    ghost = "analytic" if "analytic" in names and solid != "analytic" else ""
    shown = [each for each in chips if each.name in names]
    return Replay(shown, solid, ghost, source.mesh is not None, replay_payload(source), three_js())


def as_run(scene: SceneRecord, say: Language) -> list[str]:
    """The content of a scene's file as it was run, under words that say so; none of one without a file."""
    return [f"{say('text.scene_as_run')}\n{toml_text(scene.toml)}"] if scene.toml else []


def toml_text(content: Mapping[str, object]) -> str:
    """TOML of nested mappings of strings, numbers, booleans and lists; keys without a value are left out, long lists counted."""
    import tomli_w

    return tomli_w.dumps({key: _stated(value) for key, value in content.items() if value is not None})


def _stated(value: object) -> object:
    """A value, of a long list its length: `result.json` has it whole."""
    if isinstance(value, Mapping):
        return {key: _stated(each) for key, each in value.items() if each is not None}
    return f"{len(value)} numbers" if isinstance(value, list) and len(value) > MANY else value


# What the 3D replay needs: the statue's mesh once, and each model's recorded motion as a few numbers per frame.

FRAME_S: Final = 0.005
"""Step of the frames kept; the page interpolates between them, so that slow replay stays smooth."""
MOST_FRAMES: Final = 20_000
MESH_LEVELS: Final = 2**13
"""Steps over each extent of the mesh: a quarter of a millimetre in 2 m, a fifth of a pixel."""


def replay_payload(source: RunSource) -> str:
    """The replay's data, packed."""
    scene, statue = source.scene, source.scene.statue
    vertices, faces = kinematics.display_mesh(scene, source.mesh)
    end = max(float(item.t_s[-1]) for item in source.histories.values())
    step = max(FRAME_S, end / MOST_FRAMES)
    names = list(source.runs)
    times = {
        name: np.append(np.arange(0.0, each.t_s[-1], step), each.t_s[-1]) for name, each in source.histories.items()
    }
    moves = {
        name: kinematics.poses(scene, kinematics.sampled(source.histories[name], t_s)) for name, t_s in times.items()
    }
    payload = {
        "step_s": step,
        "begin_s": run_event_s(source)[0],
        "end_s": end,
        "corner_left_m": statue.corner_left_m,
        "corner_right_m": statue.corner_right_m,
        "height_m": statue.height_m,
        "in_sight_m": kinematics.in_sight_m(scene, moves.values()),
        "depth_m": statue.depth_m,
        "pedestal": scene.pedestal,
        "wall": scene.wall,
        "mesh": {
            "positions": [packed_array(column, MESH_LEVELS) for column in vertices.T],
            "index": [packed_array(column) for column in faces.T],
            "own": source.mesh is not None,
        },
        "models": [
            {"name": name, "colour": look(name, names).colour, **_frames(history, times[name], moves[name])}
            for name, history in source.histories.items()
        ],
        "floor": _floor(source.record.motion, scene.gravity_m_s2, step, end),
    }
    return packed_json(payload)


def _frames(history: History, t_s: Array, moves: Mapping[str, Array]) -> dict[str, object]:
    """The model's rotation and the poses of its bodies by frame; what stays nought is left out."""
    columns = {"theta_rad": np.interp(t_s, history.t_s, history.theta_rad), **moves}
    frames = {name: packed_array(values) for name, values in columns.items() if np.any(values)}
    return {"end_s": float(t_s[-1]), "frames": frames}


def _floor(motion: MotionRecord, gravity_m_s2: float, step_s: float, end_s: float) -> dict[str, object]:
    """The floor's acceleration in g, for the arrow; absent directions are at rest."""
    t_s = np.arange(0.0, end_s + step_s, step_s)
    return {
        axis: packed_array(np.interp(t_s, motion.t_s, np.asarray(accel) / gravity_m_s2))
        for axis, accel in motion.accel_m_s2.items()
    }


def default_model(source: RunSource) -> str:
    """The model shown solid: a 3D engine's where there is one, else the last that has a history."""
    names = list(source.histories)
    solid = [name for name in names if SOLID_COLUMNS[0] in source.histories[name].extra]
    preferred = [name for name in ("pybullet", "pymunk", "pymunk:plain") if name in names]
    return (solid or preferred or names)[0]
