"""The conservator's pictures as plain SVG: how far the statue reaches, on a plan too, the push it bears, what gives way first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from markupsafe import Markup

from harness.records.scene import MotionRecord, SceneRecord
from reports.charts.figure import FLOOR_COLOUR, INK, PEDESTAL_COLOUR
from reports.drawing.display_mesh import silhouette_m
from reports.drawing.floor_plan import Plan
from reports.drawing.kinematics import Array, section
from reports.drawing.shapes import Disc, Path, Picture, Shape, Text, area, box, line, nice_ticks
from reports.messages import Language
from reports.source import RunSource
from reports.text.giving_way import Level, bearing

SIDE: Final = 420
"""Width and height of each picture in its own units."""
MARGIN: Final = 46.0
MOST_RINGS: Final = 4
"""As many circles as a reader can tell apart by their numbers."""
GAUGE_ENDS: Final = 1.2
"""The bar of a lean ends at this many times the lean at which the statue balances."""
SAFE: Final = "#0b6e4f"
SHAKING: Final = "#c2185b"


def reach_svg(
    source: RunSource,
    extremes: Sequence[tuple[float, float]],
    balance_rad: Sequence[float],
    gauge_rad: tuple[float, float] | None,
    title: str,
    say: Language,
) -> Markup:
    """The statue at rest, at its farthest leans (rotation in rad, slip in m), where it balances, on its pedestal, at its wall.

    `gauge_rad`: the largest lean and the one at which it balances, as a bar below the floor.
    """
    scene, shape = source.scene, section(source.scene)
    outline = silhouette_m(scene, source.mesh)
    pedestal, wall = scene.pedestal, scene.wall
    lift = 0.0 if pedestal is None else pedestal.height_m
    leans = [shape.posed_m(outline, theta, slip)[0] for theta, slip in extremes]
    balances = [shape.posed_m(outline, theta, 0.0)[0] for theta in balance_rad]
    centre = 0.5 * (shape.corner_right_m - shape.corner_left_m)
    xs = [*outline[:, 0], *(x for lean in [*leans, *balances] for x in lean[:, 0])]
    half = 0.0 if pedestal is None else 0.5 * pedestal.width_m
    stand = (centre + (0.0 if pedestal is None else pedestal.offset_m) - half, 2 * half)
    at_wall = None
    if wall is not None:
        right = wall.side == "right"
        at_wall = (shape.corner_right_m if right else -shape.corner_left_m) + (1 if right else -1) * wall.distance_m
        xs.append(at_wall)
    low, high = min(*xs, stand[0]), max(*xs, stand[0] + stand[1])
    top = lift + max(float(each[:, 1].max()) for each in (outline, *leans, *balances))
    scale = min((SIDE - 2 * MARGIN) / (high - low), (SIDE - 2 * MARGIN) / top)

    def place(points: Array) -> Array:
        x = SIDE / 2 + scale * (points[:, 0] - 0.5 * (low + high))
        return np.column_stack([x, SIDE - MARGIN - scale * (lift + points[:, 1])])

    ground = SIDE - MARGIN
    shapes: list[Shape] = [line([(14, ground), (SIDE - 14, ground)], INK, 2.0)]
    if pedestal is not None:
        x, y = place(np.array([[stand[0], 0.0]]))[0].tolist()
        shapes.append(box(x, y, scale * stand[1], scale * lift, "#c3c8cf", stroke="#59636f"))
    shapes.append(area(place(outline), "#dfd8cb", "#6d6353", 1.5))
    shapes += [Path(place(lean), INK, 1.6, "2 4", closed=True) for lean in balances]
    shapes += [Path(place(lean), SHAKING, 1.6, "5 4", closed=True) for lean in leans]
    if gauge_rad is not None:
        shapes += _gauge(*gauge_rad, say)
    if at_wall is not None and wall is not None:
        x = float(place(np.array([[at_wall, 0.0]]))[0, 0])
        inwards = 0.0 if wall.side == "right" else -12.0
        shapes += [box(x + inwards, 20, 12, ground - 20, "#8a94a3"), Text(x, 14, say("reach.wall"), colour=INK)]
    return _picture([*shapes, *_top_shift(outline, leans, place, say)]).svg(title, "plain")


def _gauge(lean_rad: float, balance_rad: float, say: Language) -> list[Shape]:
    """A bar as long as the lean, in a frame on which a line marks the lean at which the statue balances."""
    left, whole, y = 150.0, 140.0, SIDE - 28.0
    lean, balance = (f"{say.digits(math.degrees(value), 2)}°" for value in (lean_rad, balance_rad))
    end = left + whole
    return [
        box(left, y, GAUGE_ENDS * whole, 12, "none", stroke="#8a94a3"),
        box(left, y, min(lean_rad / balance_rad, GAUGE_ENDS) * whole, 12, SHAKING),
        line([(end, y - 6), (end, y + 18)], INK, 2.0, "2 2"),
        Text(left - 8, y + 11, say("reach.lean", degrees=lean), "end", SHAKING),
        Text(left + GAUGE_ENDS * whole + 8, y + 11, say("reach.of", degrees=balance), "start", INK),
    ]


def _picture(shapes: Sequence[Shape], height: float = SIDE) -> Picture:
    return Picture(SIDE, height, shapes, type_px=15.0)


def _top_shift(outline: Array, leans: Sequence[Array], place: Any, say: Language) -> list[Shape]:
    """How far the outline's highest point moves to each side, written above it."""
    peak = int(np.argmax(outline[:, 1]))
    rest = place(outline[peak : peak + 1])[0]
    shapes: list[Shape] = [line([rest, (rest[0], 24)], "#8a94a3", dash="2 3")]
    for lean in leans:
        moved = float(lean[peak, 0] - outline[peak, 0])
        x = float(place(lean[peak : peak + 1])[0, 0])
        anchor, beside = ("start", 6) if moved > 0 else ("end", -6)
        shapes += [
            line([(rest[0], 30), (x, 30)], SHAKING, 3.0),
            Text(x + beside, 34, say.length(abs(moved)), anchor, SHAKING),
        ]
    return shapes


