"""A body that has toppled and lies on its flank, below the rotation that counts as overturned by itself, has overturned."""

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from harness import Outcome, Run, load_scene, simulate
from harness.model import OVERTURN_RAD
from tests import budgets_engines as budget
from tests.engines_for_tests import ready


def turned(profile: list[tuple[float, float]]) -> trimesh.Trimesh:
    return trimesh.creation.revolve(np.array(profile), sections=24)


def armed() -> trimesh.Trimesh:
    trunk, arms = trimesh.creation.box((0.3, 0.25, 1.2)), trimesh.creation.box((1.0, 0.1, 0.12))
    trunk.apply_translation((0.0, 0.0, 0.6))
    arms.apply_translation((0.0, 0.0, 0.9))
    return trimesh.boolean.union([trunk, arms])


def boulder() -> trimesh.Trimesh:
    """A stone on a narrow, slightly rough foot, dented all over."""
    stream = np.random.default_rng(0)
    found = turned([(0.0, 0.0), (0.12, 0.0), (0.27, 0.6), (0.29, 0.75), (0.27, 0.8), (0.0, 0.81)])
    points = found.vertices.copy()
    foot = points[:, 2] < 0.01
    points[~foot] *= 1.0 + 0.02 * stream.standard_normal((int((~foot).sum()), 3))
    points[foot, 2] = 3e-4 * stream.random(int(foot.sum()))
    return trimesh.Trimesh(points, found.faces).convex_hull


BODIES = {
    "vase": (turned([(0.0, 0.0), (0.15, 0.0), (0.42, 0.9), (0.41, 1.0), (0.0, 1.0)]), 0.3),
    "cone on its point": (turned([(0.0, 0.0), (0.12, 0.0), (0.4, 0.8), (0.0, 0.8)]), 0.3),
    "statue with arms": (armed(), 0.4),
    "boulder": (boulder(), 0.3),
}


def run(folder: Path, body: str, engine: str, *, across: bool = False) -> Run:
    ready(engine)
    mesh, amplitude_g = BODIES[body]
    mesh.export(folder / "body.ply")
    weak, strong = (f'kind = "harmonic"\namplitude_g = {size}\nfrequency_hz = 1.0\n' for size in (0.01, amplitude_g))
    x, y = (weak, strong) if across else (strong, "")
    (folder / "scene.toml").write_text(
        'title = "toppling"\nduration_s = 4.0\n[statue]\n'
        'mesh = { file = "body.ply", unit = "m", up = "z", density_kg_m3 = 2700.0 }\n'
        f"[contact]\nstatue = 0.7\n[motion.x]\n{x}" + (f"[motion.y]\n{y}" if y else "")
    )
    return simulate(load_scene(folder / "scene.toml"), engine, dt_s=1e-3)


@pytest.mark.parametrize("engine", ["pymunk", "pybullet"])
@pytest.mark.parametrize("body", BODIES)
def test_what_lies_on_its_flank_has_overturned(tmp_path: Path, body: str, engine: str) -> None:
    """The shaking goes on to the end: what lies there is judged all the same."""
    found, model = run(tmp_path, body, engine), run(tmp_path, body, "analytic")
    end = abs(float(found.history.theta_rad[-1]))
    assert 1.0 < end < OVERTURN_RAD
    assert found.outcome is model.outcome
    assert found.outcome.overturned
    assert found.no_return_time_s is not None
    assert model.no_return_time_s is not None
    # The boulder's foot is rough: each engine rests on other vertices of it at first.
    if body != "boulder":
        assert found.no_return_time_s == pytest.approx(model.no_return_time_s, abs=budget.TOPPLED_S)
    assert found.no_return_time_s < found.overturn_time_s < found.end_s == 4.0
    tilt = np.arccos(np.cos(found.history.extra.get("out_of_plane_rad", 0.0)) * np.cos(found.history.theta_rad))
    assert np.interp(found.overturn_time_s, found.history.t_s, tilt) == pytest.approx(tilt[-1], abs=budget.LYING_RAD)
    assert np.max(tilt[found.history.t_s < found.overturn_time_s]) <= tilt[-1]


def test_a_fall_across_the_plane_is_no_stand(tmp_path: Path) -> None:
    """On its flank across the plane the planar rotation may be anything, zero too."""
    found = run(tmp_path, "vase", "pybullet", across=True)
    across = float(found.history.extra["out_of_plane_rad"][-1])
    assert found.outcome is (Outcome.OVERTURNED_BACK if across > 0.0 else Outcome.OVERTURNED_FRONT)
    assert math.cos(across) * math.cos(float(found.history.theta_rad[-1])) > math.cos(OVERTURN_RAD)
    assert found.no_return_time_s < found.overturn_time_s < found.end_s
