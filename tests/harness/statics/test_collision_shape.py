"""The collision shape that a scene needs: planes, a convex statue, a concave one; what the plan says of it."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest

from harness import RunOptions, engines
from harness.input.mesh_statue import statue_of
from harness.model import Wall
from harness.statics.plan import HULL_EXCESS_LIMIT, plan, shape_needed
from meshes import decomposition
from tests.meshes import togatus
from tests.scenes_for_tests import paestum


def test_the_choice() -> None:
    figure = statue_of(togatus.build())
    assert shape_needed(replace(paestum(0.3, 2.0, pedestal=False), statue=figure)).shape == "base"
    assert shape_needed(paestum(0.3, 2.0)).shape == "hull"
    need = shape_needed(replace(paestum(0.3, 2.0), statue=figure))
    assert need.shape == "parts"
    assert need.excess > HULL_EXCESS_LIMIT
    assert 0.0 < need.below_m <= figure.height_m


def told(name: str, *, pedestal: bool, wall: bool = False, mesh: bool = True) -> Mapping[str, Any]:
    """The values of the plan's row on shapes for one engine; none where it has none."""
    scene = paestum(0.3, 2.0, pedestal=pedestal)
    scene = replace(
        scene, statue=statue_of(togatus.build()) if mesh else scene.statue, wall=Wall("right", 0.05) if wall else None
    )
    rows = [step for step in plan(scene, [engines.load(name)], RunOptions()) if step.skip == "base_only"]
    return rows[0].reason.values if rows else {}


def test_the_plan_says_which_shape_and_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decomposition, "decompose", None)  # a plan decomposes nothing
    parts = told("pybullet", pedestal=True)
    assert (parts["shape"], parts["wall"]) == ("parts", None)
    assert parts["excess"] > parts["limit"] == HULL_EXCESS_LIMIT
    assert told("pybullet", pedestal=True, mesh=False)["shape"] == "hull"
    on_floor = told("pybullet", pedestal=False, wall=True)
    assert (on_floor["shape"], on_floor["wall"]) == ("base", "right")
    monkeypatch.setattr(decomposition, "missing", lambda: "coacd is not installed")
    assert told("pybullet", pedestal=True)["missing"] == "coacd is not installed"


@pytest.mark.parametrize("name", engines.REGISTRY)
def test_an_engine_without_a_choice_says_what_it_takes(name: str) -> None:
    engine = engines.load(name)
    chooses, touches = "base_only" in engine.capabilities.skips, engine.capabilities.own_impact
    assert bool(engine.capabilities.edge_shape) == (touches and not chooses)
    if touches and not chooses:
        assert engine.capabilities.edge_shape == told(name, pedestal=True)["shape"]
        assert told(name, pedestal=False) == {}
