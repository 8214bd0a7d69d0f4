"""The collision shape that a scene needs: planes, a convex statue, a concave one."""

from __future__ import annotations

from harness.mesh_statue import statue_of
from harness.shape_need import HULL_EXCESS_LIMIT, shape_needed
from meshes import togatus
from tests.scenes_for_tests import paestum


def test_the_choice() -> None:
    figure = statue_of(togatus.build())
    assert shape_needed(paestum(0.3, 2.0, pedestal=False).but(statue=figure)).shape == "base"
    assert shape_needed(paestum(0.3, 2.0)).shape == "hull"
    need = shape_needed(paestum(0.3, 2.0).but(statue=figure))
    assert need.shape == "parts"
    assert need.hull_excess_rel > HULL_EXCESS_LIMIT
    assert 0.0 < need.below_m <= figure.height_m
