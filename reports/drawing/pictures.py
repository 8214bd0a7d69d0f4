"""The statue's still pictures, and of what each is made: the room that it needs on a floor plan, the scene from the side, how far
it reaches, the push that it bears, what gives way first, a scan among its directions, the rose of what it bears.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, Final

import numpy as np
from jinja2 import Template
from markupsafe import Markup
from numpy.typing import ArrayLike

from harness.model import SOLID_COLUMNS, Array, Outcome
from harness.records.assess import ClearanceRecord
from harness.records.scene import MotionRecord, PushRecord, SceneRecord
from harness.records.study import SupportRecord
from harness.statics.standstill import tipping_of_pedestal
from meshes.footprint import reach_m, slenderness_rose_rad, weakest_azimuth_deg
from meshes.solid import Solid
from reports.charts.figure import FLOOR_COLOUR, HAIRLINE, INK, MUTED, PEDESTAL_COLOUR, Look, shown_samples
from reports.drawing.kinematics import (
    Faces,
    body_m,
    decimated,
    eye_axes,
    facing,
    pedestal_sides_m,
    posed_m,
    poses,
    room_m,
    sampled,
    silhouette_m,
    wall_m,
)
from reports.messages import ENGLISH, Language
from reports.pages.page import environment
from reports.source import RunSource

# A picture as SVG in pixels from its upper left corner, made of lines, areas, discs and texts; every still picture is one. A page
# carries it as it is written here, and `reports.export.figures` prints it.


def element(name: str, attributes: Mapping[str, str], inside: str = "") -> str:
    """An element of SVG; attributes that are empty are left out."""
    said = "".join(f' {key}="{value}"' for key, value in attributes.items() if value)
    return f"<{name}{said}>{inside}</{name}>" if inside else f"<{name}{said}/>"


def shape(
    name: str,
    places: Mapping[str, str],
    *,
    fill: str = "none",
    stroke: str = "",
    width: float = 1.0,
    dash: str = "",
    opacity: float = 1.0,
    title: str = "",
) -> str:
    """An element that is filled with one colour and drawn in another; a pointer over it is told its `title`.

    `dash` holds lengths in pixels with blanks between them; empty: unbroken.
    """
    style = {"fill": fill, "stroke": stroke, "stroke-width": f"{width:g}" if stroke else "", "stroke-dasharray": dash}
    faint = {"opacity": f"{opacity:g}" if opacity < 1.0 else ""}
    return element(name, {**places, **style, **faint}, element("title", {}, escape(title)) if title else "")


def path(points_px: ArrayLike, *, closed: bool = False, **style: Any) -> str:
    """Straight lines through points (n, 2), none of no points, in a style of `shape`; one that is not a number parts a line."""
    places = np.asarray(points_px).tolist()
    known = [math.isfinite(x) and math.isfinite(y) for x, y in places]
    starts = zip(places, known, [False, *known], strict=False)
    points = "".join(f"{'L' if after else 'M'}{x:.1f} {y:.1f}" for (x, y), there, after in starts if there)
    return shape("path", {"d": points + "Z" * closed}, **style) if points else ""


def disc(x: float, y: float, radius: float, **style: Any) -> str:
    """A disc, in a style of `shape`."""
    return shape("circle", {"cx": f"{x:.1f}", "cy": f"{y:.1f}", "r": f"{radius:.1f}"}, **style)


def box(left: float, top: float, width: float, height: float, **style: Any) -> str:
    """A rectangle with level sides, in a style of `shape`."""
    sizes = {"x": left, "y": top, "width": width, "height": height}
    return shape("rect", {name: f"{value:.1f}" for name, value in sizes.items()}, **style)


def text(
    x: float, y: float, words: str, anchor: str = "middle", colour: str = "", size_px: str = "", halo: bool = False
) -> str:
    """A line of text on its base line, without `colour` and `size_px` as the picture's; a `halo` keeps it legible over lines."""
    style = {"text-anchor": anchor, "fill": colour, "font-size": size_px}
    rim = {"stroke": "#fff", "stroke-width": "3", "paint-order": "stroke"} if halo else {}
    return element("text", {"x": f"{x:.1f}", "y": f"{y:.1f}", **style, **rim}, escape(words))


