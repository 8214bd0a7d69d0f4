"""The chart library of the plotly wheel, reduced to the kinds of chart that the pages draw.

The wheel ships one bundle with fifty kinds of chart, maps of the world among them; a browser takes most of a second to read it.
The bundle is a row of small modules `var NAME=helper((…)=>{…});`, the last of which registers the kinds of chart. What the kinds
of `CHART_KINDS` cannot reach is left out. A bundle of another shape is used whole.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

from markupsafe import Markup

from reports.pages.assets import CHART_KINDS, LETTERS, made_once, pack_text, package_folder

_NAME: Final = r"[\w$]+"
_LAST: Final = re.compile(
    rf"var ({_NAME})=({_NAME})\(\({_NAME},{_NAME}\)=>\{{var ({_NAME})={_NAME}\(\);\3\.register\(\[((?:{_NAME}\(\),?)+)\]\);"
    rf"{_NAME}\.exports=\3\}}\);return \1\(\);\}}\)\(\);"
)
"""The module that registers the kinds of chart, and the bundle's end."""
_REGISTERED: Final = re.compile(rf"\(\[((?:{_NAME}\(\),?)+)\]\)")
_CALLED: Final = re.compile(rf"{_NAME}(?=\(\))")
_KIND: Final = re.compile(r'moduleType:"trace",name:"(\w+)"')
_PASSED_ON: Final = re.compile(rf'(?:"use strict";)?{_NAME}\.exports=({_NAME})\(\)\}}\);$')


_COMPONENT: Final = re.compile(r'moduleType:"component",name:"(\w+)"')
UNUSED_COMPONENTS: Final = frozenset(
    {"annotations3d", "images", "rangeselector", "rangeslider", "sliders", "updatemenus"}
)
"""Parts of a layout that no chart of the pages has; the library asks for each by name and goes on without it."""
_MAP_STYLE: Final = re.compile(r"`\.maplibregl-map\{[^`]*`")
"""The style sheet of the maps, which are left out."""


class Bundle(NamedTuple):
    """The wheel's bundle in parts: what stands before the modules, the modules by name, what follows; `last` registers."""

    head: str
    modules: dict[str, str]
    tail: str
    last: str
    registered: str
    helper: str


@cache
def chart_library() -> Markup:
    """The reduced library as a script that sets `window.Plotly`, packed; to reduce it takes half a second, so it is kept."""
    state = [
        _bundle().read_bytes(),
        Path(__file__).read_bytes(),
        repr((sorted(CHART_KINDS), LETTERS.tobytes())).encode(),
    ]
    return Markup(made_once("chart-library", b"".join(state), lambda: pack_text(reduced(whole_library()))))


def whole_library() -> str:
    """The wheel's bundle with every kind of chart."""
    return _bundle().read_text(encoding="utf-8")


def _bundle() -> Path:
    return package_folder("plotly") / "package_data" / "plotly.min.js"


def reduced(text: str) -> str:
    """The library with the kinds of `CHART_KINDS` only; the text itself where it does not have the shape that is known here."""
    bundle = _parts(text)
    if bundle is None:
        return text
    kinds = {name: _named(bundle, name, _KIND) for name in _CALLED.findall(bundle.registered)}
    if not CHART_KINDS - {"scatter"} <= set(kinds.values()):
        return text
    wanted = ",".join(f"{name}()" for name, kind in kinds.items() if kind in CHART_KINDS)
    modules = {name: _MAP_STYLE.sub("``", source) for name, source in bundle.modules.items()}
    modules[bundle.last] = modules[bundle.last].replace(bundle.registered, wanted)
    for name, source in modules.items():
        for calls in _REGISTERED.findall(source) if name != bundle.last else ():
            parts = [
                call for call in _CALLED.findall(calls) if _named(bundle, call, _COMPONENT) not in UNUSED_COMPONENTS
            ]
            modules[name] = modules[name].replace(f"[{calls}]", f"[{','.join(f'{call}()' for call in parts)}]")
    needed = _reached(bundle._replace(modules=modules))
    opening = bundle.head.find("var Plotly=")
    licence = text[: text.find("*/") + 2] if text.startswith("/*") else ""
    body = "".join(source for name, source in modules.items() if name in needed)
    end = bundle.tail.find("window.Plotly")
    closing = bundle.tail[: end if end > 0 else None].rstrip()
    return f'{licence}\n"use strict";{bundle.head[opening:]}{body}{closing}\nwindow.Plotly=Plotly;\n'


def _parts(text: str) -> Bundle | None:
    """The parts of a bundle, None for a text of another shape."""
    last = _LAST.search(text)
    if last is None or "var Plotly=" not in text[: last.start()]:
        return None
    name, helper, _, registered = last.groups()
    parts = [
        (match.start(), match.group(1))
        for match in re.finditer(rf"(?<=[;}}])var ({_NAME})={re.escape(helper)}\(", text[: last.end()])
    ]
    end = last.end() - len(f"return {name}();}})();")
    places = [start for start, _ in parts] + [end]
    modules = {name: text[places[k] : places[k + 1]] for k, (_, name) in enumerate(parts)}
    return Bundle(text[: places[0]], modules, text[end:], name, registered, helper)


def _named(bundle: Bundle, name: str, kind_of: re.Pattern[str]) -> str | None:
    """The kind of chart, or the component, that a registered module adds; modules may pass another one on."""
    while name in bundle.modules:
        kind = kind_of.search(bundle.modules[name])
        if kind is not None:
            return kind.group(1)
        onward = _PASSED_ON.search(bundle.modules[name])
        if onward is None:
            return None
        name = onward.group(1)
    return None


def _reached(bundle: Bundle) -> set[str]:
    """The modules that the last one can reach; those with code of their own beside them are always among these."""
    helpers = [name for name in re.findall(rf"[;{{]var ({_NAME})=\(", bundle.head) if name != bundle.helper]
    beside = re.compile("|".join(rf"(?<![\w$.]){re.escape(name)}\(" for name in helpers))
    own = {name: match.start() for name, source in bundle.modules.items() if (match := beside.search(source))}
    # Of a module that nothing calls only the code beside it runs.
    starts = own | {bundle.last: 0}
    waiting: list[str] = list(starts)
    reached: set[str] = set()
    while waiting:
        name = waiting.pop()
        called = set(_CALLED.findall(bundle.modules[name][starts.get(name, 0) :])) & bundle.modules.keys()
        # A module that is called after all is read whole.
        for other in called - reached:
            starts.pop(other, None)
        waiting += called - reached
        reached |= called
    return reached | own.keys() | {bundle.last}
