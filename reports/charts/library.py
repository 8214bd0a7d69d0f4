"""The script with which a page draws its charts: the library's own, as its wheel gives it."""

from __future__ import annotations

from functools import cache
from importlib.metadata import distribution
from typing import Final

from markupsafe import Markup

from reports.pages.assets import made_once, pack_text

PAGES_SCRIPT: Final = "window.vegaEmbed = vegaEmbed;"
"""Under which name a page finds the library."""


MAKERS: Final = "Vega, Vega-Lite and Vega-Embed: University of Washington Interactive Data Lab; bundled by VlConvert"


@cache
def chart_library() -> Markup:
    """The script that draws a page's charts, under its licence, packed."""
    import vl_convert

    wheel = distribution("vl-convert-python")
    head = f"/* {MAKERS}.\n\n{wheel.read_text('licenses/LICENSE')} */\n"
    state = f"{wheel.version} {PAGES_SCRIPT} {head}".encode()
    return Markup(made_once("vega", state, lambda: pack_text(head + vl_convert.javascript_bundle(PAGES_SCRIPT))))