def plane(scale: float, origin: ArrayLike, at_px: tuple[float, float]) -> Callable[[ArrayLike], Array]:
    """What places points (n, 2) of a plane in a picture: its `origin` at `at_px`, so many pixels to a unit, y upwards."""

    def place(points: ArrayLike) -> Array:
        return np.asarray(at_px + scale * (np.atleast_2d(points) - origin) * [1.0, -1.0])

    return place


def polar(reach: Mapping[float, float]) -> Array:
    """Points (n, 2) so far from the middle by azimuth in degrees, counter-clockwise from the right."""
    angles, sizes = np.radians([*reach]), np.array([*reach.values()])
    return np.column_stack([sizes * np.cos(angles), sizes * np.sin(angles)])


@dataclass(frozen=True, eq=False)
class Picture:
    """Shapes, in the order in which they are drawn, in a picture of that size from `top_px` on."""

    width: float
    height: float
    shapes: Sequence[str]
    top_px: float = 0.0

    def svg(self, words: str = "", css: str = "still") -> Markup:
        """As an inline SVG of that class; `words` describe it to those who cannot see it, none where its surroundings do."""
        said = f'role="img" aria-label="{escape(words)}"' if words else 'aria-hidden="true"'
        box = f'viewBox="0 {self.top_px:g} {self.width:g} {self.height:g}" {said}'
        drawn = "".join(self.shapes)
        return Markup(f'<svg class="{css}" {box} xmlns="http://www.w3.org/2000/svg">{drawn}</svg>')


def rings(most: float, count: int) -> list[float]:
    """Round values up to `most` at equal steps, as many as make no more than `count` (≥ 2)."""
    power = 10.0 ** (math.floor(math.log10(most / count)) - 1)
    steps = (power * factor * 10.0**k for k in range(4) for factor in (1.0, 2.0, 5.0))
    step = next(each for each in steps if most / each < count + 1 - 1e-9)
    return [round(k * step, 12) for k in range(1, math.floor(most / step + 1e-9) + 1)]


# What gives way first under a growing push: what the statue stands on, the pushes that move it, what their order means.

Span = tuple[float, float]

DIRECTIONS: Final = ("right", "back_right", "back", "back_left", "left", "front_left", "front", "front_right")
EQUAL: Final = 0.01
"""Sides whose pushes differ by a smaller share are told as equally weak: pushes are told to two digits."""
EVERY_SIDE: Final = 6
"""A base that is equally weak towards so many of the eight directions is round."""


def situations(support: SupportRecord, say: Language = ENGLISH) -> list[tuple[str, float | None, float]]:
    """Words for what varies, friction on the floor (None without a pedestal) and under the statue, at the ends of both."""
    listed = []
    for stone in support.pedestal:
        for floor in dict.fromkeys(support.floor_static or ()) if stone else (None,):
            for statue in dict.fromkeys(support.statue):
                said = [say("order.with" if stone else "order.without")] if len(support.pedestal) > 1 else []
                if floor is not None and _spans(support.floor_static):
                    said.append(say("order.floor_friction", push=say.percent(floor)))
                if _spans(support.statue):
                    said.append(say("order.statue_friction", push=say.percent(statue)))
                listed.append((say.listed(said) if said else "", floor, statue))
    return listed


def slips(support: SupportRecord) -> list[tuple[float, str]]:
    """The pushes from which something slides, and what, from weak to strong."""
    frictions = {
        (statue, "statue") if floor is None or statue < floor else (floor, "pedestal")
        for _, floor, statue in situations(support)
    }
    return sorted(frictions)


