"""The maps in CONTRIBUTING.md name every module and room of a package, once, and none that is not there."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

PACKAGES = ("harness", "analytic", "meshes", "reports")
CHECKS = ("fuzz", "measures")
"""Folders of tests that are commands: mutated input files, and what the whole must reach."""
ROW = re.compile(r"^\| ((?:`[a-z0-9_]+(?:\.py|/)` ?)+)\|", re.M)
ASIDE = re.compile(r"\(`(\w+\.py)`:")
"""A module told in brackets beside the room that it serves."""


def told(page: str, package: str) -> Counter[str]:
    """Names in the first column of a package's table, and those in brackets."""
    table = page.partition(f"### `{package}/`, ")[2].partition("\n#")[0]
    return Counter(re.findall(r"`([^`]+)`", "".join(ROW.findall(table))) + ASIDE.findall(table))


def there(folder: Path) -> set[str]:
    """Modules and rooms of a folder."""
    rooms = {f"{path.parent.name}/" for path in folder.glob("*/__init__.py")}
    return rooms | {path.name for path in folder.glob("*.py") if path.name != "__init__.py"}


@pytest.mark.parametrize("package", PACKAGES)
def test_the_map_is_the_territory(root: Path, package: str) -> None:
    found = told((root / "CONTRIBUTING.md").read_text(encoding="utf-8"), package)
    assert set(found) == there(root / package)
    assert set(found.values()) == {1}


def test_what_has_no_place_or_two_is_seen(tmp_path: Path) -> None:
    page = "### `house/`, a map\n| where | what |\n| `a.py` `room/` | (`b.py`: beside) |\n| `a.py` | again |\n## Next\n"
    found = told(page, "house")
    assert found == {"a.py": 2, "room/": 1, "b.py": 1}
    (tmp_path / "room").mkdir()
    for name in ("__init__.py", "a.py", "b.py", "room/__init__.py"):
        (tmp_path / name).touch()
    assert there(tmp_path) == set(found)
    (tmp_path / "utils.py").touch()
    assert there(tmp_path) - set(found) == {"utils.py"}


def test_tests_mirror_the_rooms(root: Path) -> None:
    """Every folder of tests is a package, or what checks them all; every folder of tests/harness a room of it."""
    whole = {f"{name}/" for name in PACKAGES} | {f"{name}/" for name in CHECKS}
    for place, rooms in (("", whole), ("harness", there(root / "harness"))):
        folders = {f"{path.parent.name}/" for path in (root / "tests" / place).glob("*/*.py")}
        assert folders
        assert folders <= rooms
