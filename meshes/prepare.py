"""A scan made into a closed body standing on its base, with a written log; what goes too far is refused with advice.
What the scan then is, in numbers and words.
"""

from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Self

import numpy as np

from meshes import footprint as base
from meshes import repair
from meshes.beside import attached_floor, cut_below, cut_beyond
from meshes.doubts import crossings, floor_refused, not_one_body, other_attached
from meshes.intake import must_be_of_a_statue_s_size, must_have_size, must_have_thickness, read_mesh, unit_length_m
from meshes.mesh import Array, Doubt, MeshError, RawMesh, drop_unused, require, unique_rows, weld
from meshes.orientation import Orientation, find_orientation, turn_axis
from meshes.processing_log import Change, EdgeCount, ProcessingLog, parts
from meshes.repair import close_pinches, open_branches
from meshes.solid import CONTACT_TOLERANCE_M, Solid, solid_from_mesh

# Fewer triangles within stated bounds on volume, centroid and inertia; vertices of the base are never touched.

PINCHED_SHARE = 0.02
"""Edge collapses may pinch at most this share of the edges, or the decimation is given up."""

FEWEST = 100
"""Triangles that a statue above its base has at least: with fewer quadric errors say nothing of its shape."""

ROUNDS = 5
"""Closing one pinch may touch the next; rounds of opening and closing before the decimation is given up."""


MOST_VOLUME_REL = 1e-3
MOST_CENTROID_SHARE = 5e-4
MOST_INERTIA_REL = 2e-3
"""The most that decimation may change: volume, centroid as a share of the height, inertia."""


def decimate(mesh: RawMesh, max_faces: int) -> tuple[RawMesh, Change | None, tuple[Doubt, ...]]:
    """A closed mesh with about `max_faces` triangles, or with as few as the bounds allow; unchanged if that is not
    fewer. The third is why more were kept than asked, empty where they were not.
    """
    target, why = max_faces, dict[str, object]()
    fewer, made = mesh, None
    while made is None and target < 0.9 * len(mesh.faces):
        simpler = simplified(mesh, target, CONTACT_TOLERANCE_M)
        if isinstance(simpler, dict):
            broken = simpler
        else:
            faces = {"before": len(mesh.faces), "after": len(simpler.faces)}
            tried = Change("prepared_decimated", "decimation", faces, len(mesh.faces) - len(simpler.faces))
            tried = tried.measured(mesh, simpler)
            broken = _beyond(tried, float(np.ptp(mesh.vertices[:, 2])))
            if not broken:
                fewer, made = simpler, tried
        why = why or broken
        target *= 2
    kept = (Doubt("scan_faces_kept", {"faces": len(fewer.faces), "asked": max_faces, **why}),) if why else ()
    return fewer, made, kept


def _beyond(made: Change, height_m: float) -> dict[str, object]:
    """Which bound a decimation broke, and by how much; empty for none."""
    if made.volume_rel is None or made.centroid_m is None or made.inertia_rel is None:
        return {"cause": "encloses_nothing"}
    if abs(made.volume_rel) > MOST_VOLUME_REL:
        return {"cause": "volume", "change": made.volume_rel, "limit": MOST_VOLUME_REL}
    if made.centroid_m > MOST_CENTROID_SHARE * height_m:
        return {"cause": "centroid", "moved_m": made.centroid_m, "limit_m": MOST_CENTROID_SHARE * height_m}
    if abs(made.inertia_rel) > MOST_INERTIA_REL:
        return {"cause": "inertia", "change": made.inertia_rel, "limit": MOST_INERTIA_REL}
    return {}


def simplified(mesh: RawMesh, max_faces: int, keep_below_m: float) -> RawMesh | dict[str, object]:
    """The mesh with its faces above the base simplified by quadric error, or why that cannot be."""
    from fast_simplification import simplify

    low = (mesh.vertices[:, 2] <= mesh.vertices[:, 2].min() + keep_below_m)[mesh.faces].any(axis=1)
    target = max_faces - int(low.sum())
    if target < FEWEST or not (~low).any():
        return {"cause": "base", "base": int(low.sum()), "fewest": FEWEST}
    vertices, faces = drop_unused(mesh.vertices, mesh.faces[~low])
    reduction = 1.0 - target / len(faces)
    if reduction <= 0.0:
        return {"cause": "nothing_to_leave_out"}
    points, triangles = simplify(vertices, faces.astype(np.int32), reduction, preserve_border=True)[:2]
    base_vertices, base_faces = drop_unused(mesh.vertices, mesh.faces[low])
    joined = weld(
        RawMesh(
            np.vstack([base_vertices, points]),
            np.vstack([base_faces, triangles.astype(np.int64) + len(base_vertices)]),
            mesh.source,
        )
    )
    return _sound(joined) or {"cause": "breaks"}


