"""What collision shapes of the statue cost and leave: `python -m meshes.bench_shapes` prints docs/meshes.md's table."""

from __future__ import annotations

import time
from typing import Final

from meshes import togatus
from meshes.collision import hull
from meshes.decomposition import decompose

BUDGETS: Final = (64, 128, 256)
CONCAVITY: Final = (0.08, 0.05)


def rows() -> list[str]:
    """One line for each shape: what it is made of, what it leaves or adds, processor time to make it."""
    solid = togatus.build()
    found = []
    for budget in BUDGETS:
        begin = time.process_time()
        made = hull(solid, budget)
        found.append(
            f"hull of {len(made.vertices_m)} vertices: gaps up to {1e3 * made.gap_m:.1f} mm, volume"
            f" {100.0 * made.volume_rel:+.2f} % of the full hull's, {time.process_time() - begin:.2f} s"
        )
    for concavity in CONCAVITY:
        begin = time.process_time()
        parts = decompose(solid, concavity)
        found.append(
            f"{len(parts.parts)} convex parts (concavity {concavity:g}): volume {100.0 * parts.excess_rel:+.1f} % of the"
            f" body's, {time.process_time() - begin:.1f} s"
        )
    return found


if __name__ == "__main__":
    print("\n".join(rows()))