def push_svg(
    scene: SceneRecord,
    motion: MotionRecord | None,
    slips: Sequence[float],
    title: str,
    say: Language,
    borne: Array | None = None,
) -> Markup:
    """Seen from above: the steady pushes, as shares of the weight, under which the statue keeps still, and the shaking.

    `slips` are pushes from which something slides, `borne` (k, 2) the strongest shakings, by direction, without a fall.

    A push leaves the statue at rest while the base holds centroid plus push times centroid height: the base over that height.
    """
    safe = bearing(scene)
    shaking = _shaking(motion, scene.gravity_m_s2)
    stood = np.zeros((0, 2)) if borne is None else borne
    reached = [float(np.abs(points).max(initial=0.0)) for points in (safe, shaking, stood)]
    most = max(*reached, *slips, 0.0)
    scale = (SIDE / 2 - MARGIN) / most
    middle = SIDE / 2

    def place(pushes: Array) -> Array:
        return np.column_stack([middle + scale * pushes[:, 0], middle - scale * pushes[:, 1]])

    rings = nice_ticks(0.0, most, MOST_RINGS)[1:]
    shapes: list[Shape] = [Disc(middle, middle, scale * ring, stroke="#d5dbe3") for ring in rings]
    for end in ((SIDE - MARGIN, middle), (middle, SIDE - MARGIN)):
        shapes.append(line([(SIDE - end[0], SIDE - end[1]), end], "#d5dbe3"))
    shapes += [area(place(safe), SAFE, opacity=0.22), Path(place(safe), SAFE, 2.0, closed=True)]
    shapes += [Disc(middle, middle, scale * slip, "", PEDESTAL_COLOUR, 2.0, "7 4") for slip in slips]
    if len(stood):
        shapes.append(Path(place(stood), FLOOR_COLOUR, 2.5, closed=True))
        shapes += [Disc(x, y, 4.0, FLOOR_COLOUR) for x, y in place(stood).tolist()]
    if len(shaking):
        shapes.append(line(place(shaking), SHAKING, 1.2))
    diagonal = middle - 0.7071 * scale * np.array(rings)
    shapes += [
        Text(float(at), float(at) + 4, say.percent(ring), colour="#566070")
        for at, ring in zip(diagonal, rings, strict=True)
    ]
    shapes += _compass(say)
    return _picture(shapes).svg(title, "plain")


def _compass(say: Language) -> list[Shape]:
    """The names of the four sides around a picture seen from above, left and right in its corners: no circle reaches there."""
    middle = SIDE / 2
    return [
        Text(SIDE - 4, SIDE - 8, say("side.right"), "end", INK),
        Text(4, SIDE - 8, say("side.left"), "start", INK),
        Text(middle, 16, say("side.back"), colour=INK),
        Text(middle, SIDE - 8, say("side.front"), colour=INK),
    ]