def _sound(mesh: RawMesh) -> RawMesh | None:
    """The mesh without what edge collapses leave: faces back to back dropped, pinched edges opened, the holes
    closed."""
    for _ in range(ROUNDS):
        number = unique_rows(np.sort(mesh.faces, axis=1))[1]
        mesh = mesh.with_faces(mesh.faces[np.bincount(number)[number] == 1])
        if EdgeCount.of(mesh.faces).closed:
            return mesh
        try:
            mesh, _ = open_branches(mesh, PINCHED_SHARE)
            mesh = close_pinches(mesh)
        except MeshError:
            return None
    return None


MOST_INVENTED_REL = 0.05
"""Volume removed as debris and invented under the base and over holes: a repair that goes further is refused."""


@dataclass(frozen=True)
class Wanted:
    """What the caller knows of the scan: unit or true height, up axis; None is found (up) or refused (scale).

    `cut_below_m` above the lowest point is cut off (a floor scanned with the statue); 0: the lowest layer is the statue's own.
    `cut_beyond`, an azimuth in degrees and a distance in metres along it from the file's origin, cuts off a wall or a second
    body; an infinite distance says that all is the statue's own.
    """

    unit: str | float | None = None
    height_m: float | None = None
    up: str | None = None
    max_faces: int = 50_000
    cut_below_m: float | None = None
    cut_beyond: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Prepared:
    """A closed mesh in metres, z up, the log of what was done to it, and the rotation (3, 3) from the file's axes."""

    mesh: RawMesh
    log: ProcessingLog
    rotation: Array = field(default_factory=lambda: np.eye(3))

    def solid(
        self,
        *,
        density_kg_m3: float | None = None,
        mass_kg: float | None = None,
        contact_tolerance_m: float = CONTACT_TOLERANCE_M,
    ) -> Solid:
        """The solid of the prepared mesh; raises MeshError if it does not stand."""
        return solid_from_mesh(
            self.mesh.vertices,
            self.mesh.faces,
            density_kg_m3=density_kg_m3,
            mass_kg=mass_kg,
            contact_tolerance_m=contact_tolerance_m,
        )

    def after(self, mesh: RawMesh, made: Change | None) -> Self:
        """The state after one step, with its change in the log where it made one."""
        changes = self.log.changes if made is None else (*self.log.changes, made)
        return replace(self, mesh=mesh, log=replace(self.log, changes=changes))

    def doubted(self, *doubts: Doubt) -> Self:
        """The state with what was found in it and left as it was."""
        return replace(self, log=replace(self.log, found=(*self.log.found, *doubts)))

    def write(self, path: str | Path) -> None:
        """Write the mesh in metres, z up, in the format of the path's suffix."""
        import trimesh

        trimesh.Trimesh(self.mesh.vertices, self.mesh.faces, process=False).export(Path(path))


def prepare(path: str | Path, wanted: Wanted | None = None) -> Prepared:
    """Prepare a scan; raises MeshError where a repair would go beyond its limit."""
    return prepare_mesh(read_mesh(path), wanted or Wanted(), suffix=Path(path).suffix.lower())


def prepare_mesh(mesh: RawMesh, wanted: Wanted, suffix: str = "") -> Prepared:
    """Prepare a mesh already read; `suffix` tells whether its format fixes the unit (GLB and GLTF are in metres)."""
    state = Prepared(mesh, ProcessingLog(mesh.source))
    must_have_thickness(mesh)
    must_be_of_a_statue_s_size(mesh, wanted.unit)
    for repaired in (
        repair.drop_duplicates,
        repair.drop_debris,
        repair.open_branches,
        repair.wind_alike,
        repair.turn_outward,
        repair.join_bodies,
    ):
        state = state.after(*repaired(state.mesh))
    state = _cut(_scaled(_stood_up(state, wanted), wanted, suffix), wanted)
    for closed in (repair.close_base, repair.close_holes):
        state = state.after(*closed(state.mesh))
    state = _checked(_true_height(state, wanted))
    fewer, made, kept = decimate(state.mesh, wanted.max_faces)
    state = state.after(fewer, made).doubted(*kept)
    wrong = not_one_body(state.mesh.vertices, state.mesh.faces)
    if wrong is not None:
        raise wrong.at(state.mesh.source)
    return state


def _stood_up(state: Prepared, wanted: Wanted) -> Prepared:
    """The up axis turned to +z: as set, or found together with the base plane, which is then level."""
    if wanted.up is not None:
        orientation = Orientation(turn_axis(wanted.up), wanted.up, 0.0, "set")
    else:
        orientation = find_orientation(state.mesh)
    values: dict[str, object] = {"how": orientation.why, "axis": orientation.axis}
    if wanted.up is None:
        values["tilt_rad"] = orientation.tilt_rad
    turns = orientation.axis != "z" or orientation.tilt_rad > 1e-6
    turned = state.mesh.moved(state.mesh.vertices @ orientation.rotation.T)
    state = state.after(turned, Change("prepared_up", "up axis", values, 1) if turns else None)
    return replace(state.doubted(*orientation.doubts), rotation=orientation.rotation)


