"""Does a trust map say what a full grid says? `python -m tests.measures.trust_grid [-e ENGINE]... [--count N] [--on PLACE]`

The shipped statue, 30 strengths by 30 frequencies: engines run at every point (or at N of them, drawn), the map of the same plane
asks where it would. Answers are kept in out/trust_grid, so that a call that was interrupted goes on where it stopped. It renews
docs/measured/trust_grid.csv, a row for each point, and the table of docs/measured/trust_grid.md that follows from it.
"""

import argparse
import csv
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from harness.accuracy.horizon import MODEL
from harness.input.scene_file import load_scene
from harness.questions.trust import (
    FASTEST_HZ,
    SLOWEST_HZ,
    STRONGEST_G,
    WEAKEST_G,
    Kept,
    Plane,
    Point,
    Points,
    explored,
)
from harness.records.trust import HELD, TrustClass
from harness.runs.execute import Campaign
from harness.runs.runner import LocalPool
from harness.runs.store import Store
from tests.measures.pages import DOCS, renew, table

MODULE: Final = "tests.measures.trust_grid"
SCENE: Final = DOCS.parent / "scenes" / "paestum_pedestal.toml"
SIDE: Final = 30
PLACES: Final = ("pedestal", "floor")
ROWS: Final = DOCS / "measured" / "trust_grid.csv"
BATCH: Final = 20
"""Points between two looks at the store: what is lost by an interrupt."""


@dataclass(frozen=True)
class GridRow:
    """One point: what the engines' own runs say, what the map says, and what that rests on."""

    stands_on: str
    engines: str
    amplitude_g: float
    frequency_hz: float
    grid: TrustClass
    map: TrustClass
    basis: str


def plane_of(place: str, side: int = SIDE) -> Plane:
    """The grid as a map's plane."""
    whole = Plane.of(load_scene(SCENE), "sine", coarse=False)
    amplitudes, frequencies = (
        [float(f"{value:.3g}") for value in np.geomspace(*ends, side)]
        for ends in ((WEAKEST_G, STRONGEST_G), (SLOWEST_HZ, FASTEST_HZ))
    )
    plane = replace(whole, amplitudes_g=amplitudes, frequencies_hz=frequencies)
    return plane if place == "pedestal" else plane.without_pedestal()


def compared(plane: Plane, names: tuple[str, ...], points: Points, count: int) -> Iterator[GridRow]:
    """The rows of `count` points, drawn where these are not all."""
    order = np.random.default_rng(7).permutation(len(plane.points)).tolist()[:count]
    chosen = [plane.points[k] for k in order]
    grid: dict[Point, Kept | None] = {}
    for k in range(0, count, BATCH):
        grid |= points.kept(plane, chosen[k : k + BATCH], names)
    words = explored(plane, names, points, 0).words()
    for point in sorted(chosen):
        kept, frequency = grid[point], plane.frequencies_hz[point[0]]
        assert frequency is not None
        kind, basis, _ = words[point]
        said = kept.said(plane.at(point), names).kind
        stands_on = "floor" if plane.on_floor else "pedestal"
        yield GridRow(stands_on, " ".join(names), plane.amplitudes_g[point[1]], frequency, said, kind, basis)


def text(rows: Sequence[GridRow]) -> str:
    """A line for each map and set of engines."""
    groups: dict[tuple[str, str], list[GridRow]] = {}
    for row in rows:
        groups.setdefault((row.stands_on, row.engines), []).append(row)
    lines = []
    for (stands_on, engines), each in sorted(groups.items()):
        other = [row for row in each if row.grid != row.map]
        kinds = sorted({f"{row.map} for {row.grid}" for row in other})
        false = [row for row in other if row.map in HELD and row.grid == "refuted"]
        share = f"{len(other)} ({100.0 * len(other) / len(each):.1f} %)"
        asked = sum(row.basis in ("runs", "checked") for row in each)
        lines.append([stands_on, engines, str(len(each)), str(asked), share, ", ".join(kinds) or "–", str(len(false))])
    head = [
        "on the",
        "models",
        "points",
        "asked by the map",
        "in another class",
        "which",
        "held where the grid refutes",
    ]
    return table(head, lines)


def read(path: Path) -> list[GridRow]:
    """The rows that are kept."""
    with path.open(encoding="utf-8") as stream:
        found = list(csv.DictReader(stream))
    numbers = ("amplitude_g", "frequency_hz")
    return [GridRow(**{key: float(value) if key in numbers else value for key, value in row.items()}) for row in found]  # type: ignore[arg-type]


def write(rows: Sequence[GridRow], path: Path) -> None:
    """Keep rows."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        lines = csv.DictWriter(stream, list(GridRow.__dataclass_fields__), lineterminator="\n")
        lines.writeheader()
        lines.writerows(asdict(row) for row in rows)


def main(argv: Sequence[str] | None = None) -> None:
    """Measure what was asked; what was measured before of other engines or places stays."""
    parser = argparse.ArgumentParser(prog=f"python -m {MODULE}", description=__doc__)
    parser.add_argument("-e", "--engine", action="append", help="beside the analytic model (default: pymunk)")
    parser.add_argument("--count", type=int, default=SIDE * SIDE, help="points of the grid")
    parser.add_argument("--on", choices=PLACES, action="append", help="default: both")
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args(argv)
    names = (MODEL, *(given.engine or ["pymunk"]))
    rows = read(ROWS) if ROWS.exists() else []
    with closing(LocalPool(given.jobs)) as pool, Store(Path("out") / "trust_grid" / "store.sqlite", "trust") as store:
        for place in given.on or PLACES:
            points = Points(store, Campaign(store, pool))
            fresh = list(compared(plane_of(place), names, points, given.count))
            rows = [row for row in rows if (row.stands_on, row.engines) != (place, " ".join(names))] + fresh
            write(rows, ROWS)
    renew("measured/trust_grid.md", MODULE, text(rows))


if __name__ == "__main__":
    main()
