"""The statue's still pictures: the room that it needs on a floor plan, the scene from the side, how far it reaches, the push that
it bears, what gives way first.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from jinja2 import Template
from markupsafe import Markup

from harness.model import SOLID_COLUMNS, Array, Outcome
from harness.records.assess import ClearanceRecord
from harness.records.scene import MotionRecord, SceneRecord
from reports.charts.figure import FLOOR_COLOUR, HAIRLINE, INK, MUTED, PEDESTAL_COLOUR
from reports.charts.histories import shown_samples
from reports.drawing.kinematics import (
    body_m,
    pedestal_sides_m,
    posed_m,
    poses,
    room_m,
    sampled,
    silhouette_m,
    wall_m,
)
from reports.drawing.shapes import Picture, box, disc, path, plane, polar, rings, text
from reports.messages import Language
from reports.pages.assets import environment
from reports.source import RunSource
from reports.text.giving_way import PushLevel, bearing

POSES: Final = 240
"""Most poses of one column of a history in which it is sought which points of a body are ever outermost."""
SIDES: Final[Mapping[str, tuple[float, float]]] = {
    "left": (-1.0, 0.0), "right": (1.0, 0.0), "front": (0.0, -1.0), "back": (0.0, 1.0)
}  # fmt: skip
"""Sides of the room as directions seen from above."""
WAYS: Final = np.array([(math.cos(angle), math.sin(angle)) for angle in np.radians(np.arange(0.0, 360.0, 5.0))])
"""Directions in which it is sought what is outermost: between two of them an outline loses a thousandth of its size."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Outlines (k, 2) seen from above at rest and over every position, and the room needed beyond the first, m, by side: more
    than that on the side of a wall that is `struck`."""

    rest_m: Array
    moved_m: Array
    room_m: Mapping[str, float]
    struck: str = ""


def floor_plan(source: RunSource, names: Sequence[str]) -> Plan:
    """The plan over the histories of these models; a model of a plane alone tells nothing of the front and the back.

    Without a model nothing is known of the room.
    """
    scene, body = source.scene, body_m(source.scene, source.mesh)
    moves = [sampled(source.histories[name]) for name in names]
    rest = _hull(body[:, :2])
    moved = _hull(np.vstack([rest, *(_reached(scene, body, poses(scene, each)) for each in moves)]))
    in_space = any(SOLID_COLUMNS[0] in each for each in moves)
    sides = SIDES if in_space else {side: SIDES[side] for side in ("left", "right")}
    room = {side: float((moved @ towards).max() - (rest @ towards).max()) for side, towards in sides.items() if names}
    wall = scene.wall
    if wall is None or not room or all(run.outcome is not Outcome.TOUCHES_WALL for run in source.answered.values()):
        return Plan(rest, moved, room)
    return Plan(rest, moved, room | {wall.side: room_m(scene, poses(scene, {}))}, wall.side)


def probable_plan(item: ClearanceRecord, share: float) -> Plan | None:
    """The plan that holds this share of the draws that stand, by the model that knows most directions; None where none tells."""
    answer = next(iter(item.answered.values()), None)
    if answer is None or share not in answer.share:
        return None
    rest, beyond = np.asarray(item.rest_m, dtype=np.float64), answer.at(share)
    towards = {side: np.array(way) for side, way in SIDES.items()}
    angles = {side: float(np.degrees(np.arctan2(way[1], way[0])) % 360.0) for side, way in SIDES.items()}
    room = {side: round(beyond[angle], 4) for side, angle in angles.items() if angle in beyond}
    if len(beyond) <= len(room):
        return Plan(rest, _hull(np.vstack([rest + room[side] * towards[side] for side in room])), room)
    from scipy.spatial import HalfspaceIntersection

    ways = np.radians(list(beyond))
    normals = np.column_stack([np.cos(ways), np.sin(ways)])
    reached = (rest @ normals.T).max(axis=0) + list(beyond.values())
    corners = HalfspaceIntersection(np.column_stack([normals, -reached]), rest.mean(axis=0)).intersections
    return Plan(rest, _hull(np.asarray(corners)), room)


def _hull(points: Array) -> Array:
    """Those of points (n, 2) that are outermost in one of many directions, counter-clockwise."""
    return points[list(dict.fromkeys(int(np.argmax(points @ way)) for way in WAYS))]


def _reached(scene: SceneRecord, body: Array, pose: Mapping[str, Array]) -> Array:
    """The outline (k, 2) of all that a body's points come over at `poses`: in all of them, of points outermost in some."""
    some = np.unique(np.concatenate([shown_samples(values, POSES) for values in pose.values()]))
    seen = posed_m(scene, body, {name: values[some] for name, values in pose.items()})[:, :, :2].reshape(-1, 2)
    outer = sorted({int(np.argmax(seen @ way)) % len(body) for way in WAYS})
    return _hull(posed_m(scene, body[outer], pose)[:, :, :2].reshape(-1, 2))


