"""What the model takes as a scan's base, and what it says of a part beyond it that comes down before the balance."""

import math
from pathlib import Path

import numpy as np
import pytest

from harness import Verdict, load_scene, run_scene
from harness.model import Severity, block_of
from meshes.mesh import RawMesh
from tests import doubles
from tests.meshes.scanner import write

HALF_M, PLINTH_M, ABOVE_M = 0.12, 0.17, 0.004
"""Half of the base, of a plinth's edge that stands out over it, and how far above the base plane that is."""
PROPOSED_M = 0.0041
"""To a tenth of a millimetre, and more than what the file's single precision makes of it."""
SCENE = """
title = "a column on a plinth that stands out"
duration_s = 3.0
[statue.mesh]
file = "column.ply"
density_kg_m3 = 2400.0
[motion.x]
kind = "pulse"
shape = "one_sine"
amplitude_g = 0.25
duration_s = 1.0
"""


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    """A convex column of 1.2 m, its widest some millimetres above its base."""
    import trimesh

    corners = np.array([[x, y] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    rings = [(HALF_M, 0.0), (PLINTH_M, ABOVE_M), (0.15, 1.2)]
    points = np.vstack([np.column_stack([half * corners, np.full(4, z)]) for half, z in rings])
    hull = trimesh.convex.convex_hull(points)
    write(RawMesh(np.asarray(hull.vertices), np.asarray(hull.faces), "column"), tmp_path / "column.ply")
    (tmp_path / "scene.toml").write_text(SCENE)
    return tmp_path / "scene.toml"


LEAN_RAD = math.atan2(ABOVE_M, PLINTH_M - HALF_M)


def test_a_part_beyond_the_base_ends_the_model_s_domain_and_is_told(scene_file: Path) -> None:
    scene = load_scene(scene_file)
    assert block_of(scene).base_ends_rad == pytest.approx((LEAN_RAD, LEAN_RAD), rel=1e-6)
    told = [each for each in scene.findings if each.code == "part_beyond_base"]
    assert [(each.severity, each.values["side"], each.values["tolerance_m"]) for each in told] == [
        (Severity.CAUTION, "left", PROPOSED_M),
        (Severity.CAUTION, "right", PROPOSED_M),
    ]
    result = run_scene(scene, ["analytic", "pymunk"])
    model, engine = result.runs["analytic"], result.runs["pymunk"]
    assert abs(model.peak_theta_rad) > LEAN_RAD
    assert model.validity["left_domain_by"] == "beyond_base"
    assert "left_domain" in doubles.codes(result.findings())
    left_s = model.validity["left_domain_s"]
    assert isinstance(left_s, float)
    before = engine.history.t_s < left_s
    apart = np.abs(np.interp(engine.history.t_s, model.history.t_s, model.history.theta_rad) - engine.history.theta_rad)
    assert apart[before].max() < 1e-3, "the same motion up to there"
    assert apart.max() > 0.01, "and another one from there"
    assert result.scores["analytic_vs_pymunk"].verdict is Verdict.DOMAIN


def test_the_exact_body_leaves_its_domain_there_too(scene_file: Path) -> None:
    told = [f"motion.x.amplitude_g={each}" for each in (0.25, 0.12)]
    rocking, still = (run_scene(load_scene(scene_file, [each]), ["spatial"]).runs["spatial"] for each in told)
    assert rocking.validity["left_domain_by"] == "beyond_base"
    assert "left_domain" in doubles.codes(rocking.findings)
    left_s = rocking.validity["left_domain_s"]
    assert isinstance(left_s, float)
    assert abs(float(rocking.history.at(left_s))) == pytest.approx(LEAN_RAD, abs=2e-3)
    assert "left_domain_s" not in still.validity
    wider = load_scene(scene_file, [told[0], f"statue.mesh.contact_tolerance_m={PROPOSED_M}"])
    assert "left_domain_s" not in run_scene(wider, ["spatial"]).runs["spatial"].validity


def test_with_the_tolerance_that_is_proposed_it_is_part_of_the_base(scene_file: Path) -> None:
    scene = load_scene(scene_file, [f"statue.mesh.contact_tolerance_m={PROPOSED_M}"])
    assert block_of(scene).base_ends_rad == (math.inf, math.inf)
    assert "part_beyond_base" not in doubles.codes(scene.findings)
    result = run_scene(scene, ["analytic", "pymunk"])
    assert result.scores["analytic_vs_pymunk"].verdict is Verdict.AGREE


def test_a_statue_balances_over_its_outer_corner_where_that_is(scene_file: Path) -> None:
    scene = load_scene(scene_file, [f"statue.mesh.contact_tolerance_m={PROPOSED_M}"])
    for side in (1, -1):
        balance_rad = scene.statue.slenderness_rad(side)
        assert balance_rad == block_of(scene).alpha_rad(side)
        assert balance_rad == pytest.approx(math.atan2(PLINTH_M, scene.statue.centroid_height_m - ABOVE_M), rel=1e-6)


@pytest.mark.parametrize(("width_m", "ends"), [(0.3, False), (0.4, True)])
def test_beside_the_pedestal_s_top_nothing_comes_down(scene_file: Path, width_m: float, ends: bool) -> None:
    pedestal = {"mass_kg": 200.0, "width_m": width_m, "depth_m": 0.5, "height_m": 0.2}
    scene = load_scene(scene_file, [f"pedestal.{key}={value}" for key, value in pedestal.items()])
    assert (min(block_of(scene).base_ends_rad) < math.inf) is ends
    assert ("part_beyond_base" in doubles.codes(scene.findings)) is ends


def test_draws_past_the_base_are_answered_by_an_engine(scene_file: Path) -> None:
    from harness.questions.assess.probability import assess_models

    found = assess_models(load_scene(scene_file))["analytic"]
    assert found.left_domain > 0.0
    assert found.sampler == "pymunk"
    assert found.sampled > 0
    assert found.low < found.high
