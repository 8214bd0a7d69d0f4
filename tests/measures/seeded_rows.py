"""Measurements of seeded scenes by hand: their command line, and a line of JSON for each scene that is kept at once."""

import argparse
import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TypeVar

from harness.questions.bench.parts import source
from harness.records.base import part


@dataclass(frozen=True)
class SeededRow(ABC):
    """What was computed of one scene."""

    @property
    @abstractmethod
    def key(self) -> tuple[object, ...]:
        """What `compute` was asked."""


Row = TypeVar("Row", bound=SeededRow)


def measured(
    path: Path, kind: type[Row], wanted: Iterable[tuple[object, ...]], compute: Callable[..., Row]
) -> list[Row]:
    """The row of each of `wanted`: from `path` where the code of now computed it, else computed now and added there."""
    code = source()
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    # A row of other code may have other fields.
    plain = [row for row in map(json.loads, lines) if row.pop("source", None) == code]
    rows = {row.key: row for row in (part(kind, item, path) for item in plain)}
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as stream:
        for key in (keys := list(wanted)):
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