# The scene drawn to scale as inline SVG: floor, pedestal, silhouette, corners, centroid, wall, dimensions.

WIDTH: Final = 460.0
HEIGHT: Final = 440.0
BORDERS: Final = {"left": 74.0, "right": 74.0, "top": 26.0, "bottom": 84.0}
BESIDE_CORNER: Final = 126.0
"""Room beside a corner of the base, for its angle and the height of the centroid."""


def scene_svg(scene: SceneRecord, say: Language, axes: Collection[str] = (), mesh: Path | None = None) -> Markup:
    """The picture of a record's scene, seen along y: x to the right, z up, with the words of a language.

    The floor moves along `axes`; `mesh` gives the statue's true outline.
    """
    template: Template = environment().get_template("scene.svg.j2")
    outline = silhouette_m(scene, mesh)
    pedestal, sides, wall_x = scene.pedestal, pedestal_sides_m(scene), wall_m(scene)
    lift = 0.0 if pedestal is None else pedestal.height_m
    xs = [*outline[:, 0].tolist(), *sides, *([] if wall_x is None else [wall_x])]
    left, right = float(min(xs)), float(max(xs))
    top = lift + float(outline[:, 1].max())
    middle = 0.5 * (left + right)
    scale = min(
        (WIDTH - BORDERS["left"] - BORDERS["right"]) / (right - left),
        (HEIGHT - BORDERS["top"] - BORDERS["bottom"]) / top,
        (WIDTH / 2 - BESIDE_CORNER) / max(scene.statue.corner_right_m - middle, scene.statue.corner_left_m + middle),
    )

    def x(value: float) -> float:
        return round(WIDTH / 2 + scale * (value - middle), 2)

    def z(value: float) -> float:
        return round(HEIGHT - BORDERS["bottom"] - scale * value, 2)

    drawn = template.render(
        width=WIDTH, height=HEIGHT, x=x, z=z, outline=outline.tolist(), lift=lift, top=top, left=left, right=right,
        statue=scene.statue, pedestal=pedestal, sides=sides, wall=scene.wall, wall_x=wall_x, axes=axes, say=say,
    )  # fmt: skip
    return Markup(drawn)


# The conservator's pictures as plain SVG: how far the statue reaches, on a plan too, the push it bears, what gives way first.

SIDE: Final = 420
"""Width and height of each picture in its own units."""
MARGIN: Final = 46.0
MOST_RINGS: Final = 4
"""As many circles as a reader can tell apart by their numbers."""
GAUGE_ENDS: Final = 1.2
"""The bar of a lean ends at this many times the lean at which the statue balances."""
SAFE: Final = "#0b6e4f"
SHAKING: Final = "#c2185b"
WALL: Final = "#8a94a3"
STATUE: Final = {"fill": "#dfd8cb", "stroke": "#6d6353", "width": 1.5}
"""The statue where it stands."""
FARTHEST: Final = {"stroke": SHAKING, "width": 1.6, "dash": "5 4"}
"""How far it moves."""


def reach_sketch(
    source: RunSource,
    extremes: Sequence[Mapping[str, Array]],
    balance_rad: Sequence[float],
    gauge_rad: tuple[float, float] | None,
    say: Language,
) -> Picture:
    """The statue at rest, at its farthest leans (`poses` of one sample), where it balances, on its pedestal, at its wall.

    `gauge_rad`: the largest lean and the one at which it balances, as a bar below the floor.
    """
    scene = source.scene
    flat = np.insert(silhouette_m(scene, source.mesh), 1, 0.0, axis=1)
    rest, *balances = posed_m(scene, flat, poses(scene, {"theta_rad": [0.0, *balance_rad]}))[:, :, ::2]
    leans = [posed_m(scene, flat, pose)[0, :, ::2] for pose in extremes]
    lift = 0.0 if scene.pedestal is None else scene.pedestal.height_m
    sides, wall = pedestal_sides_m(scene), wall_m(scene)
    reached = np.vstack([rest, *leans, *balances])
    xs = [*reached[:, 0], *sides, *([] if wall is None else [wall])]
    room, wide, high = SIDE - 2 * MARGIN, max(xs) - min(xs), float(reached[:, 1].max())
    ground, scale = SIDE - MARGIN, min(room / wide, room / high)
    place = plane(scale, (0.5 * (min(xs) + max(xs)), 0.0), (SIDE / 2, ground))
    shapes = [path([(14, ground), (SIDE - 14, ground)], stroke=INK, width=2)]
    if sides:
        left, right = place([(side, 0.0) for side in sides])[:, 0].tolist()
        shapes.append(box(left, ground - scale * lift, right - left, scale * lift, fill="#c3c8cf", stroke="#59636f"))
    shapes += [
        path(place(rest), closed=True, **STATUE),
        *(path(place(lean), closed=True, stroke=INK, width=1.6, dash="2 4") for lean in balances),
        *(path(place(lean), closed=True, **FARTHEST) for lean in leans),
        *(_gauge(*gauge_rad, say) if gauge_rad is not None else ()),
    ]
    if wall is not None:
        x = float(place((wall, 0.0))[0, 0])
        shapes.append(box(x if wall > 0.0 else x - 12.0, 20, 12, ground - 20, fill=WALL))
        shapes.append(text(x, 14, say("reach.wall"), colour=INK))
    peak = int(np.argmax(rest[:, 1]))
    moves = [(place(lean[peak])[0, 0], lean[peak, 0] - rest[peak, 0]) for lean in leans]
    return Picture(SIDE, SIDE, [*shapes, *_top_shift(place(rest[peak])[0], moves, say)])


