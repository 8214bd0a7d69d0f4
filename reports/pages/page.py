"""One self-contained HTML page per result folder, whatever kind of record it holds, and a plain one for conservators."""

import base64
import gzip
import json
import zipfile
from collections.abc import Callable, Sequence
from functools import cache
from importlib import import_module
from importlib.metadata import distribution
from pathlib import Path
from typing import Any, Final

from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from harness.model import InputError, Mistake, printable, printable_lines, to_plain, write_text
from harness.records.base import RECORD, REWRITE, Record, read_result
from meshes import text_cache
from reports.blocks import SHOWN_POINTS, Block, Replay, Section, walk
from reports.charts.figure import CONFIG, Json, dark_css, localised, packed_data, still
from reports.messages import ENGLISH, Language, language

# What a page carries so that it opens without a network: libraries from their wheels, templates, packed data.

TEMPLATES: Final = Path(__file__).resolve().parents[1] / "templates"
VIEWER_OWN_CODE: Final = "var camera,controls,scene,renderer,tracklight;"
"""Where trimesh's own page begins behind the three.js library in the viewer that its wheel ships."""

PAGES_SCRIPT: Final = "window.vegaEmbed = vegaEmbed;"
"""Under which name a page finds the library of charts."""
MAKERS: Final = "Vega, Vega-Lite and Vega-Embed: University of Washington Interactive Data Lab; bundled by VlConvert"

ROOM: Final = "pages"
"""Where the user keeps what pages carry; nowhere where no folder is safe: what lies there runs in the reader's browser."""
MOST_TEXTS: Final = 2
"""Texts kept of each name: of this installed version, and of the one before, to which one may go back."""


def made_once(name: str, state: bytes, make: Callable[[], str]) -> str:
    """The text that `make` gives for `state` (everything that decides it), kept in that folder."""
    return text_cache.made_once(name, state, make, ROOM, MOST_TEXTS)


@cache
def three_js() -> Markup:
    """The 3D library three.js as the trimesh wheel ships it, without the page around it, packed.

    Raises `LookupError` when the wheel's viewer no longer has the shape that is known here.
    """
    archive = Path(str(distribution("trimesh").locate_file("trimesh/resources/templates/viewer.zip")))
    state = archive.read_bytes() + Path(__file__).read_bytes()
    return Markup(made_once("three-js", state, lambda: pack_text(_script(archive))))


def _script(archive: Path) -> str:
    with zipfile.ZipFile(archive) as viewer:
        page = viewer.read("viewer.html.template").decode("utf-8")
    start, end = page.find("<script>"), page.find(VIEWER_OWN_CODE)
    if start < 0 or end < start or "Three.js Authors" not in page[start : start + 200]:
        raise LookupError(f"{archive} does not hold three.js as expected: install the trimesh version of the lock file")
    return page[start + len("<script>") : end]


@cache
def chart_library() -> Markup:
    """The script that draws a page's charts, as its wheel gives it, under its licence, packed."""
    import vl_convert

    wheel = distribution("vl-convert-python")
    head = f"/* {MAKERS}.\n\n{wheel.read_text('licenses/LICENSE')} */\n"
    state = f"base64 {wheel.version} {PAGES_SCRIPT} {head}".encode()
    return Markup(made_once("vega", state, lambda: pack_text(head + vl_convert.javascript_bundle(PAGES_SCRIPT))))


def pack_text(text: str) -> Markup:
    """Text as gzip in base64 (page.js unpacks it); the same text always packs the same."""
    return Markup(base64.b64encode(gzip.compress(text.encode("utf-8"), compresslevel=9, mtime=0)).decode("ascii"))


def packed_json(value: Any) -> Markup:
    """JSON, packed."""
    return pack_text(json.dumps(to_plain(value), ensure_ascii=False, allow_nan=False, separators=(",", ":")))


def packed_chart(chart: Json) -> Markup:
    """A chart as packed JSON: the samples of its curves as many as a page carries."""
    return packed_json(
        {**chart, "config": {**CONFIG, **chart.get("config", {})}, "datasets": packed_data(chart["datasets"])}
    )


def _shown(value: Any) -> Any:
    """A user's text as it may stand in a page: control characters, which HTML forbids, as their escapes; lines are kept."""
    return printable_lines(value) if isinstance(value, str) and not isinstance(value, Markup) else value


