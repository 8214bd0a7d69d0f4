"""What hull and convex parts of a statue are, and where they touch, by exact geometry.

`python -m tests.measures.exact_shapes [STATUE...]` prints what they leave out or add, and when they meet a wall and an edge: of
the generated statues, and of the scans of the data folder where it is present.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from harness.input.files import data_folder
from meshes import Solid
from meshes.decomposition import Parts, decompose, parts_of
from meshes.prepare import Wanted, prepare
from meshes.solid import thinned
from tests.meshes import toadstool, togatus
from tests.meshes.shapes import misfit

Array = NDArray[np.float64]

BUDGETS: Final = (64, 128, 256)
CONCAVITIES: Final = (0.08, 0.05, 0.03)
SCANS: Final = {
    "maria_acephalous.obj": Wanted("m"),
    "maria.obj": Wanted("m"),
    "demosthenes-low-res.obj": Wanted(height_m=0.7),
}
MARBLE_KG_M3: Final = 2700.0
WALL_M: Final = 0.05
"""Distance of a wall from the outermost point of the statue."""
OWN_CORNER_M: Final = 0.05
"""Nearer to the corner than this what meets a pedestal is the base."""
TURN_RAD: Final = 1.5
"""A statue turned so far has overturned."""
GRID: Final = 61
ANGLE_RAD: Final = 1e-4
LEAST_M3: Final = 1e-9
"""Two bodies that share less than this only touch."""
UNDER_THE_CAP_M: Final = 0.45
BESIDE_M: Final = 0.15
"""How far the pedestal's edge lies beside the base; under the toadstool's cap further, so that the cap can meet it."""
SHAPES_HEAD: Final = (
    "| statue | hull: vertices, adds | parts: number, vertices, add, leave out | made |\n|---|---|---|---|"
)
CONTACT_HEAD: Final = (
    "| statue | meets a wall 0.05 m beside it at: mesh, hull, parts, rad | edge beside the corner"
    " | meets it at: mesh, hull, parts, rad |\n|---|---|---|---|"
)


def statues(scans: Path) -> Iterator[tuple[str, Solid]]:
    """Names and solids: the generated ones, and the scans that the folder has."""
    yield "toadstool (three boxes)", toadstool.build()
    yield "generated figure", togatus.build()
    for name, wanted in SCANS.items():
        if (scans / name).is_file():
            yield name, prepare(scans / name, wanted).solid(density_kg_m3=MARBLE_KG_M3)


def budgets() -> Iterator[str]:
    """The generated figure's hull within a budget, and its parts by their concavity."""
    yield "| shape | leaves or adds | processor time |\n|---|---|---|"
    solid = togatus.build()
    for budget in BUDGETS:
        begin = time.process_time()
        corners, gap_m = thinned(solid.vertices_m, budget)
        volume_rel = ConvexHull(corners).volume / ConvexHull(solid.vertices_m).volume - 1.0
        yield (
            f"| hull of {len(corners)} vertices | gaps up to {1e3 * gap_m:.1f} mm,"
            f" {100.0 * volume_rel:+.2f} % of the full hull's volume | {time.process_time() - begin:.2f} s |"
        )
    for concavity in CONCAVITIES:
        begin = time.process_time()
        parts = decompose(solid, concavity)
        took_s = time.process_time() - begin
        more, less = misfit(solid, parts)
        yield (
            f"| {len(parts)} convex parts (concavity {concavity:g}) | adds {100.0 * more:.1f} % to the body's"
            f" volume, leaves out {100.0 * less:.1f} % | {took_s:.1f} s |"
        )


@dataclass(frozen=True, eq=False)
class Bodies:
    """A statue, its hull and its parts as exact bodies (manifold3d), frame of the statue."""

    mesh: Any
    hull: Any
    parts: Any

    @classmethod
    def of(cls, solid: Solid, parts: Parts) -> Bodies:
        """The three of a solid."""
        from manifold3d import Manifold, Mesh64, OpType

        mesh = Manifold(Mesh64(np.array(solid.vertices_m), solid.faces.astype(np.uint64)))
        union = Manifold.batch_boolean([Manifold.hull_points(points) for points in parts], OpType.Add)
        return cls(mesh, Manifold.hull_points(np.array(solid.vertices_m)), union)


