"""A scene as plain values: what a page draws and what a reader needs to repeat the run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import Excitation, ZeroExcitation
from harness.model.run import to_plain
from harness.model.scene import Scene
from harness.statics.push import peak_within_m_s2, push_of

Array = NDArray[np.float64]

MOTION_SAMPLES: Final = 4001
"""Most samples of the floor's motion kept for drawing; each is the value of largest size in its interval."""


def describe(scene: Scene) -> dict[str, Any]:
    """The resolved scene as plain JSON values (arrays as lists), without its mesh."""
    statue = scene.statue
    record = {
        "title": scene.title,
        "file": None if scene.source is None else scene.source.name,
        "duration_s": scene.duration_s,
        "gravity_m_s2": scene.gravity_m_s2,
        "model": {
            "friction_normal": scene.form.friction_normal,
            "pedestal_at_impact": scene.form.pedestal_at_impact,
        },
        "statue": {
            "mass_kg": statue.mass_kg,
            "centroid_height_m": statue.centroid_height_m,
            "corner_left_m": statue.corner_left_m,
            "corner_right_m": statue.corner_right_m,
            "slenderness_left_rad": statue.slenderness_rad(-1),
            "slenderness_right_rad": statue.slenderness_rad(1),
            "inertia_kg_m2": statue.inertia_kg_m2,
            "inertia_tensor_kg_m2": statue.inertia_tensor_kg_m2,
            "height_m": statue.height_m,
            "depth_m": statue.depth_m,
            "section_m": statue.section_m,
            "footprint_m": statue.footprint_m,
            "mesh": None
            if statue.solid is None
            else {"vertices": len(statue.solid.vertices_m), "faces": len(statue.solid.faces)},
        },
        "pedestal": None if scene.pedestal is None else vars(scene.pedestal),
        "contact": vars(scene.contact),
        "wall": None if scene.wall is None else {**vars(scene.wall), "touching_rotation_rad": scene.wall_rotation_rad},
        "initial": asdict(scene.initial),
        "table": scene.table,
        "output_dt_s": scene.output_dt_s,
        "toml": scene.given,
    }
    plain: dict[str, Any] = to_plain(record)
    return plain


def motion_of(scene: Scene) -> dict[str, Any]:
    """The floor's accelerations for drawing: `t_s` and `x_m_s2`, `y_m_s2`, `z_m_s2` where they are not at rest.

    Where it moves along x and y, `level_m_s2` (n, 2) holds both at the instants of their largest sum; `push` says what the
    motion asks of the statue at rest (`harness.statics.push`).
    """
    t_s = np.linspace(0.0, scene.duration_s, MOTION_SAMPLES)
    found: dict[str, Any] = {"t_s": t_s}
    for axis, item in (("x", scene.base_excitation.x), ("y", scene.base_excitation.y), ("z", scene.base_excitation.z)):
        if not isinstance(item, ZeroExcitation):
            found[f"{axis}_m_s2"] = _extremes(item, t_s)
            found[f"{axis}_peak_m_s2"] = peak_within_m_s2(item, scene.duration_s)
            found[f"{axis}_is"] = repr(item) if not hasattr(item, "t_s") else f"record of {len(item.t_s)} samples"
    level = (scene.base_excitation.x, scene.base_excitation.y)
    if not all(isinstance(item, ZeroExcitation) for item in level):
        found["push"] = push_of(scene).as_dict()
    if not any(isinstance(item, ZeroExcitation) for item in level):
        found["level_m_s2"] = _largest(level, t_s)
    plain: dict[str, Any] = to_plain(found)
    return plain


def _extremes(item: Excitation, t_s: Array) -> Array:
    """The value of largest size among ten samples of each interval, so that no peak is lost in a drawing."""
    return _largest((item,), t_s)[:, 0]


def _largest(items: Sequence[Excitation], t_s: Array) -> Array:
    """The values (n, k) of all items at the instant of their largest sum as vectors, among ten samples of each interval."""
    step = t_s[1] - t_s[0]
    fine = np.clip(t_s[:, None] + step * (np.arange(10) - 5.0) / 10.0, 0.0, t_s[-1])
    values = np.stack([np.asarray(item.accel_m_s2(fine.ravel())).reshape(fine.shape) for item in items], axis=2)
    return np.asarray(values[np.arange(len(t_s)), np.argmax((values**2).sum(axis=2), axis=1)])