def _gauge(lean_rad: float, balance_rad: float, say: Language) -> list[str]:
    """A bar as long as the lean, in a frame on which a line marks the lean at which the statue balances."""
    left, whole, y = 150.0, 140.0, SIDE - 28.0
    lean, balance = (f"{say.digits(math.degrees(value), 2)}°" for value in (lean_rad, balance_rad))
    end = left + whole
    return [
        box(left, y, GAUGE_ENDS * whole, 12, stroke=WALL),
        box(left, y, min(lean_rad / balance_rad, GAUGE_ENDS) * whole, 12, fill=SHAKING),
        path([(end, y - 6), (end, y + 18)], stroke=INK, width=2, dash="2 2"),
        text(left - 8, y + 11, say("reach.lean", degrees=lean), "end", SHAKING),
        text(left + GAUGE_ENDS * whole + 8, y + 11, say("reach.of", degrees=balance), "start", INK),
    ]


def _top_shift(rest_px: Array, moves: Sequence[tuple[float, float]], say: Language) -> list[str]:
    """How far the outline's highest point moves to each side (to which pixel, by how many m), written above it."""
    x, y = rest_px.tolist()
    shapes = [path([(x, y), (x, 24)], stroke=WALL, dash="2 3")]
    for end, moved_m in moves:
        anchor, beside = ("start", 6) if moved_m > 0 else ("end", -6)
        shapes.append(path([(x, 30), (end, 30)], stroke=SHAKING, width=3))
        shapes.append(text(end + beside, 34, say.length(abs(moved_m)), anchor, SHAKING))
    return shapes


def push_sketch(
    scene: SceneRecord, motion: MotionRecord | None, slips: Sequence[float], borne: Mapping[float, float], say: Language
) -> Picture:
    """Seen from above: the steady pushes, as shares of the weight, under which the statue keeps still, and the shaking.

    `slips` are pushes from which something slides, `borne` the strongest shakings without a fall by azimuth in degrees.

    A push leaves the statue at rest while the base holds centroid plus push times centroid height: the base over that height.
    """
    safe, stood = bearing(scene), polar(dict(sorted(borne.items())))
    shaking = _shaking(motion, scene.gravity_m_s2)
    most = max(*(float(np.abs(points).max(initial=0.0)) for points in (safe, shaking, stood)), *slips)
    reach, middle = SIDE / 2 - MARGIN, SIDE / 2
    scale = reach / most
    place = plane(scale, (0.0, 0.0), (middle, middle))
    shares = rings(most, MOST_RINGS)
    diagonals = {share: middle - math.sqrt(0.5) * scale * share for share in shares}
    shapes = [
        *(disc(middle, middle, scale * share, stroke=HAIRLINE) for share in shares),
        *(path(place(most * np.outer((-1, 1), along)), stroke=HAIRLINE) for along in np.eye(2)),
        path(place(safe), closed=True, fill=SAFE, opacity=0.22),
        path(place(safe), closed=True, stroke=SAFE, width=2),
        *(disc(middle, middle, scale * slip, stroke=PEDESTAL_COLOUR, width=2, dash="7 4") for slip in slips),
        path(place(stood), closed=True, stroke=FLOOR_COLOUR, width=2.5),
        *(disc(x, y, 4, fill=FLOOR_COLOUR) for x, y in place(stood).tolist()),
        path(place(shaking), stroke=SHAKING, width=1.2),
        *(text(at, at + 4, say.percent(share), colour=MUTED) for share, at in diagonals.items()),
        *_compass(say),
    ]
    return Picture(SIDE, SIDE, shapes)