def shape_row(name: str, solid: Solid) -> str:
    """What hull and parts of a statue are made of, cost and add."""
    begin = time.process_time()
    parts = decompose(solid)
    made = time.process_time() - begin
    bodies = Bodies.of(solid, parts)
    corners = len(bodies.hull.to_mesh64().vert_properties)
    whole = 100.0 * (bodies.hull.volume() / bodies.mesh.volume() - 1.0)
    more, less = (100.0 * share for share in misfit(solid, parts))
    found = f"{len(parts)}, {sum(map(len, parts))}, +{more:.1f}, −{less:.1f} %"
    return f"| {name} | {corners}, +{whole:.0f} % | {found} | {made:.1f} s |"


def contact_row(name: str, solid: Solid) -> str:
    """When mesh, hull and parts meet a wall and the pedestal's edge as the statue turns about its right corner, rad."""
    beside_m = UNDER_THE_CAP_M if name.startswith("toadstool") else BESIDE_M
    bodies = Bodies.of(solid, parts_of(solid))
    three = (bodies.mesh, bodies.hull, bodies.parts)
    wall_m = float(solid.section_m[:, 0].max()) - solid.corner_right_m + WALL_M
    walls = [wall_rad(body, solid.corner_right_m, wall_m) for body in three]
    edges = [edge_rad(body, solid.corner_right_m, beside_m) for body in three]
    at_wall, at_edge = (", ".join(f"{x:.4f}" if x < TURN_RAD else "never" for x in row) for row in (walls, edges))
    return f"| {name} | {at_wall} | {beside_m:g} m | {at_edge} |"


def wall_rad(body: Any, corner_m: float, wall_m: float) -> float:
    """Rotation about the right corner at which a body comes to a wall at `wall_m` from it; by its vertices, exact."""
    points = body.to_mesh64().vert_properties[:, [0, 2]] - np.array([corner_m, 0.0])

    def met(theta: float) -> bool:
        return bool(np.max(points[:, 0] * math.cos(theta) + points[:, 1] * math.sin(theta)) > wall_m)

    return _first(met)


def edge_rad(body: Any, corner_m: float, beside_m: float) -> float:
    """The same for the edge of a pedestal, `beside_m` beside the corner; the exact bodies are intersected."""
    from manifold3d import Manifold

    turning = body.translate((-corner_m, 0.0, 0.0))
    block = Manifold.cube((beside_m - OWN_CORNER_M, 10.0, 1.0)).translate((OWN_CORNER_M, -5.0, -1.0))

    def met(theta: float) -> bool:
        return bool((turning.rotate((0.0, math.degrees(theta), 0.0)) ^ block).volume() > LEAST_M3)

    return _first(met)


def _first(met: Callable[[float], bool]) -> float:
    """The least rotation at which something is met, on a grid, then by halving; infinite where it is not."""
    low = 0.0
    for high in np.linspace(0.0, TURN_RAD, GRID)[1:].tolist():
        if met(high):
            while high - low > ANGLE_RAD:
                middle = 0.5 * (low + high)
                low, high = (low, middle) if met(middle) else (middle, high)
            return float(high)
        low = high
    return math.inf


def main(names: Sequence[str]) -> None:
    """Print the tables, of the named statues or all."""
    solids = [each for each in statues(data_folder() / "meshes") if not names or each[0] in names]
    for table in (
        budgets(),
        (SHAPES_HEAD, *(shape_row(*each) for each in solids)),
        (CONTACT_HEAD, *(contact_row(*each) for each in solids)),
    ):
        print(*table, sep="\n", end="\n\n")


if __name__ == "__main__":
    main(sys.argv[1:])
