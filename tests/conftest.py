"""Fixtures shared by all tests."""

import gc
import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent


FAST = frozenset((ROOT / "tests" / "fast.txt").read_text(encoding="utf-8").split())
"""Files of the fast tier, as measured: `python -m tests.measures.tiers` renews the list."""


def tier_of(path: str) -> str:
    """The tier of a file of tests."""
    if path.startswith("tests/measures/"):
        return "measures"
    return "fast" if path in FAST else "engines"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark every test with its tier; the slow ones come first, so that at the end no worker waits for one of them."""
    for item in items:
        item.add_marker(tier_of(item.path.relative_to(ROOT).as_posix()))
    items.sort(key=lambda item: item.get_closest_marker("slow") is None)


def pytest_collection_finish() -> None:
    """What was imported and collected lives to the end: no garbage is looked for in it again."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session")
def root() -> Path:
    """The project's folder."""
    return ROOT


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """The folder of real scans and records, or a skip that says why."""
    folder = Path(os.environ.get("ROCKCHECK_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"real data absent: {folder} is not a folder (set ROCKCHECK_DATA)")
    return folder