def _compass(say: Language) -> list[str]:
    """The names of the four sides around a picture seen from above, left and right in its corners: no circle reaches there."""
    middle, low = SIDE / 2, SIDE - 8
    return [
        text(SIDE - 4, low, say("side.right"), "end", INK),
        text(4, low, say("side.left"), "start", INK),
        text(middle, 16, say("side.back"), colour=INK),
        text(middle, low, say("side.front"), colour=INK),
    ]


def plan_sketch(scene: SceneRecord, plan: Plan, say: Language) -> Picture:
    """Seen from above: the outline at rest, what holds every position of it, the pedestal, the wall; the room by side."""
    stone, wall = scene.pedestal, wall_m(scene)
    corners = [plan.rest_m, plan.moved_m]
    if stone is not None:
        left, right = pedestal_sides_m(scene)
        half = 0.5 * stone.depth_m
        corners.append(np.array([[left, -half], [right, -half], [right, half], [left, half]]))
    low, high = np.vstack(corners).min(axis=0), np.vstack(corners).max(axis=0)
    scale, middle = (SIDE - 4 * MARGIN) / float((high - low).max()), SIDE / 2
    place = plane(scale, 0.5 * (low + high), (middle, middle))
    # A wall farther away than the picture reaches is not drawn; its distance stands in words.
    x = -1.0 if wall is None else float(place((wall, 0.0))[0, 0])
    walls = [x if wall > 0.0 else x - 8] if wall is not None and 0.0 < x < SIDE else []
    (left, bottom), (right, top) = place([plan.moved_m.min(axis=0), plan.moved_m.max(axis=0)]).tolist()
    at = {
        "left": (left - 6, middle + 16, "end"), "right": (right + 6, middle + 16, "start"),
        "front": (middle, bottom + 18, "middle"), "back": (middle, top - 8, "middle"),
    }  # fmt: skip
    told = {side: (">\u00a0" if side == plan.struck else "+") + say.length(room) for side, room in plan.room_m.items()}
    shapes = [
        *(path(place(stone_m), closed=True, stroke="#59636f", width=1.2) for stone_m in corners[2:]),
        path(place(plan.rest_m), closed=True, **STATUE),
        *(path(place(each), closed=True, **FARTHEST) for each in [plan.moved_m] if plan.room_m),
        *(box(edge, 20, 8, SIDE - 40, fill=WALL) for edge in walls),
        *(text(x, y, told[side], anchor, SHAKING) for side, (x, y, anchor) in at.items() if side in told),
        *_compass(say),
    ]
    return Picture(SIDE, SIDE, shapes)


def _shaking(motion: MotionRecord | None, gravity_m_s2: float) -> Array:
    """The pushes (n, 2) of the shaking: against the floor's horizontal acceleration."""
    if motion is None:
        return np.zeros((0, 2))
    if motion.level_m_s2 is None:
        along = (0.0 if accel is None else accel for accel in (motion.x_m_s2, motion.y_m_s2))
        return -np.column_stack(np.broadcast_arrays(*along)) / gravity_m_s2
    return -np.asarray(motion.level_m_s2, dtype=np.float64) / gravity_m_s2


def order_sketch(levels: Sequence[PushLevel], peak: float | None, say: Language) -> Picture:
    """What gives way first: bars from weak to strong, the shaking's strongest push a line."""
    most = max([level.push for level in levels] + ([peak] if peak is not None else []))
    wide, row = SIDE - 84.0, 74.0
    height = 64 + row * len(levels)
    bars = [(52 + row * k, wide * level.push / most, level) for k, level in enumerate(levels)]
    colours = {"pedestal_slides": PEDESTAL_COLOUR}
    shapes = [box(10, y + 8, size, 26, fill=colours.get(level.cause, FLOOR_COLOUR)) for y, size, level in bars]
    # Words stand on all that is drawn, with a rim of their own.
    words = [
        each
        for y, size, level in bars
        for each in (
            text(10, y, level.words, "start", INK),
            text(16 + size, y + 26, say.percent(level.push), "start", INK),
        )
    ]
    if peak is not None:
        x = 10 + wide * peak / most
        shapes.append(path([(x, 24), (x, height - 8)], stroke=SHAKING, width=2, dash="6 4"))
        anchor = "end" if x > SIDE / 2 else "start"
        words.append(text(x, 18, say("order.this_shaking", push=say.percent(peak, 3)), anchor, SHAKING))
    return Picture(SIDE, height, [*shapes, *words])
