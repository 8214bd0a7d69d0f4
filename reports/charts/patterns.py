"""The strip of motion patterns under the histories: one bar per model, told apart by colour and hatching."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice, pairwise
from typing import Any, Final

import numpy as np

from harness.model.run import PATTERN_NAMES
from harness.records.scene import SceneRecord
from reports.charts import Json
from reports.charts.palette import PATTERN_LOOKS
from reports.source import RunSource

BARE_PATTERNS: Final[Mapping[str, str]] = {"rest": "at rest", "rocking": "rocking"}
"""Motion patterns of a statue without a pedestal."""
MOST_STRETCHES: Final = 1500
"""Most stretches of motion pattern drawn per model; shorter ones than a pixel are drawn as their longest neighbour."""


def pattern_words(scene: SceneRecord) -> Mapping[str, str]:
    """The motion patterns in words, those of a statue without a pedestal as they are then."""
    return PATTERN_NAMES if scene.pedestal is not None else {**PATTERN_NAMES, **BARE_PATTERNS}


def pattern_strip(source: RunSource, axis: str) -> list[Json]:
    traces: list[Json] = []
    shown = {name: drawn_stretches(run.patterns) for name, run in source.runs.items() if run.patterns}
    for pattern, words in pattern_words(source.scene).items():
        rows = [(name, start, end) for name, all_ in shown.items() for start, end, which in all_ if which == pattern]
        if not rows:
            continue
        colour, hatch = PATTERN_LOOKS[pattern]
        traces.append(
            {
                "type": "bar", "orientation": "h", "yaxis": axis, "name": words, "showlegend": False, "hoverinfo": "skip",
                "y": [row[0] for row in rows], "base": [row[1] for row in rows], "x": [row[2] - row[1] for row in rows],
                "width": 0.72, "offset": -0.36,
                "marker": {
                    "color": colour, "line": {"width": 0},
                    "pattern": {"shape": hatch, "size": 6, "solidity": 0.3, "fgcolor": "#ffffff", "fillmode": "overlay"},
                },
            }
        )  # fmt: skip
    return traces


def drawn_stretches(patterns: Sequence[Sequence[Any]], most: int = MOST_STRETCHES) -> list[tuple[float, float, str]]:
    """At most `most` stretches covering the same time: where there are more, each bin takes its longest pattern."""
    stretches = [(float(start), float(end), str(name)) for start, end, name in patterns]
    if len(stretches) <= most:
        return stretches
    edges = np.linspace(stretches[0][0], stretches[-1][1], most + 1).tolist()
    drawn: list[tuple[float, float, str]] = []
    first = 0
    for low, high in pairwise(edges):
        while stretches[first][1] <= low and first + 1 < len(stretches):
            first += 1
        shares: dict[str, float] = {}
        for start, end, name in islice(stretches, first, None):
            if start >= high:
                break
            shares[name] = shares.get(name, 0.0) + min(end, high) - max(start, low)
        longest = max(shares, key=lambda name: shares[name])
        if drawn and drawn[-1][2] == longest:
            drawn[-1] = (drawn[-1][0], high, longest)
        else:
            drawn.append((low, high, longest))
    return drawn
