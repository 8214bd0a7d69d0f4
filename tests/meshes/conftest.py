"""Solids that several mesh tests share."""

import pytest

from meshes import Solid
from meshes.prepare import Prepared, Wanted, prepare_mesh
from tests.meshes import togatus
from tests.meshes.scanner import COARSE, scan


@pytest.fixture(scope="session")
def statue() -> Solid:
    """The generated togatus."""
    return togatus.build()


@pytest.fixture(scope="session")
def noisy(statue: Solid) -> Prepared:
    """A scan with every fault, prepared with the unit alone known."""
    return prepare_mesh(scan(statue, COARSE), Wanted(unit="mm", max_faces=30_000))
