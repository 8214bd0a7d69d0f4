"""The machine's own browser for the tests that open pages."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from reports.pages.page import CONSERVATOR_NAME, write_report
from tests.measures.page_cost import NoBrowser, chromium
from tests.reports.every_kind import WRITERS


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    try:
        with chromium() as found:
            yield found
    except NoBrowser as missing:
        pytest.skip(str(missing))


@pytest.fixture(scope="session")
def page_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The page of an invented record of a kind, or with "plain" before it the conservator's; written once for all tests."""
    base = tmp_path_factory.mktemp("pages")

    @cache
    def written(kind: str) -> Path:
        return write_report(WRITERS[kind](base / kind))

    def found(name: str) -> Path:
        page = written(name.removeprefix("plain "))
        return page.with_name(CONSERVATOR_NAME) if name.startswith("plain ") else page

    return found
