"""What has been checked, by the measured pages: `python -m tests.measures.checked` (at once: each page has its own command).

Each row of `checked.toml` says what was compared with what, and takes its figures from the page that measures them. They go into
docs/trust.md and into the page that `make report` writes.
"""

import json
import re
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from reports.build_examples import COLUMNS, PARTS, ROWS
from tests.measures.pages import DOCS, renew, table

MODULE: Final = "tests.measures.checked"
CHECKS: Final = Path(__file__).with_suffix(".toml")
CELL: Final = re.compile(r"\{(\w+)\|([^|}]+)\|([^|}]+)\}")


def rows_of(page: str) -> Iterator[dict[str, str]]:
    """Every row of every table of a measured page, by its heads."""
    heads: list[str] = []
    for line in (DOCS / "measured" / f"{page}.md").read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line[1:].rstrip("| ").split(" | ")] if line.startswith("|") else []
        if not cells:
            heads = []
        elif not heads:
            heads = cells
        elif not set(line) <= set("|- "):
            yield dict(zip(heads, cells, strict=False))


def cell(page: str, words: str, column: str) -> str:
    """The cell of a column in the first row whose cells hold each of these, parted by `;`. Raises `LookupError`."""
    for row in rows_of(page):
        if column in row and all(any(word in each for each in row.values()) for word in words.split(";")):
            return row[column]
    raise LookupError(f"measured/{page}.md has no row {words!r} with a column {column!r}")


def told() -> dict[str, list[list[str]]]:
    """The rows of the three parts, with their figures."""
    checks = tomllib.loads(CHECKS.read_text(encoding="utf-8"))
    return {
        part: [[CELL.sub(lambda match: cell(*match.groups()), row[name]) for name in COLUMNS] for row in checks[part]]
        for part in PARTS
    }


def linked(row: Sequence[str]) -> list[str]:
    """A row for a page of the documentation: the figure links to its source."""
    *cells, source = row
    links = ", ".join(f"[{Path(page).stem.replace('_', ' ')}]({page})" for page in source.split(", "))
    cells[COLUMNS.index("figure")] += f" ({links})"
    return cells


def main() -> None:
    """Renew the tables of docs/trust.md, and the rows of the report's page."""
    found = told()
    ROWS.write_text(json.dumps(found, ensure_ascii=False, indent=1) + "\n", encoding="utf-8")
    for part, rows in found.items():
        heads = [name.replace("_", " ") for name in COLUMNS[:-1]]
        renew("trust.md", f"{MODULE} {part}", table(heads, map(linked, rows)))


if __name__ == "__main__":
    main()