def support_of(scene: SceneRecord) -> SupportRecord:
    """What the statue stands on in one scene."""
    friction = scene.contact
    floor = None if scene.pedestal is None else (friction.floor_static, friction.floor_static)
    return SupportRecord([scene.pedestal is not None], floor, (friction.statue, friction.statue), [])


def _spans(span: Span | None) -> bool:
    return span is not None and span[0] < span[1]


@dataclass(frozen=True)
class PushLevel:
    """One thing that gives way: words, the push as a share of the weight, and its name among the causes of `statics.push`."""

    words: str
    push: float
    cause: str


def compass(azimuth_deg: float, say: Language = ENGLISH) -> str:
    """A direction, counter-clockwise from the right as seen from above, in words."""
    return say(f"side.{_direction(azimuth_deg)}")


def _direction(azimuth_deg: float) -> str:
    return DIRECTIONS[round(azimuth_deg / 45.0) % 8]


def bearing(scene: SceneRecord) -> Array:
    """The corners (k, 2) of the pushes borne without tipping, as shares of the weight."""
    statue = scene.statue
    foot = np.asarray(statue.footprint_m, dtype=np.float64)[:, :2]
    return np.asarray(foot / statue.centroid_height_m)


def weakest_pushes(safe: Array) -> tuple[float, list[float]]:
    """The least push that tips, and the azimuths in degrees of all sides that bear hardly more, of corners counter-clockwise."""
    edges = np.roll(safe, -1, axis=0) - safe
    lengths = np.linalg.norm(edges, axis=1)
    edges, starts = edges[lengths > 0.0], safe[lengths > 0.0]
    outward = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.linalg.norm(edges, axis=1, keepdims=True)
    distances = np.einsum("ij,ij->i", outward, starts)
    near = np.flatnonzero(distances <= distances.min() + EQUAL * abs(distances.min()))
    order = near[np.argsort(distances[near], kind="stable")]
    return float(distances.min()), [math.degrees(math.atan2(*outward[k][::-1])) for k in order]


def weakest_words(scene: SceneRecord, say: Language = ENGLISH) -> str:
    """Towards which sides the statue tips first, and from which push on; told in the scan's own axes too where it was turned."""
    least, azimuths = weakest_pushes(bearing(scene))
    names = dict[str, float]()
    for azimuth in azimuths:  # of two edges towards one side the weaker is told
        names.setdefault(compass(azimuth, say), azimuth)
    if len(names) >= EVERY_SIDE:
        return say("push.round", push=say.percent(least))
    text = say("push.weakest", sides=say.listed(names), push=say.percent(least))
    turn = scan_turn_deg(scene)
    if turn == 0.0:
        return text
    own = say.listed(f"{say.short((azimuth - turn) % 360.0, 3)}°" for azimuth in names.values())
    return f"{text} {say('push.turned', turn=say.short(turn, 3))} {say('push.own', angles=own)}"


def scan_turn_deg(scene: SceneRecord) -> float:
    """By how much the scene turns the scan about the vertical, counter-clockwise from above; 0 for a statue by numbers."""
    statue = scene.toml.get("statue")
    mesh = statue.get("mesh") if isinstance(statue, dict) else None
    turn = mesh.get("azimuth_deg") if isinstance(mesh, dict) else None
    return float(turn) % 360.0 if isinstance(turn, int | float) else 0.0


