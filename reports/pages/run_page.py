"""The pages with histories: of one run, of two files, of an effects study, which replays a run.

A run's: verdict, replay, histories, each model's answer, the scene; scores, limits and settings folded away.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
from markupsafe import Markup

from harness.input.history_file import read_history
from harness.model import MANY, RUN_FIELDS, SOLID_COLUMNS, Array, History, Run, number, pair, rotations
from harness.records.effects3d import BASELINE, Effect, EffectsRecord
from harness.records.run import SLIDES_M, STILL_RAD, RunRecord, balance_share, outside_domain
from harness.records.scene import MotionRecord, SceneRecord, StatueRecord
from harness.records.scores import FILES, CompareRecord
from harness.records.scores import Verdict as ScoredVerdict
from harness.statics.standstill import STILL_M
from reports.blocks import (
    Block,
    Chart,
    Chip,
    Details,
    Drawing,
    Facts,
    Group,
    Legend,
    Replay,
    Table,
    Text,
    Verdict,
    command_line,
    facts,
    notes,
    repeat,
    section,
    table,
    turned,
    verdict,
    words,
)
from reports.charts.figure import (
    HAIRLINE,
    HEIGHT,
    INK,
    MUTED,
    PATTERN_FILLS,
    WIDTH,
    Json,
    Look,
    Row,
    across,
    axis,
    chosen,
    columns,
    figure,
    kinds,
    level,
    look,
    marks,
    named,
    names,
    over_time,
    packed_array,
    reading,
    span,
)
from reports.drawing import kinematics
from reports.drawing.kinematics import Faces, read_mesh
from reports.drawing.pictures import (
    CENTRE,
    RADIUS,
    Picture,
    RoseCurve,
    directions_picture,
    disc,
    path,
    plane,
    rose_of,
    rose_places,
    scene_svg,
)
from reports.messages import ENGLISH, Language
from reports.pages.page import packed_json, three_js
from reports.source import (
    MOVED_SHARE,
    RunSource,
    check_files,
    event_s,
    horizon_s,
    limits,
    plan_lines,
    prediction_s,
    run_event_s,
    run_source,
    run_verdict,
    score_rows,
    source_of,
)

# The zoomable histories of all models on one time axis: rotation, motion patterns, pedestal slip, floor motion.

ACROSS: Final = "out_of_plane_rad"
ACROSS_RAD: Final = 1e-4
"""A 3D engine's rotation across the rocking plane below this does not show beside the rotation in it."""
MOST_STRETCHES: Final = 1500
"""Most stretches of motion pattern drawn per model: shorter ones than a pixel do not show."""
BARE: Final = {"rocking": "rocking_bare"}
"""A statue without a pedestal only rocks."""
OFF: Final = {"statue_slides": "statue_off"}
"""What moves a statue on its support also throws it."""
AXIS_LOOKS: Final = {
    "x": Look(INK, "", 1.0),
    "y": Look("#AA4499", "", 1.0),
    "z": Look("#3A8FC7", "", 1.0),
}


def histories_figure(source: RunSource, say: Language = ENGLISH) -> Json:
    """The chart: rows over one axis of time; every curve is a record's history, peaks kept."""
    order, views, motion = list(source.histories), _views(source), source.record.motion
    looks = {name: look(name, order) for name in order}
    gravity = source.scene.gravity_m_s2
    floor = {axis: say("chart.floor_axis", axis=axis) for axis in motion.accel_m_s2}
    data: dict[str, list[Json]] = {
        "histories": [_columns(source, name) for name in order],
        "falls": _falls(source),
        "patterns": pattern_strip(source, say),
        "floor": [
            {"name": floor[axis], "t": np.asarray(motion.t_s), "accel": np.asarray(accel) / gravity}
            for axis, accel in motion.accel_m_s2.items()
        ],
    }
    slides = any(np.abs(part.get("slip", 0.0)).max() > 1e3 * STILL_M for part in data["histories"])
    turns = any("across" in part for part in data["histories"])
    title = next(iter(floor.values())) if len(floor) == 1 else say("chart.floor")
    curves, axes = named(looks, legend=False), {name: AXIS_LOOKS[axis] for axis, name in floor.items()}
    slip, turned = say("word.slip"), say("chart.out_of_plane")
    rows: list[Row] = [
        (_rotation(source, looks, views, say), 320, reading("histories", "theta", "θ", "rad", 5)),
        *((_strip(strips, say), 8 + 22 * len(strips), None) for strips in [data["patterns"]] if strips),
        *([_curves(say("chart.slip_u"), 130, curves, reading("histories", "slip", slip, "mm", 3))] if slides else []),
        *([_curves(say("chart.across"), 110, curves, reading("histories", "across", turned, "rad", 4))] if turns else []),
        *(
            [_curves(f"{title}  [g]", 100, named(axes, len(axes) > 1, False), reading("floor", "accel", "", "g", 3))]
            if floor else []
        ),
    ]  # fmt: skip
    doubt = _doubt(source)
    under = [([*doubt, *layers], height, read) for layers, height, read in rows]
    return over_time(under, say("chart.time"), data, views)


