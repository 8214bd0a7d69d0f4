"""The map of `harness/` in CONTRIBUTING.md names every module and room that is there, once, and none that is not."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

ROW = re.compile(r"^\| ((?:`[a-z0-9_]+(?:\.py|/)` ?)+)\|", re.M)


def told(page: str) -> Counter[str]:
    """Names in the first column of the table below "A scene's way through `harness/`", and in its brackets."""
    table = page[page.index("A scene's way through `harness/`") : page.index("## Add an engine")]
    rows = "".join(ROW.findall(table))
    return Counter(re.findall(r"`([^`]+)`", rows) + re.findall(r"\(`(\w+\.py)`:", table))


def there(folder: Path) -> set[str]:
    """Modules and rooms of a folder."""
    rooms = {f"{path.parent.name}/" for path in folder.glob("*/__init__.py")}
    return rooms | {path.name for path in folder.glob("*.py") if path.name != "__init__.py"}


def test_the_map_is_the_territory(root: Path) -> None:
    found = told((root / "CONTRIBUTING.md").read_text(encoding="utf-8"))
    assert set(found) == there(root / "harness")
    assert set(found.values()) == {1}


def test_a_module_without_a_place_is_seen(root: Path, tmp_path: Path) -> None:
    found = told((root / "CONTRIBUTING.md").read_text(encoding="utf-8"))
    for name in found:
        path = tmp_path / (f"{name}__init__.py" if name.endswith("/") else name)
        path.parent.mkdir(exist_ok=True)
        path.touch()
    assert there(tmp_path) == set(found)
    (tmp_path / "utils.py").touch()
    assert there(tmp_path) - set(found) == {"utils.py"}


def test_tests_mirror_the_rooms(root: Path) -> None:
    """Every folder of tests/harness is a room of harness/."""
    rooms = {name.rstrip("/") for name in there(root / "harness") if name.endswith("/")}
    folders = {path.parent.name for path in (root / "tests" / "harness").glob("*/*.py")}
    assert folders
    assert folders <= rooms
