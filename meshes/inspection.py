"""What a scan is, in numbers and words: raw counts, the log of its preparation, the solid and its slenderness."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from meshes import footprint as base
from meshes.intake import read_mesh
from meshes.mesh import MeshError, RawMesh
from meshes.prepare import Prepared, Wanted, prepare_mesh
from meshes.processing_log import EdgeCount, parts
from meshes.solid import CONTACT_TOLERANCE_M, Solid


@dataclass(frozen=True, eq=False)
class Inspection:
    """A scan inspected: as read, prepared, and its solid (None with the reason where it does not stand)."""

    raw: RawMesh
    prepared: Prepared
    solid: Solid | None
    refusal: MeshError | None

    def rose(self, step_deg: int = 30) -> list[dict[str, float]]:
        """Corner distance and slenderness towards every `step_deg` of azimuth."""
        if self.solid is None:
            return []
        azimuth = np.arange(0, 360, step_deg, dtype=np.float64)
        corner = base.corner_m(self.solid.footprint_m, azimuth)
        slender = base.slenderness_rose_rad(self.solid.footprint_m, self.solid.centroid_height_m, azimuth)
        rows = zip(azimuth.tolist(), corner.tolist(), np.rad2deg(slender).tolist(), strict=True)
        return [{"azimuth_deg": a, "corner_m": b, "slenderness_deg": c} for a, b, c in rows]

    def as_dict(self) -> dict[str, object]:
        """The inspection as plain values."""
        return {
            "schema_version": 1,
            "raw": _counts(self.raw),
            "refusal": None if self.refusal is None else str(self.refusal),
            "solid": None if self.solid is None else _numbers(self.solid),
            "rose": self.rose(10),
        }

    def facts(self) -> list[str]:
        """The file as read, and the solid in words, or why there is none."""
        return [
            f"as read: {_counted(self.raw)}",
            *(["no solid: " + str(self.refusal)] if self.solid is None else _sentences(self.solid)),
        ]

    def rose_lines(self) -> list[str]:
        """Slenderness in degrees towards every 30°; nothing without a solid."""
        if self.solid is None:
            return []
        return [
            "  "
            + "  ".join(
                f"{row['azimuth_deg']:3.0f}°: {row['slenderness_deg']:5.2f}" for row in self.rose()[begin : begin + 6]
            )
            for begin in (0, 6)
        ]


def inspect(
    path: str | Path,
    wanted: Wanted,
    *,
    density_kg_m3: float | None = None,
    mass_kg: float | None = None,
    contact_tolerance_m: float = CONTACT_TOLERANCE_M,
) -> Inspection:
    """Read, prepare and measure a scan; raises MeshError where it cannot be prepared."""
    mesh = read_mesh(path)
    prepared = prepare_mesh(mesh, wanted, Path(path).suffix.lower())
    solid, refusal = None, None
    try:
        solid = prepared.solid(density_kg_m3=density_kg_m3, mass_kg=mass_kg, contact_tolerance_m=contact_tolerance_m)
    except MeshError as error:
        refusal = error
    return Inspection(mesh, prepared, solid, refusal)


def _counts(mesh: RawMesh) -> dict[str, object]:
    """The file as it came: size in its own units, and what keeps it from being a solid."""
    return {
        "vertices": len(mesh.vertices),
        "faces": len(mesh.faces),
        "size": np.ptp(mesh.vertices, axis=0).tolist(),
        "parts": int(parts(mesh.faces).max()) + 1,
        "edges": asdict(EdgeCount.of(mesh.faces)),
    }


def _counted(mesh: RawMesh) -> str:
    """The same in words."""
    edges, count = EdgeCount.of(mesh.faces), _counts(mesh)
    size = " × ".join(f"{extent:.4g}" for extent in np.ptp(mesh.vertices, axis=0))
    return (
        f"{count['vertices']} vertices, {count['faces']} triangles, {size} units,"
        f" {count['parts']} part{'s' if count['parts'] != 1 else ''};"
        f" {'closed' if edges.closed else 'not closed'}: {edges.boundary} open, {edges.branching} branching,"
        f" {edges.misoriented} misoriented edges"
    )


def _numbers(solid: Solid) -> dict[str, object]:
    """The solid's numbers as plain values; its weakest direction is that in which it overturns most easily."""
    weakest_deg = base.weakest_azimuth_deg(solid.footprint_m)
    slenderness_rad = base.slenderness_rose_rad(solid.footprint_m, solid.centroid_height_m, weakest_deg)
    return {
        "mass_kg": solid.mass_kg,
        "density_kg_m3": solid.density_kg_m3,
        "height_m": solid.height_m,
        "centroid_height_m": solid.centroid_height_m,
        "corner_left_m": solid.corner_left_m,
        "corner_right_m": solid.corner_right_m,
        "depth_m": solid.depth_m,
        "inertia_kg_m2": solid.inertia_kg_m2.tolist(),
        "principal_kg_m2": solid.principal[0].tolist(),
        "principal_axes": solid.principal[1].T.tolist(),
        "footprint_m": solid.footprint_m.tolist(),
        "base_profile_m": solid.base_profile_m.tolist(),
        "contact_tolerance_m": solid.contact_tolerance_m,
        "base_unevenness_m": float(np.ptp(solid.feet_m[:, 2])),
        "weakest_azimuth_deg": weakest_deg,
        "weakest_slenderness_rad": float(slenderness_rad[0]),
    }


def _sentences(solid: Solid) -> list[str]:
    """The solid in words."""
    numbers: dict[str, Any] = _numbers(solid)
    moments = ", ".join(f"{value:.5g}" for value in numbers["principal_kg_m2"])
    uneven_mm = round(1e3 * numbers["base_unevenness_m"], 2)
    lie = f"uneven by {uneven_mm:g} mm (kept as scanned)" if uneven_mm else "in one plane"
    return [
        f"mass {solid.mass_kg:.5g} kg at {solid.density_kg_m3:.5g} kg/m³, {solid.height_m:.4g} m high,"
        f" centroid at {solid.centroid_height_m:.4g} m",
        f"x-z plane: b_left {solid.corner_left_m:.4g} m, b_right {solid.corner_right_m:.4g} m,"
        f" J_G {solid.inertia_planar_kg_m2:.5g} kg m²; base {solid.depth_m:.4g} m across",
        f"principal moments {moments} kg m²",
        f"touches with {len(solid.footprint_m)} corners within {1e3 * solid.contact_tolerance_m:g} mm,"
        f" {len(solid.feet_m)} feet {lie}",
        f"weakest towards {numbers['weakest_azimuth_deg']:.1f}° (from x, counter-clockwise from above):"
        f" {np.rad2deg(numbers['weakest_slenderness_rad']):.2f}°",
    ]