def levels(
    scene: SceneRecord, support: SupportRecord, say: Language = ENGLISH, *, across: bool = False
) -> list[PushLevel]:
    """What gives way, from weak to strong: tipping to either side, slips that come before the last of these.

    `across`: pushes come across the plane too, and tip the statue to the front and back.
    """
    statue, h, safe = scene.statue, scene.statue.centroid_height_m, bearing(scene)
    tips = {"left": statue.corner_left_m / h, "right": statue.corner_right_m / h}
    least, azimuths = weakest_pushes(safe)
    if least < (1.0 - EQUAL) * min(tips.values()):
        tips[_direction(azimuths[0])] = least
    if across:
        for side, push in zip(("back", "front"), reach_m(safe, [90.0, 270.0]).tolist(), strict=True):
            tips.setdefault(side, push)
    slides, stone = say("order.pedestal_slides"), pedestal_tips(scene, support)
    pushes = [
        *(PushLevel(say("order.tips", side=say(f"side.{side}")), push, "statue_tips") for side, push in tips.items()),
        *(
            PushLevel(_end(slides, friction, support.floor_static, say), friction, "pedestal_slides")
            for friction in dict.fromkeys(support.floor_static or ())
        ),
    ]
    most = max(level.push for level in pushes)
    others = [
        *(
            PushLevel(say("order.pedestal_tips", side=say(f"side.{side}")), push, "pedestal_tips")
            for side, push in stone.items()
        ),
        *(
            PushLevel(_end(say("order.statue_slides"), friction, support.statue, say), friction, "statue_slides")
            for friction in dict.fromkeys(support.statue)
        ),
    ]
    return sorted([*pushes, *(each for each in others if each.push < most)], key=lambda level: level.push)


def pedestal_tips(scene: SceneRecord, support: SupportRecord) -> dict[str, float]:
    """The pushes from which the pedestal tips with the statue on it, by side; none without a pedestal."""
    statue, stone = scene.statue, scene.pedestal
    if stone is None or True not in support.pedestal:
        return {}
    centre = 0.5 * (statue.corner_right_m - statue.corner_left_m)
    pushes = tipping_of_pedestal(statue.mass_kg, statue.centroid_height_m, centre, stone)
    names = {(0, 1): "right", (0, -1): "left", (1, 1): "back", (1, -1): "front"}
    return {names[side]: push for side, push in pushes.items()}


def _end(words: str, friction: float, span: Span | None, say: Language) -> str:
    if span is None or not _spans(span):
        return words
    return say("order.least" if friction == span[0] else "order.greatest", words=words)


def order_words(
    scene: SceneRecord,
    support: SupportRecord,
    push: PushRecord | None,
    *,
    rising: bool = False,
    say: Language = ENGLISH,
) -> list[str]:
    """What the order of giving way means, by situation where it differs; `push` is what a motion asks
    (`harness.statics.standstill`).

    `rising`: the shaking has an up-and-down part.
    """
    tips = [level.push for level in levels(scene, support) if level.cause == "statue_tips"]
    stone = min(pedestal_tips(scene, support).values(), default=math.inf)
    meanings = {said: say(_meaning(tips, stone, floor, statue)) for said, floor, statue in situations(support, say)}
    by_case = [
        say("order.case", where=f"{said[0].upper()}{said[1:]}", meaning=f"{text[0].lower()}{text[1:]}")
        for said, text in meanings.items()
        if len(set(meanings.values())) > 1
    ]
    return [
        *(by_case or dict.fromkeys(meanings.values())),
        *([] if push is None else [_push_words(push, support, rising, say)]),
        *([say("order.study")] if list(support.pedestal) == [True] else []),
    ]


def _meaning(tips: Sequence[float], stone: float, floor: float | None, statue: float) -> str:
    """The key of what the order of giving way means at one pair of frictions; `stone` tips the pedestal itself."""
    if floor is not None and stone < min(*tips, floor, statue):
        return "order.stone_first"
    if statue < min(*tips, math.inf if floor is None else floor):
        return "order.slides_floor" if floor is None else "order.slides_stone"
    if floor is None:
        return "order.weak_floor" if statue < max(tips) else "order.nothing_slides"
    return "order.fuse" if floor < min(tips) else "order.part" if floor < max(tips) else "order.no_protection"


