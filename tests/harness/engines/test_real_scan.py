"""A real scan under a real record in three directions: the exact body stands on the same ragged base as pybullet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analytic import spatial
from harness import engines
from harness.engines.spatial import problem_of
from harness.input.scene_file import load_scene
from harness.model.options import RunOptions
from tests import budgets_spatial_reference as budget

FIRST_IMPACTS_S = 8.2
"""Two impacts after 7.5 s of rest; later flight and sliding tell pybullet's friction from Coulomb's."""


def test_a_scan_shaken_in_space_is_the_same_in_pybullet_and_exactly(root: Path, data_dir: Path) -> None:
    """Its base has 26 points within a millimetre that can touch, of which the outline holds 16."""
    pytest.importorskip("pybullet")
    if not (data_dir / "meshes" / "maria_acephalous.obj").is_file():
        pytest.skip(f"real data absent: {data_dir}")
    scene = load_scene(root / "scenes" / "maria.toml", motion__scale=2.5, duration_s=FIRST_IMPACTS_S)
    assert (len(scene.statue.footprint_m), len(scene.statue.feet_m)) == (16, 26)
    turns = []
    for name, level in (("spatial", 0), ("pybullet", -1)):
        engine = engines.load(name)
        run = engine.simulate(scene, engine.refinement_levels(scene)[level], RunOptions())
        assert run.history is not None
        columns = [run.history.extra[f"{axis}_rad"][:-1] for axis in ("roll", "pitch", "yaw")]
        turns.append(Rotation.from_euler("xyz", np.column_stack(columns)))
    assert np.max(turns[0].magnitude()) > budget.SCAN_ROCKS_RAD
    assert np.max((turns[0] * turns[1].inv()).magnitude()) < budget.SCAN_RAD


def test_outcomes_of_a_scan_are_decided_at_every_friction(root: Path, data_dir: Path) -> None:
    """A ragged base lands on a vertex beside another that slides: a rebound dropped at one pushed the other down, without end."""
    if not (data_dir / "meshes" / "maria_acephalous.obj").is_file():
        pytest.skip(f"real data absent: {data_dir}")
    problem = problem_of(load_scene(root / "scenes" / "maria.toml"))
    friction = np.linspace(0.5, 0.9, 9)
    runs = spatial.outcomes(
        problem, {"friction": friction, "scale": np.full(9, 2.0)}, most_steps=budget.SCAN_STEPS, threads=1
    )
    assert set(runs.outcomes) <= {spatial.Outcome.STANDS, spatial.Outcome.OVERTURNED}
