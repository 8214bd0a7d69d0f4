"""A picture as SVG in pixels from its upper left corner, made of lines, areas, discs and texts; every still picture is one.

A page carries it as it is written here, and `reports.export.figures` prints it.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike

from harness.model import Array


def element(name: str, attributes: Mapping[str, str], inside: str = "") -> str:
    """An element of SVG; attributes that are empty are left out."""
    said = "".join(f' {key}="{value}"' for key, value in attributes.items() if value)
    return f"<{name}{said}>{inside}</{name}>" if inside else f"<{name}{said}/>"


def shape(
    name: str,
    places: Mapping[str, str],
    *,
    fill: str = "none",
    stroke: str = "",
    width: float = 1.0,
    dash: str = "",
    opacity: float = 1.0,
    title: str = "",
) -> str:
    """An element that is filled with one colour and drawn in another; a pointer over it is told its `title`.

    `dash` holds lengths in pixels with blanks between them; empty: unbroken.
    """
    style = {"fill": fill, "stroke": stroke, "stroke-width": f"{width:g}" if stroke else "", "stroke-dasharray": dash}
    faint = {"opacity": f"{opacity:g}" if opacity < 1.0 else ""}
    return element(name, {**places, **style, **faint}, element("title", {}, escape(title)) if title else "")


def path(points_px: ArrayLike, *, closed: bool = False, **style: Any) -> str:
    """Straight lines through points (n, 2), none of no points, in a style of `shape`; one that is not a number parts a line."""
    places = np.asarray(points_px).tolist()
    known = [math.isfinite(x) and math.isfinite(y) for x, y in places]
    starts = zip(places, known, [False, *known], strict=False)
    points = "".join(f"{'L' if after else 'M'}{x:.1f} {y:.1f}" for (x, y), there, after in starts if there)
    return shape("path", {"d": points + "Z" * closed}, **style) if points else ""


def disc(x: float, y: float, radius: float, **style: Any) -> str:
    """A disc, in a style of `shape`."""
    return shape("circle", {"cx": f"{x:.1f}", "cy": f"{y:.1f}", "r": f"{radius:.1f}"}, **style)


def box(left: float, top: float, width: float, height: float, **style: Any) -> str:
    """A rectangle with level sides, in a style of `shape`."""
    sizes = {"x": left, "y": top, "width": width, "height": height}
    return shape("rect", {name: f"{value:.1f}" for name, value in sizes.items()}, **style)


def text(
    x: float, y: float, words: str, anchor: str = "middle", colour: str = "", size_px: str = "", halo: bool = False
) -> str:
    """A line of text on its base line, without `colour` and `size_px` as the picture's; a `halo` keeps it legible over lines."""
    style = {"text-anchor": anchor, "fill": colour, "font-size": size_px}
    rim = {"stroke": "#fff", "stroke-width": "3", "paint-order": "stroke"} if halo else {}
    return element("text", {"x": f"{x:.1f}", "y": f"{y:.1f}", **style, **rim}, escape(words))


def plane(scale: float, origin: ArrayLike, at_px: tuple[float, float]) -> Callable[[ArrayLike], Array]:
    """What places points (n, 2) of a plane in a picture: its `origin` at `at_px`, so many pixels to a unit, y upwards."""

    def place(points: ArrayLike) -> Array:
        return np.asarray(at_px + scale * (np.atleast_2d(points) - origin) * [1.0, -1.0])

    return place


def polar(reach: Mapping[float, float]) -> Array:
    """Points (n, 2) so far from the middle by azimuth in degrees, counter-clockwise from the right."""
    angles, sizes = np.radians([*reach]), np.array([*reach.values()])
    return np.column_stack([sizes * np.cos(angles), sizes * np.sin(angles)])


@dataclass(frozen=True, eq=False)
class Picture:
    """Shapes, in the order in which they are drawn, in a picture of that size from `top_px` on."""

    width: float
    height: float
    shapes: Sequence[str]
    top_px: float = 0.0

    def svg(self, words: str = "", css: str = "still") -> Markup:
        """As an inline SVG of that class; `words` describe it to those who cannot see it, none where its surroundings do."""
        said = f'role="img" aria-label="{escape(words)}"' if words else 'aria-hidden="true"'
        box = f'viewBox="0 {self.top_px:g} {self.width:g} {self.height:g}" {said}'
        drawn = "".join(self.shapes)
        return Markup(f'<svg class="{css}" {box} xmlns="http://www.w3.org/2000/svg">{drawn}</svg>')


def rings(most: float, count: int) -> list[float]:
    """Round values up to `most` at equal steps, as many as make no more than `count` (≥ 2)."""
    power = 10.0 ** (math.floor(math.log10(most / count)) - 1)
    steps = (power * factor * 10.0**k for k in range(4) for factor in (1.0, 2.0, 5.0))
    step = next(each for each in steps if most / each < count + 1 - 1e-9)
    return [round(k * step, 12) for k in range(1, math.floor(most / step + 1e-9) + 1)]