@cache
def environment() -> Environment:
    """The templates, everything in them escaped, a missing value an error; compiled once for each state of theirs."""
    home = text_cache.folder(ROOM)
    templates = Environment(
        bytecode_cache=None if home is None else FileSystemBytecodeCache(str(home)),
        loader=FileSystemLoader(TEMPLATES),
        autoescape=select_autoescape(default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_shown,
    )
    templates.filters |= {each.__name__: each for each in (localised, packed_chart, packed_json, still)}
    templates.filters |= {
        "bound": lambda text: text.replace(" %", "\u00a0%"),
        "kind": lambda block: type(block).__name__.lower(),
    }
    return templates


def source_text(name: str) -> Markup:
    """A style sheet or script of the templates folder, put into the page as it stands."""
    return Markup((TEMPLATES / name).read_text(encoding="utf-8"))


REPORT_NAME: Final = "report.html"
CONSERVATOR_NAME: Final = "conservator.html"
FOR_CONSERVATORS: Final = ("run", "study", "effects3d")
"""Kinds of record that have a conservator's page."""
BESIDE: Final = {
    "compare": "run", "effects3d": "run", "rocking_spectrum": "study", "trust": "study", "stress": "bench",
    "measured": "validation",
}  # fmt: skip
"""Kinds whose page stands in the module of another kind."""


def write_report(folder: Path, language_code: str = "en") -> Path:
    """Write `report.html` into a result folder from its records alone, and `conservator.html` beside it for a run or a study.

    Both are in the language of that code (`reports.messages.LANGUAGES`).

    Returns the path of the first; raises, after every page that can be was written, what the first that cannot tripped over, with
    a note that names the page: `InputError` for a broken folder.
    """
    say = language(language_code)
    read = read_result(folder)
    try:
        record = read.texted(say.say)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # What a finding's values may be, only its sentence knows.
        wanted = "codes and values as they were written"
        raise InputError(Mistake(str(folder / RECORD), "findings", wanted, repr(error), REWRITE)) from error
    pages = {REPORT_NAME: _report} | ({CONSERVATOR_NAME: _conservator} if record.kind in FOR_CONSERVATORS else {})
    faults: list[Exception] = []
    for name, build in pages.items():
        try:
            write_text(folder / name, build(folder, record, say))
        except Exception as fault:  # noqa: BLE001 - raised below: one page's failure must not cost the other
            fault.add_note(name)
            faults.append(fault)
    if faults:
        raise faults[0]
    return folder / REPORT_NAME


def page_blocks(folder: Path, record: Record, say: Language = ENGLISH) -> list[Block]:
    """The blocks of the engineer's page of a record, whatever its kind."""
    module = import_module(f"reports.pages.{BESIDE.get(record.kind, record.kind)}_page")
    blocks: list[Block] = getattr(module, f"{record.kind}_page")(folder, record, say)
    return blocks


def _report(folder: Path, record: Record, say: Language) -> str:
    blocks = page_blocks(folder, record, say)
    plain = [(CONSERVATOR_NAME, say("page.plain"))] if record.kind in FOR_CONSERVATORS else []
    names = {each.name: each.heading for each in walk(blocks) if isinstance(each, Section)}
    scripts = ["page.js", "units.js"]
    if any(isinstance(each, Replay) for each in walk(blocks)):
        names = {"replay": say("section.replay"), **names}
        scripts.append("replay.js")
    links = [*plain, *((f"#{name}", words) for name, words in names.items())]
    return _render(record, say(f"kind.{record.kind}"), blocks, links, say, scripts)


def _conservator(folder: Path, record: Record, say: Language) -> str:
    blocks = import_module("reports.pages.conservator").blocks(folder, record, say)
    return _render(record, say("page.kind"), blocks, [(REPORT_NAME, say("page.full_report"))], say)


def _render(
    record: Record,
    kind: str,
    blocks: Sequence[Block],
    links: Sequence[tuple[str, str]],
    say: Language,
    scripts: Sequence[str] = (),
) -> str:
    # These have no title of their own.
    tests = getattr(record, "tests", None) if record.kind == "validation" else None
    title = say.word(record.title) if record.kind in ("bench", "stress") else record.title
    title = title if tests is None else say("text.title_validation", count=tests)
    live = {"chart_library": chart_library()} if scripts else {}
    return environment().get_template("page.html.j2").render(
        live, title=printable(title), kind=kind, blocks=blocks, links=links, say=say,
        css=source_text("page.css") + Markup(dark_css()), scripts=[*map(source_text, scripts)],
        version=record.versions.get("rockcheck", ""), most_points=SHOWN_POINTS,
    )  # fmt: skip
