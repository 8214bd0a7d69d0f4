"""What a page is made of: each kind of block is one class here and one macro of `page.html.j2`; a page is a list of them."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from markupsafe import Markup

from harness.model import Finding, Severity, grouped, weighed
from harness.records.base import Record, option_words
from reports.messages import Language

SHOWN_POINTS: Final = 6
"""Points under a headline that are shown where there are more than two beyond; the others are folded away."""


@dataclass(frozen=True)
class Cell:
    """A table's cell that is more than text: a class, what stands under the pointer, a sign (`words` is what it says aloud), a
    second line, or details under a `fold`."""

    text: str = ""
    style: str = ""
    tip: str = ""
    sign: str = ""
    words: str = ""
    below: str = ""
    folds: Sequence[Details] = ()


@dataclass(frozen=True)
class Chip:
    """One model: its colour, and of its run words, labels and its largest lean in per cent of the balance angle."""

    name: str
    colour: str
    sentence: str = ""
    labels: Sequence[str] = ()
    failed: bool = False
    share: int | None = None


@dataclass(frozen=True)
class Verdict:
    """What a page says first: `tone` is `agree`, `differ` or `failed`; a conservator's has a picture and what to do."""

    headline: str
    tone: str
    points: Sequence[str] = ()
    chips: Sequence[Chip] = ()
    drawing: Drawing | None = None
    todo: Sequence[str] = ()


@dataclass(frozen=True)
class Text:
    """Paragraphs; by `style` a list of points or notes, or commands to copy."""

    lines: Sequence[str]
    style: str = ""


@dataclass(frozen=True)
class Legend:
    """What colours or signs mean: (sign or colour, words), and what follows."""

    keys: Sequence[tuple[str, str]]
    after: str = ""


@dataclass(frozen=True)
class Facts:
    """Names and values."""

    pairs: Sequence[tuple[str, str]]
    style: str = "narrow"


@dataclass(frozen=True)
class Table:
    """Rows under heads; the first cell of each is its name."""

    caption: str
    heads: Sequence[str | Cell]
    rows: Sequence[Row]
    style: str = ""


@dataclass(frozen=True)
class Chart:
    """A chart by its name on the page and in print, its title, and its specification; `tools="time"` has buttons for time."""

    name: str
    words: str
    figure: Any
    width: int = 530
    tools: str = ""


@dataclass(frozen=True)
class Drawing:
    """A finished picture with what stands below it; with a `heading` one of a row of pictures."""

    svg: Markup
    caption: Sequence[str] = ()
    style: str = ""
    heading: str = ""


@dataclass(frozen=True)
class Replay:
    """The replay: its models, the one shown solid and the one beside it, and the packed data."""

    chips: Sequence[Chip]
    solid: str
    ghost: str
    own_mesh: bool
    data: str
    library: Markup


@dataclass(frozen=True)
class Details:
    """Blocks under a summary; `fold`: folded away on a telephone alone."""

    summary: str
    blocks: Sequence[Block]
    name: str = ""
    fold: bool = False


@dataclass(frozen=True)
class Group:
    """Blocks that stand together in one style of the sheet, such as beside each other."""

    style: str
    blocks: Sequence[Block]
    heading: str = ""


@dataclass(frozen=True)
class Section:
    """A part of a page with its heading, which the page's head names too."""

    name: str
    heading: str
    blocks: Sequence[Block]
    style: str = ""


Row: TypeAlias = Sequence[str | Cell]
Block: TypeAlias = Verdict | Text | Legend | Facts | Table | Chart | Drawing | Replay | Details | Group | Section


def walk(blocks: Iterable[Block]) -> Iterator[Block]:
    """Every block, those within others too, in the order of the page."""
    for block in blocks:
        yield block
        yield from walk(getattr(block, "blocks", ()))


TONES: Final[Mapping[str, Mapping[str, str]]] = {
    "bench": {"met": "agree"},
    "effects3d": {"plane_safe": "agree"},
    "measured": {"drops_not_told": "differ", "otherwise": "agree"},
    "stress": {"sound": "agree", "wrong": "failed"},
    "validation": {"better": "agree", "no_threshold": "agree", "no_answer": "failed", "": "failed"},
}
"""The colour of an answer by its code, of kinds whose answer decides it; otherwise `differ`."""