def _curves(title: str, height: float, drawn: Json, read: Json) -> Row:
    """A row of the curves that a pointer reads there."""
    return [marks("line", read["data"], {"y": axis(read["of"], title, tickCount=4)} | drawn)], height, read


def _columns(source: RunSource, name: str) -> Json:
    """What is drawn of a model's history, and how far its error is stated."""
    history, run = source.histories[name], source.runs[name]
    drawn: Json = {"t": history.t_s, "theta": history.theta_rad}
    if source.scene.pedestal is not None:
        drawn["slip"] = 1000.0 * history.slip_m
    if ACROSS in history.extra and float(np.abs(history.extra[ACROSS]).max()) > ACROSS_RAD:
        drawn["across"] = history.extra[ACROSS]
    size, until = run.numerical_uncertainty_rad, run.reliable_until_s
    return drawn | {"name": name, "size": size or 0.0, "until": until if size and until is not None else -1.0}


def _falls(source: RunSource) -> list[Json]:
    """Where models pass their balance points for good."""
    falls = {
        name: source.runs[name].no_return_time_s for name in source.histories if source.runs[name].outcome.overturned
    }
    return [
        {"name": name, "t": [at], "theta": [float(np.interp(at, history.t_s, history.theta_rad))]}
        for name, at in falls.items() if at is not None
        for history in [source.histories[name]]
    ]  # fmt: skip


def _rotation(source: RunSource, looks: Mapping[str, Look], views: Json, say: Language) -> list[Json]:
    """The rotations with their numerical errors, the balance points and the horizon of prediction."""
    statue = source.scene.statue
    y = axis("theta", say("chart.theta"), "Y", {"zero": False, "nice": False, "domain": views["near"]}, tickCount=7)
    error = [
        {"filter": "datum.t <= datum.until"},
        *({"calculate": f"datum.theta {sign} datum.size", "as": name} for sign, name in (("-", "low"), ("+", "high"))),
    ]
    around = {"fill": named(looks)["color"]}
    band = marks("area", "histories", {"y": y | {"field": "low"}, "y2": {"field": "high"}} | around, fillOpacity=0.18)
    layers = [
        band | {"transform": error},
        *chosen([marks("line", "histories", {"y": y} | named(looks))]),
        marks("point", "falls", {"y": y, **around}, shape="cross", angle=45, size=90, filled=True, opacity=1),
        *level(statue.slenderness_right_rad, say("chart.balance_right")),
        *level(-statue.slenderness_left_rad, say("chart.balance_left"), baseline="top"),
    ]
    end, horizon, until = source.scene.duration_s, prediction_s(source), horizon_s(source)
    if horizon is not None and horizon < end:
        layers += level(horizon, say("chart.horizon", time=say.digits(horizon)), "x", Look(MUTED, "2 3", 1.0))
    if until is not None and until < end:
        words, none = say("chart.bounded", time=say.digits(until)), Look(MUTED, "", 0.0)
        layers += level(until, words, "x", none, {"y": HEIGHT}, baseline="bottom", dy=-3)
    return layers


