"""Past the reading of a record no table is open: `[str, Any]`, where a misspelled key is seen by nobody, only ever gets rarer."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

from tests.budgets_records import OPEN_TABLES

OPEN = re.compile(r"\[str, Any\]")
PACKAGES = ("analytic", "meshes", "harness", "reports")


def room_of(path: Path) -> str:
    """The room of a module: its package, and the folder within where harness and reports have one."""
    package, *rest = path.parts
    deep = package in ("harness", "reports") and len(rest) > 1
    return f"{package}/{rest[0]}" if deep else package


def open_tables(root: Path) -> Counter[str]:
    found: Counter[str] = Counter()
    for path in (item for package in PACKAGES for item in (root / package).rglob("*.py")):
        found[room_of(path.relative_to(root))] += len(OPEN.findall(path.read_text(encoding="utf-8")))
    return +found


@pytest.fixture(scope="module")
def found(root: Path) -> Counter[str]:
    return open_tables(root)


@pytest.mark.parametrize("room", OPEN_TABLES)
def test_a_room_holds_no_more_open_tables_than_it_may(found: Counter[str], room: str) -> None:
    assert found[room] <= OPEN_TABLES[room], "type what is read, or raise nothing"


def test_a_room_that_is_not_named_holds_none(found: Counter[str]) -> None:
    assert found.keys() <= OPEN_TABLES.keys()


def test_an_open_table_is_seen(tmp_path: Path) -> None:
    for package in PACKAGES:
        (tmp_path / package / "room").mkdir(parents=True)
    (tmp_path / "harness" / "room" / "a.py").write_text("def f(x: dict[str, Any]) -> Mapping[str, Any]: ...\n")
    (tmp_path / "reports" / "b.py").write_text("x: list[tuple[str, Any]]\n")
    assert open_tables(tmp_path) == {"harness/room": 2, "reports": 1}