def _push_words(push: PushRecord, support: SupportRecord, rising: bool, say: Language) -> str:
    """How strong the shaking is beside what gives way first under it."""
    peak, share = say.percent(push.peak, 3), push.shares[push.first]
    words = say(f"order.cause_{push.first}" if push.first.endswith("tips") else f"order.{push.first}")
    if share is None:
        without = (
            push.first == "pedestal_slides" and support.floor_static is not None and support.floor_static[0] == 0.0
        )
        return say("order.any_push", peak=peak, words=words, why=say("order.no_friction" if without else "order.drops"))
    few = share < 1.0
    times = say("order.share", share=say.percent(share, 3)) if few else say("order.times", share=say.short(share, 3))
    return say("order.pushes_rising" if rising else "order.pushes", peak=peak, times=times, words=words)


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


# A scan as it stands: its base, its weakest direction, the directions of the floor, the axes of its file and of the scene.

SCAN_SIDE: Final = 640.0
SCAN_MARGIN: Final = 70.0
MOST_FACES: Final = 4000
"""Faces of some four pixels each: more do not show."""
FROM_WEAKEST_DEG: Final = 55.0
"""The eye stands so far round from the weakest direction: the arrow is seen from its side, and before the statue."""
RAISED_DEG: Final = 25.0
CLEAR: Final = 1.15
"""Radius of the ring of directions, of the body's farthest point seen from above."""
NAMED_DEG: Final = 45
"""Every such direction has its angle beside it, but one under the arrow."""
COVERED_DEG: Final = 8.0
BASE: Final = "#0072B2"
WEAKEST: Final = "#c2185b"
LIGHT: Final = np.array([-0.4, 0.5, 0.77])
"""Where the light comes from, seen by the eye: to the right, upwards, towards it."""


def scan_picture(solid: Solid, rotation: Array, name: str, say: Language = ENGLISH) -> Picture:
    """The solid with its base and weakest direction; `rotation` (3, 3) is from the axes of the file `name` to the solid's."""
    weakest = weakest_azimuth_deg(solid.footprint_m)
    balance = float(np.rad2deg(slenderness_rose_rad(solid.footprint_m, solid.centroid_height_m, weakest)[0]))
    words = say("scan.weakest_towards", towards=f"{weakest:.0f}", balance=f"{balance:.1f}")
    standing, _ = _standing(np.asarray(solid.vertices_m), np.asarray(solid.faces), solid.footprint_m, weakest)
    view = _view(weakest)
    title = say("scan.stands", name=name, height=say.length(solid.height_m), corners=len(solid.footprint_m))
    shapes = [
        text(0.5 * SCAN_SIDE, 46.0, words, colour=WEAKEST),
        *standing,
        *_axes(view, rotation, SCAN_MARGIN, say("scan.axes_file")),
        *_axes(view, np.eye(3), SCAN_SIDE - SCAN_MARGIN, say("scan.axes_scene")),
        text(0.5 * SCAN_SIDE, 24.0, title),
    ]
    return Picture(SCAN_SIDE, SCAN_SIDE, shapes)


def directions_picture(vertices_m: Array, faces: Faces, footprint_m: Array, weakest_deg: float) -> Picture:
    """The statue on a floor on which the directions stand by their angles, no higher than it needs to be."""
    shapes, heights = _standing(vertices_m, faces, footprint_m, weakest_deg)
    top, bottom = float(heights.min()) - SCAN_MARGIN / 3.0, float(heights.max()) + SCAN_MARGIN / 3.0
    return Picture(SCAN_SIDE, bottom - top, shapes, top_px=top)


