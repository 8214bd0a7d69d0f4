"""What the documentation names is there: modules, functions, commands, files, and what it links to; and it stays short."""

import json
import re
from pathlib import Path

import pytest

from tests.measures import checked

ROOT = Path(__file__).resolve().parent.parent
PAGES = (
    "README.md",
    "CONTRIBUTING.md",
    *(str(path.relative_to(ROOT)) for path in sorted((ROOT / "docs").rglob("*.md"))),
)
DOTTED = re.compile(r"(?:python -m |from |`)((?:analytic|meshes|harness|reports|tests)(?:\.\w+)+)")
LINK = re.compile(r"\]\((?!https?:)([^)#\s]+)")
MOST_BYTES = 150_000
"""Of all pages together: what can be read in an afternoon."""
FILED = re.compile(r"(?<![\w/])((?:analytic|meshes|harness|reports|tests|scenes|docs)/[a-z0-9_/]+(?:\.\w+|/))")


def named(page: str) -> set[str]:
    """Dotted names and paths of this project that a page names."""
    return {*DOTTED.findall(page), *FILED.findall(page)}


def absent(root: Path, name: str) -> bool:
    """Whether no module of that dotted name is there, nor one that has its last part, nor a file of that path."""
    if "/" in name:
        return not (root / name).exists()
    place = root.joinpath(*name.split("."))
    if place.is_dir() or place.with_suffix(".py").is_file():
        return False
    homes = [place.parent / "__init__.py", place.parent.with_suffix(".py")]
    word = re.compile(rf"\b{place.name}\b")
    return not any(home.is_file() and word.search(home.read_text(encoding="utf-8")) for home in homes)


def test_names_are_found_and_missed(root: Path) -> None:
    page = "`harness.load_scene(x)`, `python -m harness.bench_x`, from harness.nowhere import y, tests/none.py, docs/model.md"
    assert {name for name in named(page) if absent(root, name)} == {
        "harness.bench_x",
        "harness.nowhere",
        "tests/none.py",
    }
    assert len(named(page)) == 5


@pytest.mark.parametrize("page", PAGES)
def test_what_a_page_names_is_there(root: Path, page: str) -> None:
    missing = sorted(name for name in named((root / page).read_text(encoding="utf-8")) if absent(root, name))
    assert not missing, f"{page} names {', '.join(missing)}"


@pytest.mark.parametrize("page", PAGES)
def test_what_a_page_links_to_is_there(root: Path, page: str) -> None:
    folder = (root / page).parent
    broken = [link for link in LINK.findall((root / page).read_text(encoding="utf-8")) if not (folder / link).exists()]
    assert not broken, f"{page} links to {', '.join(broken)}"


def test_what_has_been_checked_is_as_the_measured_pages_say(root: Path) -> None:
    """A page that was measured anew leaves these tables behind: the command renews them."""
    found = checked.told()
    assert json.loads(checked.ROWS.read_text(encoding="utf-8")) == found
    text = (root / "docs" / "trust.md").read_text(encoding="utf-8")
    for rows in found.values():
        assert len(rows) >= 3
        for row in rows:
            assert f"| {' | '.join(checked.linked(row))} |" in text


def test_a_cell_that_no_page_has_is_told() -> None:
    assert checked.cell("random_scenes", "wide;`pybullet`", "slip held") == "66 (98.5 %)"
    with pytest.raises(LookupError, match=r"measured/random_scenes\.md has no row 'wide;`havok`'"):
        checked.cell("random_scenes", "wide;`havok`", "rotation held")


def test_the_pages_stay_short(root: Path) -> None:
    assert sum((root / page).stat().st_size for page in (*PAGES, "CHANGELOG.md")) <= MOST_BYTES


def test_a_measured_page_names_its_command_first(root: Path) -> None:
    pages = sorted((root / "docs" / "measured").glob("*.md"))
    assert len(pages) >= 10
    for page in pages:
        command = f"python -m tests.measures.{page.stem}"
        first, *lines = page.read_text(encoding="utf-8").splitlines()
        assert command in first
        assert any(line.startswith(f"<!-- begin: {command}") for line in lines)
