"""A picture as lines, areas, discs and texts in pixels from its upper left corner; every still picture is made of them.

A page carries it as SVG, written here, and `reports.export.figures` prints that.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from html import escape
from typing import Final

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

LETTER: Final = 7.2
"""Width of a letter of the pictures' type in pixels, on average."""


@dataclass(frozen=True, eq=False)
class Path:
    """Straight lines through `points_px` (n, 2), drawn where `stroke` is a colour, filled where `fill` is one.

    A point that is not a number parts one line from the next.
    """

    points_px: Array
    stroke: str = ""
    width: float = 1.0
    dash: str = ""
    """Lengths in pixels with blanks between them; empty: unbroken."""
    fill: str = ""
    opacity: float = 1.0
    closed: bool = False
    title: str = ""
    """What a pointer over it is told."""

    def svg(self) -> str:
        """As SVG; a fill is said only where lines enclose an area."""
        places = self.points_px.tolist()
        known = [math.isfinite(x) and math.isfinite(y) for x, y in places]
        starts = zip(places, known, [False, *known], strict=False)
        points = "".join(f"{'L' if after else 'M'}{x:.1f} {y:.1f}" for (x, y), there, after in starts if there)
        style = f' fill="{self.fill or "none"}"' if self.fill or len(self.points_px) > 2 else ""
        if self.stroke:
            style += f' stroke="{self.stroke}" stroke-width="{self.width:g}"'
        style += f' stroke-dasharray="{self.dash}"' if self.dash else ""
        style += f' opacity="{self.opacity:g}"' if self.opacity < 1.0 else ""
        return _titled("path", f' d="{points}{"Z" if self.closed else ""}"{style}', self.title)


@dataclass(frozen=True)
class Disc:
    """A disc; `stroke` is the colour of its rim."""

    x: float
    y: float
    radius: float
    fill: str = ""
    stroke: str = ""
    width: float = 1.0
    dash: str = ""
    opacity: float = 1.0
    title: str = ""

    def svg(self) -> str:
        """As SVG."""
        style = f' fill="{self.fill or "none"}"' + (f' stroke="{self.stroke}"' if self.stroke else "")
        style += f' stroke-width="{self.width:g}"' if self.stroke and self.width != 1.0 else ""
        style += f' stroke-dasharray="{self.dash}"' if self.dash else ""
        style += f' fill-opacity="{self.opacity:g}"' if self.opacity < 1.0 else ""
        return _titled("circle", f' cx="{self.x:.1f}" cy="{self.y:.1f}" r="{self.radius:.1f}"{style}', self.title)


@dataclass(frozen=True)
class Text:
    """A line of text on its base line; without `colour` and `size_px` it takes the picture's."""

    x: float
    y: float
    text: str
    anchor: str = "middle"
    colour: str = ""
    size_px: float | None = None
    turned: bool = False
    """Whether it runs upwards."""
    halo: bool = False
    """Whether a white rim keeps it legible over lines."""

    def svg(self) -> str:
        """As SVG."""
        place = f' x="{self.x:.1f}" y="{self.y:.1f}"'
        if self.turned:
            place = f' x="0.0" y="0.0" transform="translate({self.x:g} {self.y:.1f}) rotate(-90)"'
        style = f' fill="{self.colour}"' if self.colour else ""
        style += f' font-size="{self.size_px:g}"' if self.size_px else ""
        style += ' stroke="#fff" stroke-width="3" paint-order="stroke"' if self.halo else ""
        return f'<text{place} text-anchor="{self.anchor}"{style}>{escape(self.text)}</text>'


Shape = Path | Disc | Text


@dataclass(frozen=True, eq=False)
class Picture:
    """Shapes, in the order in which they are drawn, in a picture of that size; texts are `type_px` high unless they say."""

    width: float
    height: float
    shapes: Sequence[Shape]
    type_px: float = 13.0

    def svg(self, words: str = "", css: str = "still", style: str = "") -> Markup:
        """As an inline SVG of that class; `words` describe it to those who cannot see it, none where its surroundings do."""
        said = f'role="img" aria-label="{escape(words)}"' if words else 'aria-hidden="true"'
        box = f'viewBox="0 0 {self.width:g} {self.height:g}" {said}' + (f' style="{style}"' if style else "")
        drawn = "".join(shape.svg() for shape in self.shapes)
        return Markup(f'<svg class="{css}" {box} xmlns="http://www.w3.org/2000/svg">{drawn}</svg>')


def _titled(name: str, attributes: str, title: str) -> str:
    return f"<{name}{attributes}>" + f"<title>{escape(title)}</title></{name}>" if title else f"<{name}{attributes}/>"


def line(points: ArrayLike, stroke: str, width: float = 1.0, dash: str = "", opacity: float = 1.0) -> Path:
    """An open line through points (n, 2)."""
    return Path(np.asarray(points, dtype=np.float64), stroke, width, dash, opacity=opacity)


def area(points: ArrayLike, fill: str, stroke: str = "", width: float = 1.0, opacity: float = 1.0) -> Path:
    """The area that points (n, 2) enclose."""
    return Path(np.asarray(points, dtype=np.float64), stroke, width, fill=fill, opacity=opacity, closed=True)


def box(
    left: float, top: float, width: float, height: float, fill: str, opacity: float = 1.0, stroke: str = ""
) -> Path:
    """A rectangle with level sides."""
    right, bottom = left + width, top + height
    return area([(left, top), (right, top), (right, bottom), (left, bottom)], fill, stroke, opacity=opacity)


def moved(shapes: Iterable[Shape], dx: float, dy: float) -> list[Shape]:
    """Shapes shifted by that many pixels to the right and down."""
    return [
        replace(shape, points_px=shape.points_px + np.array([dx, dy]))
        if isinstance(shape, Path)
        else replace(shape, x=shape.x + dx, y=shape.y + dy)
        for shape in shapes
    ]


def nice_ticks(low: float, high: float, most: int) -> list[float]:
    """Round values within [low, high] at equal steps, two at least: as many as make no more than `most` (≥ 2) intervals."""
    power = 10.0 ** (math.floor(math.log10((high - low) / most)) - 1)
    ends = []
    for step in (power * factor * 10.0**k for k in range(4) for factor in (1.0, 2.0, 5.0)):
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last > first:
            ends.append((max(last - first - most, 0), first - last, first, last, step))
    _, _, first, last, step = min(ends)
    return [round(k * step, 12) for k in range(first, last + 1)]
