"""The conservator's three pictures as plain SVG: how far the statue reaches, which push it bears, what gives way first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from markupsafe import Markup, escape

from harness.records.scene import MotionRecord, SceneRecord
from reports.charts.palette import faint
from reports.charts.static_svg_axes import nice_ticks
from reports.charts.study_figures import FLOOR_COLOUR, PEDESTAL_COLOUR
from reports.drawing.kinematics import Array, section
from reports.drawing.silhouette import silhouette_m
from reports.source import RunSource
from reports.text.giving_way import Level, bearing
from reports.text.numbers import length, percent

SIDE: Final = 420
"""Width and height of each picture in its own units."""
MARGIN: Final = 46.0
MOST_RINGS: Final = 4
"""As many circles as a reader can tell apart by their numbers."""
SAFE: Final = "#0b6e4f"
SHAKING: Final = "#c2185b"


def _svg(parts: Sequence[str], title: str, height: float = SIDE) -> Markup:
    return Markup(
        f'<svg class="plain" viewBox="0 0 {SIDE} {height:g}" role="img" aria-label="{escape(title)}" '
        f'xmlns="http://www.w3.org/2000/svg">{"".join(parts)}</svg>'
    )


def _text(x: float, y: float, text: str, anchor: str = "middle", colour: str = "#1c2430") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}">{escape(text)}</text>'


def _path(points: Array, style: str, *, closed: bool = True) -> str:
    drawn = "L".join(f"{x:.1f} {y:.1f}" for x, y in points.tolist())
    return f'<path d="M{drawn}{"Z" if closed else ""}" {style}/>'


def reach_svg(source: RunSource, extremes: Sequence[tuple[float, float]], title: str) -> Markup:
    """The statue at rest, at its farthest leans (rotation in rad, slip in m) as outlines, on its pedestal, before its wall."""
    scene, shape = source.scene, section(source.scene)
    outline = silhouette_m(scene, source.mesh)
    pedestal, wall = scene.pedestal, scene.wall
    lift = 0.0 if pedestal is None else pedestal.height_m
    leans = [shape.posed_m(outline, theta, slip)[0] for theta, slip in extremes]
    centre = 0.5 * (shape.corner_right_m - shape.corner_left_m)
    xs = [*outline[:, 0], *(x for lean in leans for x in lean[:, 0])]
    half = 0.0 if pedestal is None else 0.5 * pedestal.width_m
    box = (centre + (0.0 if pedestal is None else pedestal.offset_m) - half, 2 * half)
    at_wall = None
    if wall is not None:
        right = wall.side == "right"
        at_wall = (shape.corner_right_m if right else -shape.corner_left_m) + (1 if right else -1) * wall.distance_m
        xs.append(at_wall)
    low, high = min(*xs, box[0]), max(*xs, box[0] + box[1])
    top = lift + max(float(outline[:, 1].max()), *(float(lean[:, 1].max()) for lean in leans), 0.0)
    scale = min((SIDE - 2 * MARGIN) / (high - low), (SIDE - 2 * MARGIN) / top)

    def place(points: Array) -> Array:
        x = SIDE / 2 + scale * (points[:, 0] - 0.5 * (low + high))
        return np.column_stack([x, SIDE - MARGIN - scale * (lift + points[:, 1])])

    ground = SIDE - MARGIN
    parts = [f'<path d="M14 {ground}H{SIDE - 14}" stroke="#1c2430" stroke-width="2"/>']
    if pedestal is not None:
        corner = place(np.array([[box[0], 0.0]]))[0]
        size = f'width="{scale * box[1]:.1f}" height="{scale * lift:.1f}"'
        parts.append(f'<rect x="{corner[0]:.1f}" y="{corner[1]:.1f}" {size} fill="#c3c8cf" stroke="#59636f"/>')
    parts.append(_path(place(outline), 'fill="#dfd8cb" stroke="#6d6353" stroke-width="1.5"'))
    for lean in leans:
        parts.append(_path(place(lean), f'fill="none" stroke="{SHAKING}" stroke-width="1.6" stroke-dasharray="5 4"'))
    if at_wall is not None and wall is not None:
        x = float(place(np.array([[at_wall, 0.0]]))[0, 0])
        inwards = 0.0 if wall.side == "right" else -12.0
        parts.append(f'<rect x="{x + inwards:.1f}" y="20" width="12" height="{ground - 20}" fill="#8a94a3"/>')
        parts.append(_text(x, 14, "wall"))
    return _svg([*parts, *_top_shift(outline, leans, place)], title)


def _top_shift(outline: Array, leans: Sequence[Array], place: Any) -> list[str]:
    """How far the outline's highest point moves to each side, written above it."""
    peak = int(np.argmax(outline[:, 1]))
    rest = place(outline[peak : peak + 1])[0]
    parts = [f'<path d="M{rest[0]:.1f} {rest[1]:.1f}V24" stroke="#8a94a3" stroke-dasharray="2 3"/>']
    for lean in leans:
        moved = float(lean[peak, 0] - outline[peak, 0])
        x = float(place(lean[peak : peak + 1])[0, 0])
        parts.append(f'<path d="M{rest[0]:.1f} 30H{x:.1f}" stroke="{SHAKING}" stroke-width="3"/>')
        anchor, beside = ("start", 6) if moved > 0 else ("end", -6)
        parts.append(_text(x + beside, 34, length(abs(moved)), anchor, SHAKING))
    return parts


