"""A scan as it stands: its base, its weakest direction, the directions of the floor, the axes of its file and of the scene."""

from typing import Final

import numpy as np

from harness.model import Array
from meshes.footprint import slenderness_rose_rad, weakest_azimuth_deg
from meshes.solid import Solid
from reports.charts.figure import MUTED
from reports.drawing.kinematics import Faces, decimated, eye_axes, facing
from reports.drawing.shapes import Picture, path, plane, text
from reports.messages import ENGLISH, Language

SIDE: Final = 640.0
MARGIN: Final = 70.0
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
        text(0.5 * SIDE, 46.0, words, colour=WEAKEST),
        *standing,
        *_axes(view, rotation, MARGIN, say("scan.axes_file")),
        *_axes(view, np.eye(3), SIDE - MARGIN, say("scan.axes_scene")),
        text(0.5 * SIDE, 24.0, title),
    ]
    return Picture(SIDE, SIDE, shapes)


def directions_picture(vertices_m: Array, faces: Faces, footprint_m: Array, weakest_deg: float) -> Picture:
    """The statue on a floor on which the directions stand by their angles, no higher than it needs to be."""
    shapes, heights = _standing(vertices_m, faces, footprint_m, weakest_deg)
    top, bottom = float(heights.min()) - MARGIN / 3.0, float(heights.max()) + MARGIN / 3.0
    return Picture(SIDE, bottom - top, shapes, top_px=top)


def _standing(vertices: Array, faces: Faces, footprint: Array, weakest_deg: float) -> tuple[list[str], Array]:
    """The floor's directions, the body, its base and the arrow, seen from beside the arrow; heights in pixels."""
    view = _view(weakest_deg)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    around = CLEAR * float(np.linalg.norm(vertices[:, :2], axis=1).max())
    size = max(float(np.linalg.norm(high - low)), 2.0 * around)
    scale = (SIDE - 2 * MARGIN) / size
    seen = plane(scale, 0.5 * (low + high) @ view[:2].T, (0.5 * SIDE, 0.5 * SIDE))

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
    foot = np.array([x, SIDE - MARGIN])
    axes = {name: view[:2] @ axis * np.array([1.0, -1.0]) for name, axis in zip("xyz", rotation.T, strict=True)}
    ends = [(name, foot + 34.0 * along, *(foot + 46.0 * along).tolist()) for name, along in axes.items()]
    drawn = [
        each
        for name, end, x_name, y_name in ends
        for each in (path([foot, end], stroke=MUTED, width=2), text(x_name, y_name + 4.0, name))
    ]
    return [text(x, SIDE - 12.0, words, size_px="11"), *drawn]
