"""Parts of a page's blocks, for tests: the answer, the lines of a section, tables by their caption, pictures."""

import re
from collections.abc import Iterable, Sequence
from typing import TypeVar

from reports.blocks import Block, Cell, Drawing, Section, Table, Text, Verdict, walk
from reports.messages import ENGLISH

B = TypeVar("B")


def every(blocks: Iterable[Block], kind: type[B]) -> list[B]:
    """All blocks of a kind, in the page's order."""
    return [each for each in walk(blocks) if isinstance(each, kind)]


def answer(blocks: Iterable[Block]) -> Verdict:
    """What the page says first."""
    (first,) = every(blocks, Verdict)
    return first


def lines(blocks: Iterable[Block], name: str) -> list[str]:
    """The lines of text of a section; none of one that is not there."""
    there = [each for each in every(blocks, Section) if each.name == name]
    return [line for each in every(there, Text) for line in each.lines]


def pictures(blocks: Iterable[Block]) -> list[Drawing]:
    """All pictures, that of the answer first."""
    first = answer(blocks).drawing
    return [*([first] if first else []), *every(blocks, Drawing)]


def rows(blocks: Iterable[Block], caption: str) -> list[list[str]]:
    """The cells of a table as text, row by row; a cell without text as its words or sign."""
    (found,) = (each for each in every(blocks, Table) if each.caption == caption)
    return [list(map(cell_text, row)) for row in found.rows]


def cell_text(cell: str | Cell) -> str:
    """What a cell says."""
    return cell if isinstance(cell, str) else cell.text or cell.words or cell.sign


def form(key: str) -> re.Pattern[str]:
    """What a string of the catalogue looks like once its braces are filled, each of them a group of its name.

    No value holds the end of a sentence, nor does the string end within a number.
    """
    words = (
        rf"(?:{part[2]}|{part[3]})" if part[2] else rf"(?P<{part[1]}>(?:(?!\. ).)+?)" if part[1] else re.escape(part[0])
        for part in re.finditer(r"\{(\w+)(?:\|([^|}]*)\|([^}]*))?\}|[^{]+", ENGLISH.strings[key])
    )
    return re.compile("".join(words) + r"(?=[^\w<]*(?:[\s<]|$))")


def spoken(blocks: Sequence[Block]) -> str:
    """Everything that a conservator's page says, pictures included."""
    first = answer(blocks)
    drawn = [text for each in pictures(blocks) for text in (each.heading, *each.caption)]
    return " ".join([first.headline, *first.points, *first.todo, *lines(blocks, "basis"), *drawn])