def _scaled(state: Prepared, wanted: Wanted, suffix: str) -> Prepared:
    """The mesh in metres, from the unit, the true height, or the unit that the format fixes."""
    height = float(np.ptp(state.mesh.vertices[:, 2]))
    require(
        wanted.unit is None or wanted.height_m is None,
        "the unit or the true height",
        "both",
        "give one of them",
        place=state.mesh.source,
    )
    if wanted.height_m is not None:
        require(
            np.isfinite(wanted.height_m) and wanted.height_m > 0.0,
            "a positive height in metres",
            str(wanted.height_m),
            place=state.mesh.source,
        )
        unit_m, why = wanted.height_m / height, "height"
    elif wanted.unit is not None:
        unit_m, why = unit_length_m(wanted.unit), "unit"
    elif suffix in (".glb", ".gltf"):
        unit_m, why = 1.0, "glTF"
    else:
        raise MeshError(
            "a scale",
            f"a file without units, {height:.4g} units high (that is {0.001 * height:.3g} m in mm,"
            f" {0.01 * height:.3g} m in cm, {height:.3g} m in m)",
            "give the unit (--unit) or the true height (--height)",
            place=state.mesh.source,
        )
    must_have_size(unit_m * height, f"{unit_m * height:.4g} m by its {why}", state.mesh.source)
    values = {"why": why, "unit_m": unit_m, "unit": wanted.unit, "height_m": wanted.height_m}
    in_metres = replace(state, log=state.log.scaled(unit_m))
    made = Change("prepared_scale", "scale", values, 1) if unit_m != 1.0 else None
    return in_metres.after(state.mesh.moved(unit_m * state.mesh.vertices), made)


def _cut(state: Prepared, wanted: Wanted) -> Prepared:
    """What was scanned with the statue cut off as asked, with debris that hung on it; what is still there is refused."""
    beyond = wanted.cut_beyond
    if wanted.cut_below_m:
        cut = Change("prepared_cut_below", "cut", {"below_m": wanted.cut_below_m}, 1)
        state = _without(state, cut_below(state.mesh, wanted.cut_below_m), cut)
    if beyond is not None and np.isfinite(beyond[1]):
        cut = Change("prepared_cut_beyond", "cut", {"azimuth_deg": beyond[0], "beyond_m": beyond[1]}, 1)
        state = _without(state, cut_beyond(state.mesh, *beyond), cut)
    body = state.mesh.vertices, state.mesh.faces
    floor = attached_floor(*body) if wanted.cut_below_m != 0.0 else None
    attached = floor_refused(floor, "")
    if attached is None and (beyond is None or np.isfinite(beyond[1])):
        attached = other_attached(*body, "")
    if attached is not None:
        raise attached.at(state.mesh.source)
    if floor is not None:
        return state.doubted(Doubt("scan_layer_kept", {"cut_m": floor.cut_m, "times": floor.times}))
    return state


def _without(state: Prepared, mesh: RawMesh, cut: Change) -> Prepared:
    return state.after(mesh, cut.measured(state.mesh, mesh)).after(*repair.drop_debris(mesh))


def _true_height(state: Prepared, wanted: Wanted) -> Prepared:
    """A known height is over the base plane, which is known only once the base is closed: the scale corrected by the rest."""
    if wanted.height_m is None:
        return state
    factor = wanted.height_m / float(np.ptp(state.mesh.vertices[:, 2]))
    if abs(factor - 1.0) < 1e-9:
        return state
    values = {"share": factor - 1.0, "height_m": wanted.height_m}
    return state.after(state.mesh.moved(factor * state.mesh.vertices), Change("prepared_height", "scale", values, 1))


def _checked(state: Prepared) -> Prepared:
    """What is still open or was changed too much is refused; where it crosses itself is said."""
    mesh, log = state.mesh, state.log
    count = EdgeCount.of(mesh.faces)
    require(
        count.closed,
        "a closed surface after repair",
        f"{count.boundary} open, {count.branching} branching and {count.misoriented} misoriented edges",
        "repair it in MeshLab (Repair filters) or Blender (3D Print toolbox)",
        place=mesh.source,
    )
    invented = log.invented_rel
    shares = ", ".join(f"{step} {100 * share:.3g} %" for step, share in invented.items() if share)
    require(
        sum(invented.values()) <= MOST_INVENTED_REL,
        f"repairs that change the volume by at most {100 * MOST_INVENTED_REL:g} %",
        f"{100 * sum(invented.values()):.3g} % ({shares})",
        "too much would be invented: scan again what is missing",
        place=mesh.source,
    )
    return state.doubted(*crossings(mesh.vertices, mesh.faces))


# What a scan is, in numbers and words: raw counts, the log of its preparation, the solid and its slenderness.


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
