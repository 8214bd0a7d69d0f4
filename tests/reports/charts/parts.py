"""What a chart's data hold, for tests."""

from typing import Any


def part(chart: dict[str, Any], data: str, name: str | None = None) -> dict[str, Any]:
    """The one part of the data of that name, or the one that has a name of its own."""
    (found,) = [each for each in chart["datasets"][data] if name is None or each["name"] == name]
    return dict(found)


def kind_at(chart: dict[str, Any], x: float, y: float) -> str | None:
    """What a map shows at a place; None where it is empty."""
    cells = part(chart, "cells")
    rows = zip(cells["x"], cells["x2"], cells["y"], cells["y2"], cells["kind"], strict=True)
    found = [kind for left, right, low, high, kind in rows if left <= x < right and low <= y < high]
    return found[0] if found else None