def _standing(vertices: Array, faces: Faces, footprint: Array, weakest_deg: float) -> tuple[list[str], Array]:
    """The floor's directions, the body, its base and the arrow, seen from beside the arrow; heights in pixels."""
    view = _view(weakest_deg)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    around = CLEAR * float(np.linalg.norm(vertices[:, :2], axis=1).max())
    size = max(float(np.linalg.norm(high - low)), 2.0 * around)
    scale = (SCAN_SIDE - 2 * SCAN_MARGIN) / size
    seen = plane(scale, 0.5 * (low + high) @ view[:2].T, (0.5 * SCAN_SIDE, 0.5 * SCAN_SIDE))

    def place(points: Array) -> Array:
        return seen(points @ view[:2].T)

    def level(azimuth_deg: Array | float) -> Array:
        turns = np.atleast_1d(np.deg2rad(azimuth_deg))
        return np.column_stack([np.cos(turns), np.sin(turns), np.zeros(len(turns))])

    ring = place(around * level(np.arange(0.0, 361.0, 3.0)))
    shapes = [path(ring, stroke=MUTED)]
    shapes += [
        path(place(np.outer([0.93, 1.0], around * level(azimuth))), stroke=MUTED) for azimuth in range(0, 360, 15)
    ]
    apart = (np.arange(0, 360, NAMED_DEG) - weakest_deg + 180.0) % 360.0 - 180.0
    for azimuth in np.arange(0, 360, NAMED_DEG)[np.abs(apart) > COVERED_DEG]:
        x, y = place((around + 18.0 / scale) * level(azimuth))[0].tolist()
        shapes.append(text(x, y + 4.0, f"{azimuth}°", colour=MUTED))
    towards = level(weakest_deg)
    reach = float(np.max(footprint[:, :2] @ towards[0, :2]))
    start, tip = place(np.vstack([np.zeros(3), (reach + 0.3 * size) * towards]))
    back = (start - tip) / np.linalg.norm(start - tip)
    across = np.array([-back[1], back[0]])
    head = tip + 14.0 * np.array([[0.0, 0.0], back + 0.45 * across, back - 0.45 * across])
    if len(faces) > MOST_FACES:
        vertices, faces = decimated(vertices, faces, MOST_FACES)
    shapes += [
        *_faces(vertices, faces, view, place(vertices)),
        path(place(footprint * [1.0, 1.0, 0.0]), closed=True, fill=BASE, stroke=BASE, width=2, opacity=0.35),
        path([start, tip], stroke=WEAKEST, width=3),
        path(head, closed=True, fill=WEAKEST),
    ]
    return shapes, np.concatenate([ring[:, 1], place(vertices)[:, 1], [tip[1]]])


def _view(weakest_deg: float) -> Array:
    """The axes of the eye, beside the weakest direction."""
    return eye_axes(np.deg2rad(weakest_deg + FROM_WEAKEST_DEG), np.deg2rad(RAISED_DEG))


def _faces(vertices: Array, faces: Faces, view: Array, placed: Array) -> list[str]:
    """The faces that look at the eye, the farthest first, the lighter the more they face the light."""
    order, normals = facing(vertices, faces, view[2])
    grey = np.round(120.0 + 110.0 * np.clip(normals @ (LIGHT @ view), 0.0, 1.0)).astype(int)
    colours = [f"#{value:02x}{value:02x}{value - 8:02x}" for value in grey]
    # A rim of its own colour closes the hairlines between faces.
    return [path(placed[faces[k]], closed=True, fill=colours[k], stroke=colours[k], width=0.6) for k in order]


def _axes(view: Array, rotation: Array, x: float, words: str) -> list[str]:
    """A triad at the picture's foot; the columns of `rotation` are its axes."""
    foot = np.array([x, SCAN_SIDE - SCAN_MARGIN])
    axes = {name: view[:2] @ axis * np.array([1.0, -1.0]) for name, axis in zip("xyz", rotation.T, strict=True)}
    ends = [(name, foot + 34.0 * along, *(foot + 46.0 * along).tolist()) for name, along in axes.items()]
    drawn = [
        each
        for name, end, x_name, y_name in ends
        for each in (path([foot, end], stroke=MUTED, width=2), text(x_name, y_name + 4.0, name))
    ]
    return [text(x, SCAN_SIDE - 12.0, words, size_px="11"), *drawn]


# The rose of overturning amplitudes.

