"""Tables of the documentation: each stands between marks that name the command that measures it again."""

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Final

DOCS: Final = Path(__file__).resolve().parents[2] / "docs"
END: Final = "<!-- end -->"


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table."""
    columns = list(head)
    lines = [columns, ["---"] * len(columns), *[list(row) for row in rows]]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def begin(command: str) -> str:
    """The mark above what `python -m COMMAND` measures."""
    return f"<!-- begin: python -m {command} -->"


def renewed(page: str, command: str, content: str) -> str:
    """A page with what stands between the marks of a command replaced. Raises `ValueError` for a page without them."""
    before, mark, rest = page.partition(begin(command))
    _, end, after = rest.partition(END)
    if not mark or not end:
        raise ValueError(f"the page has no marks {begin(command)} and {END}")
    return f"{before}{mark}\n{content}\n{END}{after}"


def renew(name: str, command: str, content: str) -> None:
    """Print what a command measured and write it into a page of the documentation."""
    sys.stdout.write(f"{content}\n")
    sys.stdout.flush()
    path = DOCS / name
    path.write_text(renewed(path.read_text(encoding="utf-8"), command, content), encoding="utf-8")


def renew_tables(page: str, module: str, tables: Mapping[str, Callable[[], str]], wanted: Sequence[str] = ()) -> None:
    """Measure each of a page's tables (of them only the `wanted`), marked with the module and the table's name, and renew it.

    Raises `ValueError` for a name that is none of a table.
    """
    if unknown := set(wanted) - set(tables):
        raise ValueError(f"{page} has the tables {', '.join(tables)}, not {', '.join(sorted(unknown))}")
    for name in wanted or tables:
        renew(page, f"{module} {name}", tables[name]())
