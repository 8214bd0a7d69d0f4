"""The axes of a still picture: where a value of a figure's plain JSON lies on paper, and which ticks are written."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from reports.charts import Json
from reports.charts.samples import numbers
from reports.drawing.shapes import LETTER
from reports.messages.numbers import short

Array = NDArray[np.float64]

MARGIN: Final = {"left": 66.0, "right": 22.0, "top": 40.0, "bottom": 48.0}
STEPS: Final = (1.0, 2.0, 5.0)


@dataclass(frozen=True, eq=False)
class Axis:
    """One axis: values from `low` to `high` (logarithms on a logarithmic axis) between two places in pixels."""

    low: float
    high: float
    start_px: float
    end_px: float
    log: bool
    names: Sequence[str]
    spec: Json

    def px(self, values: Any) -> Array:
        """Places in pixels of numbers, or of names on an axis of names."""
        if self.names:
            known = {name: k for k, name in enumerate(self.names)}
            numbers = np.asarray([known[str(value)] for value in np.atleast_1d(values)], dtype=np.float64)
        else:
            numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
            numbers = np.log10(np.maximum(numbers, 1e-300)) if self.log else numbers
        return np.asarray(self.start_px + (numbers - self.low) / (self.high - self.low) * (self.end_px - self.start_px))

    def inside(self, at_px: float) -> float:
        """The place nearest to one in pixels that lies on the axis."""
        low, high = sorted((self.start_px, self.end_px))
        return min(max(at_px, low), high)

    def ticks(self) -> list[tuple[float, str]]:
        """Places in pixels and texts of the ticks."""
        if self.names:
            return [(float(self.px(name)[0]), name) for name in self.names]
        if "tickvals" in self.spec:
            values, texts = self.spec["tickvals"], self.spec.get("ticktext") or map(str, self.spec["tickvals"])
            return [(float(self.px(value)[0]), text) for value, text in zip(values, texts, strict=True)]
        if self.log:
            whole = range(math.ceil(self.low - 1e-9), math.floor(self.high + 1e-9) + 1)
            return [(float(self.px(10.0**k)[0]), short(10.0**k)) for k in whole]
        wanted = min(int(self.spec.get("nticks", 8)), max(2, int(abs(self.end_px - self.start_px) / 34.0)))
        low, high = min(self.low, self.high), max(self.low, self.high)
        return [(float(self.px(value)[0]), short(value)) for value in nice_ticks(low, high, wanted)]


def nice_ticks(low: float, high: float, most: int) -> list[float]:
    """Round values within [low, high] at equal steps, two at least: as many as make no more than `most` (≥ 2) intervals."""
    power = 10.0 ** (math.floor(math.log10((high - low) / most)) - 1)
    ends = []
    for step in (power * factor * 10.0**k for k in range(4) for factor in STEPS):
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last > first:
            ends.append((max(last - first - most, 0), first - last, first, last, step))
    _, _, first, last, step = min(ends)
    return [round(k * step, 12) for k in range(first, last + 1)]


def axes(figure: Json, width: float, height: float) -> dict[str, Axis]:
    """All axes of a figure by their plotly names (`x`, `y`, `y2`…), laid out in a picture of that size.

    A layout's `still` may give the room at `top` and `bottom` in pixels, of a still picture alone.
    """
    layout = figure["layout"]
    names = {letter + str(trace.get(f"{letter}axis", letter))[1:] for trace in figure["data"] for letter in "xy"}
    specs = {name: layout.get(f"{name[0]}axis{name[1:]}", {}) for name in sorted(names)}
    values = {name: _values(figure["data"], name) for name in specs}
    left = MARGIN["left"]
    for name, on_axis in values.items():
        if name.startswith("y") and on_axis and isinstance(on_axis[0], str):
            left = max(left, 24.0 + LETTER * max(len(text) for text in on_axis))
    room = {"bottom": layout.get("margin_bottom", MARGIN["bottom"]), "top": MARGIN["top"]} | layout.get("still", {})
    inner = {"x": (left, width - MARGIN["right"]), "y": (height - float(room["bottom"]), float(room["top"]))}
    made = {}
    for name, spec in specs.items():
        start, end = inner[name[0]]
        a, b = spec.get("domain", (0.0, 1.0))
        made[name] = _axis(spec, values[name], start + a * (end - start), start + b * (end - start))
    return made


def _values(traces: Sequence[Json], name: str) -> list[Any]:
    """Every value that the traces hold on an axis; a bar reaches from its base, or from nought."""
    entries: list[Any] = []
    letter = name[0]
    for trace in traces:
        if trace.get(f"{letter}axis", letter) != name or letter not in trace:
            continue
        data = list(numbers(trace[letter]))
        if trace["type"] == "bar" and (trace.get("orientation") == "h") == (letter == "x"):
            base = trace.get("base", [0.0] * len(data))
            data = [*base, *(start + size for start, size in zip(base, data, strict=True))]
        entries += data
    return [value for value in entries if isinstance(value, str) or (value is not None and math.isfinite(value))]


def _axis(spec: Json, values: Sequence[Any], start_px: float, end_px: float) -> Axis:
    names: list[str] = []
    log = spec.get("type") == "log"
    if spec.get("type") == "category" or any(isinstance(value, str) for value in values):
        names = list(dict.fromkeys(str(value) for value in values))
        low, high = -0.5, len(names) - 0.5
    elif "range" in spec:
        low, high = (float(value) for value in spec["range"])
    else:
        inside = [math.log10(value) for value in values if value > 0.0] if log else [float(value) for value in values]
        low, high = (min(inside), max(inside)) if inside else (0.0, 1.0)
        margin = 0.05 * (high - low) or 0.5
        low, high = low - margin, high + margin
        if spec.get("rangemode") == "tozero" and not log:
            low, high = min(low + margin, 0.0), max(high, 0.0)
    if spec.get("autorange") == "reversed":
        low, high = high, low
    return Axis(low, high if high != low else low + 1.0, start_px, end_px, log, names, spec)