def plan_svg(scene: SceneRecord, plan: Plan, title: str, say: Language) -> Markup:
    """Seen from above: the outline at rest, what holds every position of it, the pedestal, the wall; the room by side."""
    stone, wall = scene.pedestal, scene.wall
    corners = [plan.rest_m, plan.moved_m]
    if stone is not None:
        half = 0.5 * np.array([stone.width_m, stone.depth_m])
        centre = [0.5 * (scene.statue.corner_right_m - scene.statue.corner_left_m) + stone.offset_m, 0.0]
        corners.append(centre + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]))
    low, high = np.vstack(corners).min(axis=0), np.vstack(corners).max(axis=0)
    scale = (SIDE - 4 * MARGIN) / float((high - low).max())

    def place(points: Array) -> Array:
        seen = scale * (points - 0.5 * (low + high))
        return np.column_stack([SIDE / 2 + seen[:, 0], SIDE / 2 - seen[:, 1]])

    shapes: list[Shape] = [] if stone is None else [Path(place(corners[2]), "#59636f", 1.2, closed=True)]
    shapes.append(area(place(plan.rest_m), "#dfd8cb", "#6d6353", 1.5))
    if plan.room_m:
        shapes.append(Path(place(plan.moved_m), SHAKING, 1.6, "5 4", closed=True))
    if wall is not None:
        side = 1.0 if wall.side == "right" else -1.0
        edge = scene.statue.corner_right_m if side > 0 else scene.statue.corner_left_m
        x = float(place(np.array([[side * (edge + wall.distance_m), 0.0]]))[0, 0])
        # A wall farther away than the picture reaches is not drawn; its distance stands in words.
        if 0.0 < x < SIDE:
            shapes.append(box(x if side > 0 else x - 8, 20, 8, SIDE - 40, "#8a94a3"))
    ends = place(np.array([plan.moved_m.min(axis=0), plan.moved_m.max(axis=0)]))
    at = {
        "left": (ends[0, 0] - 6, SIDE / 2 + 16, "end"), "right": (ends[1, 0] + 6, SIDE / 2 + 16, "start"),
        "front": (SIDE / 2, ends[0, 1] + 18, "middle"), "back": (SIDE / 2, ends[1, 1] - 8, "middle"),
    }  # fmt: skip
    shapes += [
        Text(float(at[side][0]), float(at[side][1]), f"+{say.length(room)}", at[side][2], SHAKING)
        for side, room in plan.room_m.items()
    ]
    return _picture([*shapes, *_compass(say)]).svg(title, "plain")


def _shaking(motion: MotionRecord | None, gravity_m_s2: float) -> Array:
    """The pushes (n, 2) of the shaking: against the floor's horizontal acceleration."""
    if motion is None:
        return np.zeros((0, 2))
    if motion.level_m_s2 is not None:
        return -np.asarray(motion.level_m_s2, dtype=np.float64) / gravity_m_s2
    columns = [np.asarray(0.0 if accel is None else accel) for accel in (motion.x_m_s2, motion.y_m_s2)]
    alone = np.column_stack(np.broadcast_arrays(*columns)) if any(item.ndim for item in columns) else np.zeros((0, 2))
    return -alone / gravity_m_s2


def order_svg(levels: Sequence[Level], peak: float | None, title: str, say: Language) -> Markup:
    """What gives way first: bars from weak to strong, the shaking's strongest push a line."""
    most = max([level.push for level in levels] + ([peak] if peak is not None else []))
    wide, row = SIDE - 84.0, 74.0
    height = 64 + row * len(levels)
    shapes: list[Shape] = []
    for k, level in enumerate(levels):
        y, size = 52 + row * k, wide * level.push / most
        colour = PEDESTAL_COLOUR if level.cause == "pedestal_slides" else FLOOR_COLOUR
        shapes += [Text(10, y, level.words, "start", INK), box(10, y + 8, size, 26, colour)]
        shapes.append(Text(16 + size, y + 26, say.percent(level.push), "start", INK))
    if peak is not None:
        x = 10 + wide * peak / most
        shapes.append(line([(x, 24), (x, height - 8)], SHAKING, 2.0, "6 4"))
        anchor = "end" if x > SIDE / 2 else "start"
        shapes.append(Text(x, 18, say("order.this_shaking", push=say.percent(peak, 3)), anchor, SHAKING))
    return _picture(shapes, height).svg(title, "plain")