def _doubt(source: RunSource) -> list[Json]:
    """A grey area from where no error is bounded."""
    until, end = horizon_s(source), source.scene.duration_s
    if until is None or until >= end:
        return []
    there = {"data": {"values": [{"from": until, "to": end}]}}
    return [there | marks("rect", "", span("from", "to", letter="x"), color="#7a8696", opacity=0.11)]


def _strip(patterns: Sequence[Json], say: Language) -> list[Json]:
    """What each model does over time, in colours that are hatched too."""
    fills = {say(f"chart.pattern_{name}"): fill for name, fill in PATTERN_FILLS.items()}
    fills |= {say(f"chart.pattern_{own}"): PATTERN_FILLS[name] for name, own in (BARE | OFF).items()}
    met = {kind for part in patterns for kind in part["kind"]}
    y = names("name", [part["name"] for part in patterns], grid=False)
    bars = {"y": y, "color": kinds({kind: fills[kind] for kind in fills if kind in met})}
    return [marks("bar", "patterns", span("t", "t2", letter="x") | bars)]


def _views(source: RunSource) -> Json:
    """The two vertical views of the rotation: near the balance points, and whole."""
    statue = source.scene.statue
    rotations = np.concatenate([[0.0], *(item.theta_rad for item in source.histories.values())])
    least, most = float(rotations.min()), float(rotations.max())
    near = max(least, -1.35 * statue.slenderness_left_rad), min(most, 1.35 * statue.slenderness_right_rad)
    # Let go beyond its balance points, a body that falls never comes near them.
    seen = np.any((rotations[1:] >= near[0]) & (rotations[1:] <= near[1]))
    whole = _padded(least, most)
    return {
        "whole": whole, "near": _worded(_padded(*near), statue) if seen else whole, "duration_s": source.scene.duration_s,
        "event_s": list(run_event_s(source)),
    }  # fmt: skip


def _padded(low: float, high: float) -> list[float]:
    # What is at rest is drawn so, not as the rounding that moves it.
    margin = 0.08 * (high - low) if high - low > STILL_RAD else 0.01
    return [low - margin, high + margin]


def _worded(view: Sequence[float], statue: StatueRecord) -> list[float]:
    """A view with room for the words beyond the balance points that are in it."""
    low, high = view
    room, left, right = 0.06 * (high - low), -statue.slenderness_left_rad, statue.slenderness_right_rad
    return [left - room if low < left < low + room else low, right + room if high - room < right < high else high]


def pattern_strip(source: RunSource, say: Language = ENGLISH) -> list[Json]:
    """The stretches of motion pattern of each model that has them, in the words of what there is."""
    off = any(number(run.validity, "statue_flight_m", 0.0) > SLIDES_M for run in source.runs.values())
    own = (BARE if source.scene.pedestal is None else {}) | (OFF if off else {})
    words = {name: say(f"chart.pattern_{own.get(name, name)}") for name in PATTERN_FILLS}
    return [
        {
            "name": name,
            **columns("t t2 kind", [(start, end, words[kind]) for start, end, kind in drawn_stretches(run.patterns)]),
        }
        for name, run in source.runs.items()
        if run.patterns
    ]


def drawn_stretches(patterns: Sequence[Sequence[Any]], most: int = MOST_STRETCHES) -> list[tuple[float, float, str]]:
    """At most `most` stretches covering the same time: where there are more, what goes on amid each of so many bins."""
    stretches = [(float(start), float(end), str(name)) for start, end, name in patterns]
    if len(stretches) <= most:
        return stretches
    ends = np.array([end for _, end, _ in stretches])
    edges = np.linspace(stretches[0][0], ends[-1], most + 1)
    kinds_of = [stretches[k][2] for k in np.searchsorted(ends, 0.5 * (edges[:-1] + edges[1:]))]
    starts = [0, *(k for k in range(1, most) if kinds_of[k] != kinds_of[k - 1]), most]
    return [(float(edges[k]), float(edges[end]), kinds_of[k]) for k, end in pairwise(starts)]


