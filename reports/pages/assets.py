"""What a page carries so that it opens without a network: libraries from their wheels, templates, packed data."""

import base64
import gzip
import json
import zipfile
from collections.abc import Callable
from functools import cache
from importlib.metadata import distribution
from pathlib import Path
from typing import Any, Final

from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from harness.model import printable_lines, to_plain
from meshes import text_cache
from reports.charts import Json
from reports.charts.drawn import packed_data, still
from reports.charts.figure import CONFIG, localised

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
