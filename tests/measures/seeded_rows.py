"""Measurements of seeded scenes by hand: their command line, and a line of JSON for each scene that is kept at once."""

import argparse
import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from harness.questions.bench.parts import source
from harness.records.base import part

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


Row = TypeVar("Row", bound="DataclassInstance")


def measured(
    path: Path, kind: type[Row], wanted: Iterable[tuple[object, ...]], compute: Callable[..., Row]
) -> list[Row]:
    """The row of each of `wanted`: from `path` where the code of now computed it, else computed now and added there.

    A row's first fields are what `compute` was asked.
    """
    keys = list(wanted)
    asked = [field.name for field in fields(kind)][: len(keys[0])]
    code = source()
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    # A row of other code may have other fields.
    plain = [row for row in map(json.loads, lines) if row.pop("source", None) == code]
    rows = {tuple(getattr(row, name) for name in asked): row for row in (part(kind, item, path) for item in plain)}
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as stream:
        for key in keys:
            if key in rows:
                continue
            rows[key] = compute(*key)
            stream.write(json.dumps({**asdict(rows[key]), "source": code}) + "\n")
            stream.flush()
    return [rows[key] for key in keys]


def command_line(module: str, words: str | None, scenes: int, first_seed: int) -> argparse.ArgumentParser:
    """`[COUNT FIRST] [--out FILE]` of a module; `seeds_of` reads the numbers."""
    parser = argparse.ArgumentParser(prog=f"python -m {module}", description=words)
    parser.add_argument("count", nargs="?", type=int, default=scenes, help="seeds (of each generator)")
    parser.add_argument("first", nargs="?", type=int, default=first_seed, help="the first of them")
    rows = Path("out") / f"{module.rpartition('.')[2]}.jsonl"
    parser.add_argument("--out", type=Path, default=rows, help="rows that are kept")
    return parser


def seeds_of(given: argparse.Namespace) -> Sequence[int]:
    """The seeds that a command line asks for."""
    return range(given.first, given.first + given.count)