def verdict(record: Record, tone: str = "", more: Sequence[str] = (), chips: Sequence[Chip] = ()) -> Verdict:
    """A record's answer as headline and points, and what else a page says with it; without a `tone` the one of its code."""
    said = [each.text for each in record.answer.findings] if record.answer else []
    first, *points = said or [record.title or record.kind]
    if not tone:
        of_codes = TONES[record.kind]
        tone = of_codes.get(code(record), of_codes.get("otherwise", "differ"))
    return Verdict(first, tone, [*points, *more], chips)


def code(record: Record) -> str:
    """The code of a record's answer."""
    return "" if record.answer is None else record.answer.code


def section(say: Language, name: str, *blocks: Block | None, style: str = "") -> list[Section]:
    """A section of what is there of these blocks; none where nothing is."""
    there = [each for each in blocks if each]
    return [Section(name, say(f"section.{name}"), there, style)] if there else []


def words(say: Language, key: str, /, style: str = "", **values: object) -> Text:
    """A paragraph of the catalogue."""
    return Text([say(f"text.{key}", **values)], style)


def table(
    say: Language, name: str, columns: str, rows: Iterable[object], style: str = "", *, count: int = 3, **values: object
) -> Table | None:
    """A table of records or mappings: `columns` are the names of their values, of which the first names the row; None of no row.

    Its caption stands in the catalogue, filled with `values`; numbers have `count` digits.
    """
    keys = columns.split()
    cells = [[shown(say, _value(row, key), count) for key in keys] for row in rows]
    return Table(say(f"table.{name}", **values), [*map(say.label, keys)], cells, style) if cells else None


def turned(
    say: Language, name: str, heads: Sequence[str], keys: Iterable[str], items: Sequence[object], count: int = 3
) -> Table:
    """A table whose columns are records and whose rows are their values; a row without any is left out."""
    known = [(key, [_value(item, key) for item in items]) for key in keys]
    rows: list[Row] = [
        [say.label(key), *(shown(say, value, count) for value in values)]
        for key, values in known
        if any(value is not None for value in values)
    ]
    return Table(say(f"table.{name}"), ["", *heads], rows)


def _value(row: Any, key: str) -> Any:
    return row[key] if isinstance(row, Mapping) else getattr(row, key)


def shown(say: Language, value: Any, count: int = 3) -> str | Cell:
    """A value of a record as a table's cell."""
    return value if isinstance(value, Cell) else say.plain(value, count)


def facts(say: Language, pairs: Mapping[str, object], style: str = "narrow") -> Facts:
    """Values under their labels; what is None or empty is left out."""
    return Facts(
        [(say.label(key), say.plain(value)) for key, value in pairs.items() if value not in (None, "", [])], style
    )


def owned(finding: Finding) -> str:
    """A finding's sentence after the engine that it is of, or the pair where the sentence does not name it."""
    named = "_vs_" in finding.engine and finding.values.keys() & {"a", "model"}
    owner = "" if named or not finding.engine else f"{finding.engine.replace('_vs_', ' – ')}: "
    return f"{owner}{finding.text}"


def notes(say: Language, findings: Iterable[Finding]) -> list[Block]:
    """Findings under the heading of their severity, the lightest folded away."""
    blocks: list[Block] = []
    for severity, lines in grouped((each.severity, owned(each)) for each in weighed(findings)).items():
        heading = say(f"severity.{severity}")
        if severity is Severity.INFO:
            blocks.append(Details(f"{heading} ({len(lines)})", [Text(lines, "notes")]))
        else:
            style = "warnings" if severity is Severity.CHANGES_ANSWER else "notes"
            blocks.append(Group("", [Text(lines, style)], heading))
    return blocks


def grid(charts: Iterable[Chart | Drawing]) -> Group | None:
    """Charts beside each other, each under its title."""
    there = [
        Group("", [chart], chart.words if isinstance(chart, Chart) else " ".join(chart.caption)) for chart in charts
    ]
    return Group("grid", there) if there else None


def command_line(name: str, *words: str, **options: object) -> str:
    """A command with what is given of its options."""
    return shlex.join(["rockcheck", *name.split(), *words, *option_words(**options)])


def repeat(say: Language, record: Record, *commands: str, more: Sequence[Block | None] = ()) -> list[Section]:
    """How to repeat it, and with what it was made."""
    made: dict[str, object] = {**record.versions, **record.machine}
    seconds = getattr(record, "seconds", None)
    made |= {} if seconds is None else {"computed_in": say.value(seconds, "s")}
    asked = Text(["\n\n".join(commands)], "command") if commands else None
    return section(say, "repeat", asked, *more, Details(say("text.versions"), [facts(say, made)]))
