"""Solids that several mesh tests share."""

from __future__ import annotations

import pytest

from meshes import Solid
from tests.meshes import togatus


@pytest.fixture(scope="session")
def statue() -> Solid:
    """The generated togatus."""
    return togatus.build()