ANSWERS: Final = [
    *(each.name for each in RUN_FIELDS if each.single and each.name not in ("engine", "message")),
    "impacts",
]
"""What the table of models holds of each."""


def run_page(folder: Path, record: RunRecord, say: Language) -> list[Block]:
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
        *(
            section(
                say, "histories",
                Chart("histories", say("text.histories_chart"), histories_figure(source, say), 1060, "time"),
                words(say, "histories", "caption"),
            ) if source.histories else ()
        ),
        *section(say, "outcomes", Details(models.caption, [models], fold=True)),
        *section(say, "pairs", Facts(pairs, "sentences") if pairs else None),
        *section(say, "notes", *notes(say, told)),
        *section(say, "scene", _scene(source, say)),
        *section(say, "details", *_details(source, say)),
    ]  # fmt: skip


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
    return [
        *([Details(say("section.scores"), [scores], "scores")] if rows else ()),
        *([Details(say("text.limits"), [Group("columns", known)], "limits")] if known else ()),
        Details(say("text.left_out"), [Text(plan_lines(record, say), "plan")], "skips"),
        Details(say("text.settings"), [settings]),
        Details(say("section.repeat"), [Text(again, "command")], "repeat"),
        *repeat(say, record)[0].blocks,
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


# Two histories from files: the verdict, both curves and their difference, the scores in words.


def compare_page(folder: Path, record: CompareRecord, say: Language) -> list[Block]:
    """The blocks of the page; raises `InputError` for a history that is lost or was changed."""
    paths = [folder / name for name in FILES]
    check_files(paths, record)
    a, b = map(read_history, paths)
    scores = record.scores
    # Both may have the same name, in two folders.
    names = (scores.a, scores.b) if scores.a != scores.b else (f"{scores.a} (1)", f"{scores.b} (2)")
    tone = "agree" if scores.verdict is ScoredVerdict.AGREE else "differ"
    return [
        Verdict(scores.verdict_sentence, tone, [each.text for each in scores.findings[1:]]),
        *section(
            say, "histories", Chart("histories", say("text.compare_chart"), compare_figure(names, a, b, say), 1060)
        ),
        *section(
            say,
            "scores",
            Table(say("table.compare"), ["", say("label.value")], score_rows({record.title: scores}, say)),
        ),
        *repeat(say, record, command_line("compare", scores.a, scores.b, *(record.asked or ()), out=folder.name)),
    ]


def compare_figure(names: tuple[str, str], a: History, b: History, say: Language = ENGLISH) -> Json:
    """Rotations, their difference on one grid, and slips where there are any, over one axis of time."""
    both, less = pair(a, b), say("chart.first_less_second")
    looks = {name: look(name, (*names, less)) for name in (*names, less)}
    known = dict(zip(names, (a, b), strict=True))
    data: dict[str, list[Json]] = {
        "rotations": [{"name": name, "t": each.t_s, "theta": each.theta_rad} for name, each in known.items()],
        "difference": [{"name": less, "t": both.t_s, "difference": both.difference_rad}],
    }
    shown = [reading("rotations", "theta", "", "rad", 5), reading("difference", "difference", "", "rad", 5)]
    if any(history.slip_m.any() for history in (a, b)):
        data["slips"] = [{"name": name, "t": each.t_s, "slip": 1e3 * each.slip_m} for name, each in known.items()]
        shown.append(reading("slips", "slip", "", "mm", 5))
    rows: list[Row] = []
    for read in shown:
        y = axis(read["of"], say(f"chart.{read['of']}"), tickCount=5, labelExpr="format(datum.value, '~g')")
        lines = [marks("line", read["data"], {"y": y} | named(looks, legend=not rows))]
        rows.append((lines, 110, read) if rows else (chosen(lines), 260, read))
    end, moved = float(both.t_s[-1]), MOVED_SHARE * float(np.abs(b.theta_rad).max(initial=0.0))
    turned = np.concatenate([a.theta_rad, b.theta_rad])
    views = {
        "event_s": list(event_s((a, b), moved, end)),
        "duration_s": end,
        "whole": [float(turned.min()), float(turned.max())],
    }
    return over_time(rows, say("chart.time"), data, views)


# An effects study: what the third dimension changes, by direction, against what a survey does not know.


def effects3d_page(folder: Path, record: EffectsRecord, say: Language) -> list[Block]:
    """The blocks of an effects study's page."""
    engines, chosen = record.engines, record.replay
    source = run_source(folder / chosen.folder) if chosen else None
    scan = source and directions(record, source, say)
    asked = list(dict.fromkeys(item.engine for item in record.effects))
    colours = [(look(name, engines).colour, name) for name in engines if name in asked]
    left = "; ".join(f"{say.word(name)} ({say.word(why)})" for name, why in record.left_out.items())
    # The curves have a key of their own.
    keys = [("#cdd3da", say("text.lifts")), ("#c3c6ca", say("text.band"))]
    pictures: list[Block] = [Drawing(rose(record, say).svg(say("text.rose")), style="chart-box")]
    pictures += [Drawing(scan, [say("text.scan_directions")], "plain-figure")] if scan else []
    told: list[Block] = [
        words(say, "amplitudes", most=say.short(record.study.search.most_g)), Legend(keys), words(say, "sides"),
        Details(say("text.seen_along_y"), [Drawing(scene_svg(record.scene, say), [record.scene.title])]),
    ]  # fmt: skip
    drawn = Chart("effects", say("text.changes"), changes(record, say), 1060)
    moving: list[Block] = [
        words(
            say, "replayed", azimuth=f"{say.short(chosen.azimuth_deg)}°", peak=say.value(chosen.peak_g, "g"),
            ends=say.listed(f"{say.word(end)} ({name})" for name, end in chosen.outcomes.items()),
        ),
        replay(source, [chip(name, engines, None, say) for name in engines]),
    ] if source and chosen and source.histories else []  # fmt: skip
    commands = [command_line("study", record.file), *([chosen.command] if chosen and chosen.command else [])]
    return [
        verdict(record),
        *section(say, "rose", Group("grid", [Group("", pictures), Group("", told)]),
            Details(say("text.rose_numbers"), [_rose(record, say)]),
        ),
        *section(say, "notes", *notes(say, record.findings)),
        *section(
            say, "effects", words(say, "effects"), Legend(colours), drawn,
            Details(say("text.effects_numbers"), [_effects(record, asked, say)]),
            words(say, "not_asked", "variant", what=left) if left else None,
        ),
        *section(say, "leaving", words(say, "leaving", share=say.short(100 * record.study.share)), _departures(record, say)),
        *moving,
        *repeat(say, record, *commands),
    ]  # fmt: skip


def _rose(record: EffectsRecord, say: Language) -> Table:
    """The rose as numbers: what lifts it, what overturns it in each model, and what a survey leaves open."""
    peaks = {
        name: {row.azimuth_deg: row.peak_g for row in record.amplitudes(name, BASELINE)} for name in record.engines
    }
    falls = {
        row.azimuth_deg: say(f"side.{row.outcome.removeprefix('overturned_')}")
        for row in record.amplitudes(record.solid_engine, BASELINE)
        if row.outcome.startswith("overturned_")
    }

    def peak(value: float | None) -> str:
        return say("ends.stands") if value is None else say.digits(value)

    between = {
        row.azimuth_deg: peak(row.low_g) + ("" if row.low_g is None else f"–{peak(row.high_g)}") for row in record.bands
    }
    rows = [
        [
            f"{say.short(at)}°", say.plain(item.lifts_g, 3), say.plain(item.projected_g, 3),
            *(peak(each[at]) if at in each else say("text.not_sent") for each in peaks.values()),
            between.get(at, "–"), falls.get(at, "–"),
        ]
        for item in record.static for at in [item.azimuth_deg]
    ]  # fmt: skip
    heads = ["", say("label.lifts_g"), say("label.projected_g"), *record.engines, say("label.band"), say("label.falls")]
    return Table(say("table.rose", share=say.short(100 * record.study.search.resolution)), heads, rows)


def _effects(record: EffectsRecord, asked: Sequence[str], say: Language) -> Table:
    """Each condition's change of the overturning amplitude in each model."""
    found = {(item.condition, item.engine): item for item in record.effects}
    rows = [
        [say.word(name), say(f"text.group_{group}"), *(_change(found.get((name, each)), say) for each in asked)]
        for name, group in {item.condition: item.group for item in record.effects}.items()
    ]
    return Table(say("table.effects"), ["", say("label.group"), *asked], rows)


def _change(item: Effect | None, say: Language) -> str:
    """A condition's change in one model: the median, and the least and the largest of all directions."""
    if item is None or item.median is None:
        return say("text.not_seen" if item is None else "text.none_overturns")
    change, *ends = (f"{say.value(value, 'points')}\u00a0%" for value in (item.median, item.least, item.largest))
    return f"{change} ({say.range(ends)})" + (say("text.flips", count=item.flips) if item.flips else "")


def _departures(record: EffectsRecord, say: Language) -> Table | None:
    """How far the body in space leaves the plane of the shaking, by direction."""
    ends = {True: "overturns", False: "stands", None: "other"}
    rows = [
        {
            **vars(item), "azimuth": f"{say.short(item.azimuth_deg)}°", "walked_mm": 1000 * item.walked_m,
            "on_a_corner": say.percent(item.corner_share), "outcome": say(f"ends.{ends[item.outcome.fell]}"),
        }
        for item in record.departures if item.engine == record.solid_engine
    ]  # fmt: skip
    columns = "azimuth peak_g peak_theta_rad out_of_plane_rad yaw_rad yaw_left_rad walked_mm on_a_corner outcome"
    return table(say, "departures", columns, rows, "wrapped")


SIDES_COLOUR: Final = "#8a6d00"


ROW: Final = 46.0
"""Height of a condition."""


def curves(record: EffectsRecord, say: Language = ENGLISH) -> list[RoseCurve]:
    """The curves of a record: every engine's, and the planar model asked at the base's sides."""
    drawn = [
        RoseCurve(
            name, {row.azimuth_deg: row.peak_g for row in record.amplitudes(name, BASELINE)}, look(name, record.engines)
        )
        for name in record.engines[::-1]
    ]
    sides = {row.azimuth_deg: row.projected_g for row in record.static}
    return [*drawn, RoseCurve(say("chart.at_sides"), sides, Look(SIDES_COLOUR, "1.5 4", 2.2))]


def rose(record: EffectsRecord, say: Language = ENGLISH) -> Picture:
    """The least peak that overturns by direction; curves end on the rim where it does not overturn up to the most tried.

    Under them the base, not to the scale of the rings, from which peak on it lifts, and at each direction a bar from the
    5 % to the 95 % quantile of the drawn statues.
    """
    most = record.study.search.most_g
    outline = np.asarray(record.scene.statue.footprint_m, dtype=np.float64)[:, :2]
    base = plane(0.26 * RADIUS / float(np.abs(outline).max()), (0.0, 0.0), CENTRE)
    lifts = rose_places({row.azimuth_deg: row.lifts_g for row in record.static}, most)
    bars = [
        [rose_places({row.azimuth_deg: value}, most)[0] for value in (row.low_g, row.high_g)]
        for row in record.bands
        if row.low_g is not None
    ]
    under = [
        path(base(outline), closed=True, stroke="#6d6353", width=1.2),
        disc(*CENTRE, 2.5, fill=INK),
        *(path(ends, stroke=INK, width=9, opacity=0.28) for ends in bars),
        path(lifts, closed=True, fill="#cdd3da", opacity=0.55),
    ]
    return rose_of(curves(record, say), most, " g", under, say)


def changes(record: EffectsRecord, say: Language = ENGLISH) -> Json:
    """Each condition's change of the overturning amplitude: a disc for a direction, a stroke for the median, by engine.

    The axis holds every median; what lies beyond stands at its end as a triangle. The field behind is how far errors of a survey
    move it.
    """
    items, conditions = record.effects, list(dict.fromkeys(item.condition for item in record.effects))
    engines = list(dict.fromkeys(item.engine for item in items))
    sizes = [abs(change.relative) for item in items for change in item.changes]
    widest = max([float(np.quantile(sizes, 0.9)), *(abs(item.median or 0.0) for item in items)]) if sizes else 0.0
    most = max(5.0, 5.0 * math.ceil(20.0 * widest))
    parts: list[Json] = []
    for item in items:
        at = conditions.index(item.condition) + (engines.index(item.engine) + 1.0) / (len(engines) + 1.0)
        percent = [100.0 * change.relative for change in item.changes]
        parts.append({
            "name": item.engine, "x": [max(-most, min(most, value)) for value in percent], "y": [at] * len(percent),
            "kind": ["within" if abs(value) <= most else "above" if value > 0.0 else "below" for value in percent],
            "tip": [
                f"{item.engine}, {say.short(each.azimuth_deg)}°: {say.value(each.relative, 'points')}\u00a0%"
                for each in item.changes
            ],
            "median": None if item.median is None else 100.0 * item.median, "high": at - 0.2, "low": at + 0.2,
        })  # fmt: skip
    moved = [100.0 * c.relative for item in items if item.group == "uncertainty" for c in item.changes]
    field = [columns("x x2", [np.quantile(moved, (0.05, 0.95)).tolist()])] if moved else []
    names_of = columns("words y", [(say.word(each), float(k)) for k, each in enumerate(conditions)])
    drawn = named({engine: look(engine, engines) for engine in engines}, legend=False, chosen=False)["color"]
    shapes = {"within": "circle", "above": "triangle-right", "below": "triangle-left"}
    scale = {"domain": [*shapes], "range": [*shapes.values()]}
    shape = {"field": "kind", "type": "nominal", "legend": None, "scale": scale}
    layers = [
        marks("rect", "field", {"x2": {"field": "x2"}, "y": {"value": 0}, "y2": HEIGHT}, color=INK, opacity=0.07),
        marks("rule", "conditions", {"x": {"value": 0}, "x2": WIDTH}, color=HAIRLINE),
        *level(0.0, letter="x"),
        marks("point", "changes", {"fill": drawn, "shape": shape}, filled=True, size=40, opacity=0.5, strokeWidth=0, clip=False),
        marks("rule", "changes", {"x": {"field": "median"}, **span("high", "low"), "color": drawn}, strokeWidth=3),
        marks("text", "conditions", {"x": {"value": 0}, "text": {"field": "words"}}, align="left", baseline="top", dy=4),
    ]  # fmt: skip
    x = across("x", say("chart.change"), {"domain": [-most, most], "padding": 0})
    y = axis("y", scale={"domain": [len(conditions), 0], "nice": False}, labels=False, ticks=False, grid=False)
    return figure(layers, ROW * len(conditions), {"changes": parts, "field": field, "conditions": [names_of]}, x, y)


def turned_scan(record: EffectsRecord, source: RunSource) -> tuple[Array, Faces, Array, float] | None:
    """The scan turned back from the replay to the study's directions: vertices, faces, base, and the direction that falls first.

    None without a mesh, or where nothing overturns.
    """
    rows = record.amplitudes(record.solid_engine, BASELINE)
    peaks = {row.azimuth_deg: row.peak_g for row in rows if row.peak_g is not None}
    if source.mesh is None or record.replay is None or not peaks:
        return None
    turn = rotations({"pitch_rad": 0.0, "roll_rad": 0.0, "yaw_rad": math.radians(record.replay.azimuth_deg)})
    vertices, faces = read_mesh(source.mesh)
    footprint = np.asarray(source.scene.statue.footprint_m)
    return vertices @ turn.T, faces, footprint @ turn.T, min(peaks, key=lambda azimuth: peaks[azimuth])


def directions(record: EffectsRecord, source: RunSource, say: Language) -> Markup | None:
    """The scan with the rose's directions on the floor around it; None without one."""
    scan = turned_scan(record, source)
    return None if scan is None else directions_picture(*scan).svg(say("scan.directions", towards=say.short(scan[-1])))