CENTRE: Final = (SCAN_SIDE / 2.0, SCAN_SIDE / 2.0)
RADIUS: Final = 275.0
RINGS: Final = 6
"""Most rings of a rose."""
KEY_ROW: Final = 20.0
"""Height of a name in a rose's key."""


@dataclass(frozen=True)
class RoseCurve:
    """One curve of a rose: the peak in g by azimuth in degrees (None: it does not overturn up to the most tried)."""

    name: str
    peaks: Mapping[float, float | None]
    look: Look


def rose_of(
    drawn: Sequence[RoseCurve], most: float, unit: str, under: Sequence[str] = (), say: Language = ENGLISH
) -> Picture:
    """Curves by direction of shaking out to `most`, over the shapes `under` them, with a key below.

    Each joins neighbouring directions of all that were asked: what lies between others is not known.
    """
    asked = sorted({azimuth for curve in drawn for azimuth in curve.peaks})
    keys = [(SCAN_SIDE + 12.0 + KEY_ROW * k, curve) for k, curve in enumerate(drawn)]
    shapes = [
        *_grid(most, unit, say),
        *under,
        *(shape for curve in drawn for shape in _curve(curve, asked, most, unit, say)),
        *(path([(40.0, y), (72.0, y)], **_style(curve)) for y, curve in keys),
        *(text(80.0, y + 4.0, curve.name, "start") for y, curve in keys),
    ]
    return Picture(SCAN_SIDE, SCAN_SIDE + KEY_ROW * len(drawn) + 8.0, shapes)


def rose_places(peaks: Mapping[float, float | None], most: float) -> Array:
    """Where peaks by azimuth lie in the picture: x to the right, y of the statue's frame upwards; the largest on the rim."""
    reach = {azimuth: most if peak is None else min(peak, most) for azimuth, peak in peaks.items()}
    return plane(RADIUS / most, (0.0, 0.0), CENTRE)(polar(reach))


def _style(curve: RoseCurve) -> dict[str, Any]:
    return {"stroke": curve.look.colour, "width": curve.look.width + 0.4, "dash": curve.look.dash}


def _grid(most: float, unit: str, say: Language) -> list[str]:
    """Rings at round values, and a line every 30 degrees."""
    values = rings(most, RINGS)
    rays = {azimuth: rose_places({azimuth: most}, most)[0] - CENTRE for azimuth in range(0, 360, 30)}
    names = {f"{azimuth}°": CENTRE + 1.085 * ray for azimuth, ray in rays.items()}
    told = {f"{say.short(value)}{unit}": rose_places({75.0: value}, most)[0] for value in values}
    return [
        *(disc(*CENTRE, RADIUS * value / most, stroke=HAIRLINE) for value in values),
        *(path([CENTRE, CENTRE + ray], stroke=HAIRLINE) for ray in rays.values()),
        *(text(x, y + 4.0, words, colour=MUTED) for words, (x, y) in names.items()),
        *(text(x, y + 4.0, words, colour=MUTED, halo=True) for words, (x, y) in told.items()),
    ]


def _curve(curve: RoseCurve, asked: Sequence[float], most: float, unit: str, say: Language) -> list[str]:
    places = {
        azimuth: (x, y) for azimuth, (x, y) in zip(curve.peaks, rose_places(curve.peaks, most).tolist(), strict=True)
    }
    whole = len(places) == len(asked)
    around = [places.get(azimuth, (math.nan, math.nan)) for azimuth in [*asked, *([] if whole else asked[:1])]]
    colour = curve.look.colour
    ends = {at: say("ends.stands") if peak is None else f"{say.digits(peak)}{unit}" for at, peak in curve.peaks.items()}
    tips = {at: f"{curve.name}, {say.short(at)}°: {end}" for at, end in ends.items()}
    return [
        path(around, closed=whole, **_style(curve)),
        *(
            disc(*places[at], 3.0, fill="#fff" if peak is None else colour, stroke=colour, title=tips[at])
            for at, peak in curve.peaks.items()
        ),
    ]
