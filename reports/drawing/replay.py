"""What the 3D replay needs: the statue's mesh once, and each model's recorded motion as a few numbers per frame."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.model.history import History
from harness.model.scene import SOLID_COLUMNS
from harness.records.scene import MotionRecord, SceneRecord
from reports.charts.figure import look
from reports.charts.histories import packed_array
from reports.drawing.display_mesh import display_mesh
from reports.drawing.kinematics import poses, section
from reports.pages.assets import packed_json
from reports.source import RunSource, run_event_s

Array = NDArray[np.float64]

FRAME_S: Final = 0.005
"""Step of the frames kept; the page interpolates between them, so that slow replay stays smooth."""
MOST_FRAMES: Final = 20_000
MESH_LEVELS: Final = 2**13
"""Steps over each extent of the mesh: a quarter of a millimetre in 2 m, a fifth of a pixel."""


def replay_payload(source: RunSource) -> str:
    """The replay's data, packed."""
    shape = section(source.scene)
    statue, pedestal = source.scene.statue, source.scene.pedestal
    vertices, faces = display_mesh(source.mesh, shape, statue.depth_m)
    end = max(float(item.t_s[-1]) for item in source.histories.values())
    step = max(FRAME_S, end / MOST_FRAMES)
    names = list(source.runs)
    payload = {
        "step_s": step,
        "begin_s": run_event_s(source)[0],
        "end_s": end,
        "corner_left_m": shape.corner_left_m,
        "corner_right_m": shape.corner_right_m,
        "height_m": statue.height_m,
        "depth_m": statue.depth_m,
        "pedestal": pedestal,
        "wall": source.scene.wall,
        "mesh": {
            "positions": [packed_array(column, MESH_LEVELS) for column in vertices.T],
            "index": [packed_array(column) for column in faces.T],
            "own": source.mesh is not None,
        },
        "models": [
            {"name": name, "colour": look(name, names).colour, **_frames(source.scene, history, step)}
            for name, history in source.histories.items()
        ],
        "floor": _floor(source.record.motion, source.scene.gravity_m_s2, step, end),
    }
    return packed_json(payload)


def _frames(scene: SceneRecord, history: History, step_s: float) -> dict[str, object]:
    """The model's rotation and the poses of its bodies by frame; what stays nought is left out."""
    end = float(history.t_s[-1])
    t_s = np.append(np.arange(0.0, end, step_s), end)
    columns = {"theta_rad": np.interp(t_s, history.t_s, history.theta_rad), **poses(scene, history, t_s)}
    return {"end_s": end, "frames": {name: packed_array(values) for name, values in columns.items() if np.any(values)}}


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