def push_svg(
    scene: SceneRecord,
    motion: MotionRecord | None,
    slips: Sequence[float],
    title: str,
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
    parts = [
        f'<circle cx="{middle}" cy="{middle}" r="{scale * ring:.1f}" fill="none" stroke="#d5dbe3"/>' for ring in rings
    ]
    parts += [f'<path d="M{MARGIN} {middle}H{SIDE - MARGIN}M{middle} {MARGIN}V{SIDE - MARGIN}" stroke="#d5dbe3"/>']
    parts.append(_path(place(safe), f'fill="{faint(SAFE, 0.22)}" stroke="{SAFE}" stroke-width="2"'))
    for slip in slips:
        circle = f'cx="{middle}" cy="{middle}" r="{scale * slip:.1f}" fill="none" stroke="{PEDESTAL_COLOUR}"'
        parts.append(f'<circle {circle} stroke-width="2" stroke-dasharray="7 4"/>')
    if len(stood):
        parts.append(_path(place(stood), f'fill="none" stroke="{FLOOR_COLOUR}" stroke-width="2.5"'))
        parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{FLOOR_COLOUR}"/>' for x, y in place(stood).tolist()]
    if len(shaking):
        style = f'fill="none" stroke="{SHAKING}" stroke-width="1.2" stroke-linejoin="round"'
        parts.append(_path(place(shaking), style, closed=False))
    diagonal = middle - 0.7071 * scale * np.array(rings)
    parts += [
        _text(float(at), float(at) + 4, percent(ring), colour="#566070")
        for at, ring in zip(diagonal, rings, strict=True)
    ]
    for x, y, words in (
        (SIDE - 4, middle - 6, "right"),
        (4, middle - 6, "left"),
        (middle, 16, "back"),
        (middle, SIDE - 8, "front"),
    ):
        parts.append(_text(x, y, words, {"right": "end", "left": "start"}.get(words, "middle")))
    return _svg(parts, title)


def _shaking(motion: MotionRecord | None, gravity_m_s2: float) -> Array:
    """The pushes (n, 2) of the shaking: against the floor's horizontal acceleration."""
    if motion is None:
        return np.zeros((0, 2))
    if motion.level_m_s2 is not None:
        return -np.asarray(motion.level_m_s2, dtype=np.float64) / gravity_m_s2
    columns = [np.asarray(0.0 if accel is None else accel) for accel in (motion.x_m_s2, motion.y_m_s2)]
    alone = np.column_stack(np.broadcast_arrays(*columns)) if any(item.ndim for item in columns) else np.zeros((0, 2))
    return -alone / gravity_m_s2


def order_svg(levels: Sequence[Level], peak: float | None, title: str) -> Markup:
    """What gives way first: bars from weak to strong, the shaking's strongest push a line."""
    most = max([level.push for level in levels] + ([peak] if peak is not None else []))
    wide, row = SIDE - 84.0, 74.0
    height = 64 + row * len(levels)
    parts = []
    for k, level in enumerate(levels):
        y, size = 52 + row * k, wide * level.push / most
        colour = PEDESTAL_COLOUR if level.cause == "pedestal_slides" else FLOOR_COLOUR
        parts.append(_text(10, y, level.words, "start"))
        parts.append(f'<rect x="10" y="{y + 8:.1f}" width="{size:.1f}" height="26" fill="{colour}"/>')
        parts.append(_text(16 + size, y + 26, percent(level.push), "start"))
    if peak is not None:
        x = 10 + wide * peak / most
        parts.append(
            f'<path d="M{x:.1f} 24V{height - 8:.1f}" stroke="{SHAKING}" stroke-width="2" stroke-dasharray="6 4"/>'
        )
        anchor = "end" if x > SIDE / 2 else "start"
        parts.append(_text(x, 18, f"this shaking: {percent(peak, 3)}", anchor, SHAKING))
    return _svg(parts, title, height)
