"""Charts drawn by the library that made their form: on a page by its own script, as SVG, PNG and PDF without a browser.

A chart's `datasets` hold, by name, lists of parts; a part holds columns of one length, and single values that stand in each of
its rows. Columns that are arrays are the samples of curves along the first of them, of which as many are drawn as are seen.
"""

import errno
import re
import resource
from collections.abc import Iterable, Mapping, Sequence
from textwrap import wrap
from typing import Any, Final

import numpy as np
from markupsafe import Markup

from harness.model import printable_lines, to_plain
from reports.charts import Json
from reports.charts.figure import CONFIG, HATCHES, LETTER
from reports.charts.histories import DISPLAYED_SAMPLES, packed_array, shown_samples

WIDE: Final = 1060
"""Width in pixels of a chart that fills the page."""
POINTS: Final = 1200
"""Most points of a curve: more than pixels across."""
BETWEEN: Final = 24
"""Pixels between plots side by side."""
BESIDE: Final = 132
"""Pixels beside the plot of a chart of several, for the names of its axes: the longest outcome's in either language."""
RESERVED: Final = 68 * 2**30
"""Bytes of addresses, not of memory, that the library's engine reserves; where it may not, it ends the process."""
CUT: Final = re.compile(r"(?<=[\"#])clip\d+(?=[\")])")
"""What the library calls the outlines at which it cuts."""
TAG: Final = re.compile(r"<[^>]*>")
"""Where places stand; what is written between tags keeps its digits."""
FINER: Final = re.compile(r"(?<=\d\.\d)\d+")
"""Digits of a place in pixels after the first behind the point."""


def thinned(part: Json, most: int) -> Json:
    """A part with as many samples of its curves as are seen of so many points, every peak among them."""
    curves = [value for value in part.values() if isinstance(value, np.ndarray)]
    if not curves:
        return part
    shown = np.unique(np.concatenate([shown_samples(each, most) for each in curves[1:]]))
    return {key: value[shown] if isinstance(value, np.ndarray) else value for key, value in part.items()}


def rows(parts: Iterable[Json], most: int, chosen: Json) -> list[Json]:
    """The rows of a chart's data as the library takes them; of curves at most so many, with every peak.

    Parts that a parameter names otherwise than `chosen` are left out.
    """
    found = []
    for part in parts:
        if any(part.get(name, value) != value for name, value in chosen.items()):
            continue
        shown = to_plain(thinned(part, most))
        listed = {key: value for key, value in shown.items() if isinstance(value, list)}
        alike = {key: value for key, value in shown.items() if key not in listed}
        found += [alike | dict(zip(listed, each, strict=True)) for each in zip(*listed.values(), strict=True)]
    return found


def packed_data(data: Mapping[str, Sequence[Json]]) -> Json:
    """A chart's data as a page carries them: samples thinned and packed, all else as it is."""
    return {
        name: [
            {key: packed_array(value) if isinstance(value, np.ndarray) else value for key, value in part.items()}
            for part in (thinned(each, DISPLAYED_SAMPLES) for each in parts)
        ]
        for name, parts in data.items()
    }


def sized(spec: Any, width: float, alone: bool = True) -> Any:
    """A chart as wide as that: of several plots each has the share that it states, less the room for the names of axes."""
    if isinstance(spec, list):
        return [sized(each, width, False) for each in spec]
    if "autosize" in spec:
        return spec
    if "spec" in spec:
        return spec | {"spec": spec["spec"] | {"width": max(60.0, (width - BESIDE) / spec["columns"] - BETWEEN)}}
    parted = spec.keys() & {"vconcat", "hconcat"}
    if parted:
        return spec | {key: sized(spec[key], width, False) for key in parted}
    if alone:
        return spec | {"width": width, "autosize": {"type": "fit-x", "contains": "padding"}}
    return spec | {"width": max(60.0, spec["width"] * width - BESIDE)}


def svg(
    spec: Json,
    width: float = WIDE,
    most: int = POINTS,
    words: str = "",
    background: str = "transparent",
    name: str = "",
) -> str:
    """The chart as SVG that many pixels wide, `words` over it; by its `name` its ids are told apart from another's of a page.

    Raises `OSError` where addresses are limited to too few.
    """
    import vl_convert

    if 0 <= resource.getrlimit(resource.RLIMIT_AS)[0] < RESERVED:
        raise OSError(
            errno.ENOMEM, f"charts take {RESERVED // 2**30} GiB of addresses: give `ulimit -v unlimited` before"
        )
    chosen = {each["name"]: each["value"] for each in spec["params"] if "bind" in each and "value" in each}
    data = {name: rows(parts, most, chosen) for name, parts in spec["datasets"].items()}
    over = {"title": wrap(words, max(20, int((width - 16.0) / LETTER)))} if words else {}
    params = [*({key: value for key, value in each.items() if key != "bind"} for each in spec["params"])]
    params.append({"name": "W", "value": width})
    whole = (
        sized(spec, width)
        | {"datasets": data, "config": {**CONFIG, **spec.get("config", {}), "background": background}, "params": params}
        | over
    )
    drawn = str(vl_convert.vegalite_to_svg(legible(whole)))
    # The library counts what cuts over all that it ever drew.
    order = {found: f"cut{k}{name}" for k, found in enumerate(dict.fromkeys(CUT.findall(drawn)))}
    return CUT.sub(lambda found: order[found[0]], drawn)


def legible(part: Any) -> Any:
    """A chart, or a part of one, with the control characters of its texts, which would stop the library, as their escapes."""
    if isinstance(part, dict):
        return {legible(key): legible(value) for key, value in part.items()}
    if isinstance(part, list):
        return [legible(value) for value in part]
    return printable_lines(part) if isinstance(part, str) else part


def hatched(drawn: str) -> str:
    """An SVG with the hatches that its fills call."""
    return drawn.replace(">", f"><defs>{HATCHES}</defs>", 1) if "url(#hatch" in drawn else drawn


def still(spec: Json, width: float = WIDE, name: str = "") -> Markup:
    """The chart as a page carries it under its `name`: what is seen first and without scripts, and what is printed; before it
    what both call."""
    drawn = TAG.sub(lambda tag: FINER.sub("", tag[0]), svg(spec, width, name=name))
    box = drawn.index("viewBox=")
    called = f'<svg class="called" aria-hidden="true"><defs>{HATCHES}</defs></svg>' if "url(#hatch" in drawn else ""
    return Markup(f'{called}<svg class="still" aria-hidden="true" xmlns="http://www.w3.org/2000/svg" {drawn[box:]}')
