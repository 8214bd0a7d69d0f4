"""Bases of more than two vertices (docs/model.md, section 8) beside pymunk with the same polygon.

`python -m tests.measures.profiles` runs every body and motion and renews docs/measured/profiles.md.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Final, final

import numpy as np

from analytic.block import GRAVITY_M_S2
from analytic.excitation import Excitation, Harmonic, ZeroExcitation
from harness import Run, RunOptions, engines
from harness.comparison.scores import errors
from harness.input.mesh_statue import statue_of
from harness.model import BaseExcitation, Contact, Form, Initial, Scene, Statue, block_of
from meshes.solid import solid_from_mesh
from tests.measures.pages import renew, table

WIDTH_M: Final = 0.4
HEIGHT_M: Final = 1.2
DEPTH_M: Final = 0.4
TOLERANCE_M: Final = 0.05
"""Every vertex of these bases belongs to the profile."""
BASES: Final[Mapping[str, tuple[tuple[float, float], ...]]] = {
    "bulging": ((-0.2, 0.012), (-0.07, 0.0), (0.07, 0.0), (0.2, 0.012)),
    "chipped": ((-0.2, 0.0), (0.15, 0.0), (0.2, 0.03)),
    "worn": ((-0.2, 0.02), (-0.17, 0.006), (-0.1, 0.0), (0.1, 0.0), (0.17, 0.006), (0.2, 0.02)),
    "uneven": ((-0.2, 0.0), (0.12, 0.0), (0.2, 0.004)),
    "keeled": ((-0.2, 0.010), (0.0, 0.0), (0.2, 0.012)),
}
"""Base vertices (x, z) in m; the keeled one can rest on either of its two facets."""
TILT_RAD: Final = 0.12
MOTIONS: Final[Mapping[str, Excitation]] = {
    "free from 0.12 rad": ZeroExcitation(),
    "0.5 g, 2 Hz": Harmonic(0.5 * GRAVITY_M_S2, 2.0),
    "0.6 g, 2 Hz": Harmonic(0.6 * GRAVITY_M_S2, 2.0),
}
STEPS_S: Final = (1e-3, 2.5e-4, 5e-5)


@final
@dataclass(frozen=True)
class Row:
    """One body under one motion: impacts of the model, its peak, and for each step the largest difference, rad."""

    base: str
    motion: str
    impacts: int
    peak_theta_rad: float
    differences_rad: tuple[float, ...]


def statue(base: Sequence[tuple[float, float]]) -> Statue:
    """A homogeneous prism of marble with that base, 0.4 × 0.4 × 1.2 m."""
    import trimesh

    half, across = 0.5 * WIDTH_M, 0.5 * DEPTH_M
    outline = [*base, (half, HEIGHT_M), (-half, HEIGHT_M)]
    hull = trimesh.convex.convex_hull(np.array([(x, y, z) for x, z in outline for y in (-across, across)]))
    return statue_of(solid_from_mesh(hull.vertices, hull.faces, density_kg_m3=2700.0, contact_tolerance_m=TOLERANCE_M))


def scene(body: Statue, motion: Excitation, duration_s: float = 1.0) -> Scene:
    """The body on the floor: tilted where nothing shakes it, else at rest on the facet below its centroid."""
    still = Scene(
        title="a base of many vertices",
        duration_s=duration_s,
        gravity_m_s2=GRAVITY_M_S2,
        form=Form(),
        statue=body,
        pedestal=None,
        contact=Contact(0.2, 0.2, 5.0),
        base_excitation=BaseExcitation(x=motion),
    )
    if isinstance(motion, ZeroExcitation):
        return replace(still, initial=Initial(TILT_RAD, 0.0))
    facets = block_of(still).arrays[2]
    return replace(still, initial=Initial(float(facets[np.argmin(np.abs(facets))]), 0.0))


def model(each: Scene) -> Run:
    """The analytic run to which the others are compared."""
    engine = engines.load("analytic")
    return engine.simulate(each, engine.refinement_levels(each)[1], RunOptions())


def rows(bases: Sequence[str] = tuple(BASES), steps_s: Sequence[float] = STEPS_S) -> Iterator[Row]:
    """Every body under every motion, pymunk at each step against the analytic model over the first second."""
    engine = engines.load("pymunk")
    for base in bases:
        body = statue(BASES[base])
        for name, motion in MOTIONS.items():
            each = scene(body, motion)
            exact = model(each)
            found = [
                errors(exact, engine.simulate(each, engine.settings_for_dt(each, dt), RunOptions()))[0]
                for dt in steps_s
            ]
            yield Row(base, name, len(exact.impact_times_s), exact.peak_theta_rad, tuple(found))


def lines_of(found: Iterable[Row]) -> list[list[str]]:
    """A line for each base: impacts and peaks under its motions, the largest difference of them all at each step."""
    lines = []
    for base, each in groupby(found, lambda row: row.base):
        mine = list(each)
        peaks = ", ".join(f"{row.peak_theta_rad:.3f}" for row in mine)
        largest = np.max([row.differences_rad for row in mine], axis=0)
        lines.append([base, ", ".join(str(row.impacts) for row in mine), peaks, *(f"{each:.0e}" for each in largest)])
    return lines


def main() -> None:
    """Renew the table."""
    head = ["base", "impacts", "peak θ", *(f"pymunk, {1e3 * dt:g} ms" for dt in STEPS_S)]
    said = f"Motions: {'; '.join(MOTIONS)}."
    renew("measured/profiles.md", "tests.measures.profiles", f"{said}\n\n{table(head, lines_of(rows()))}")


if __name__ == "__main__":
    main()
