"""The machine's own browser for the tests that open pages."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tests.measures.page_cost import NoBrowser, chromium


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    try:
        with chromium() as found:
            yield found
    except NoBrowser as missing:
        pytest.skip(str(missing))
