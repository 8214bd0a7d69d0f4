"""Solids that several mesh tests share."""

import pytest

from meshes import Solid, solid_from_mesh
from meshes.prepare import Prepared, Wanted, prepare_mesh
from tests.meshes import togatus
from tests.meshes.scanner import COARSE, scan
from tests.meshes.shapes import box


@pytest.fixture(scope="session")
def statue() -> Solid:
    """The generated togatus."""
    return togatus.build()


@pytest.fixture(scope="session")
def noisy(statue: Solid) -> Prepared:
    """A scan with every fault, prepared with the unit alone known."""
    return prepare_mesh(scan(statue, COARSE), Wanted(unit="mm", max_faces=30_000))


@pytest.fixture(scope="session")
def block() -> Solid:
    """A box of 0.4 by 0.7 by 1.5 m, of 2700 kg/m³."""
    return solid_from_mesh(*box(0.4, 0.7, 1.5), density_kg_m3=2700.0)
