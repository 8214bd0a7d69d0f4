"""The machine's own browser for the tests that open pages."""

import shutil
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from harness.records.base import Record, read_result
from reports.pages.page import CONSERVATOR_NAME, write_report
from reports.source import RunSource, run_source
from tests.measures.page_cost import NoBrowser, chromium
from tests.reports.every_kind import RUNS, WRITERS


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    try:
        with chromium() as found:
            yield found
    except NoBrowser as missing:
        pytest.skip(str(missing))


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The folder of an invented record by its kind, written once for all tests that only read it."""
    base = tmp_path_factory.mktemp("written")
    writers = {**WRITERS, **RUNS}
    return cache(lambda kind: writers[kind](base / kind))


@pytest.fixture(scope="session")
def record_of(written: Callable[[str], Path]) -> Callable[[str], Record]:
    """An invented record by its kind."""
    return cache(lambda kind: read_result(written(kind)))


@pytest.fixture(scope="session")
def source(written: Callable[[str], Path]) -> RunSource:
    """An invented run whose models agree, with a pedestal and a wall."""
    return run_source(written("agreed"))


@pytest.fixture(scope="session")
def page_of(written: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The page of an invented record of a kind, or with "plain" before it the conservator's; written once for all tests."""
    base = tmp_path_factory.mktemp("pages")
    report = cache(lambda kind: write_report(shutil.copytree(written(kind), base / kind)))

    def found(name: str) -> Path:
        page = report(name.removeprefix("plain "))
        return page.with_name(CONSERVATOR_NAME) if name.startswith("plain ") else page

    return found
