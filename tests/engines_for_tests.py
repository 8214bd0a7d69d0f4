"""The engines as tests ask for them."""

import pytest

from harness import engines
from harness.engines.base import Engine


def ready(name: str) -> Engine:
    """The engine, or a skip that says why it cannot run here."""
    engine = engines.load(name)
    reason = engine.missing()
    if reason is not None:
        pytest.skip(reason)
    return engine
