"""A scan made into a closed body standing on its base, with a written log; what goes too far is refused with
advice."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from meshes import repair
from meshes.beside import attached_floor, cut_below, cut_beyond
from meshes.doubts import floor_refused, not_one_body, other_attached
from meshes.intake import (
    must_be_of_a_statue_s_size,
    must_have_size,
    must_have_thickness,
    read_mesh,
    unit_length_m,
)
from meshes.mesh import Array, Doubt, Faces, MeshError, RawMesh, drop_unused, require, unique_rows, weld
from meshes.orientation import Orientation, find_orientation, turn_axis
from meshes.processing_log import Change, EdgeCount, ProcessingLog
from meshes.repair import close_pinches, open_branches
from meshes.self_intersection import crossings
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

    level = mesh.vertices[:, 2].min() + keep_below_m
    low = (mesh.vertices[:, 2] <= level)[mesh.faces].any(axis=1)
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
    sound = _sound(joined)
    return {"cause": "breaks"} if sound is None else sound


def _sound(mesh: RawMesh) -> RawMesh | None:
    """The mesh without what edge collapses leave: faces back to back dropped, pinched edges opened, the holes
    closed."""
    for _ in range(ROUNDS):
        mesh = mesh.with_faces(_unfolded(mesh.faces))
        if EdgeCount.of(mesh.faces).closed:
            return mesh
        try:
            mesh, _ = open_branches(mesh, PINCHED_SHARE)
            mesh = close_pinches(mesh)
        except MeshError:
            return None
    return None


def _unfolded(faces: Faces) -> Faces:
    """The faces without those that lie on another one with the same three vertices."""
    number = unique_rows(np.sort(faces, axis=1))[1]
    return np.asarray(faces[np.bincount(number)[number] == 1])


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

    def after(self, mesh: RawMesh, made: Change | None) -> Prepared:
        """The state after one step, with its change in the log where it made one."""
        changes = self.log.changes if made is None else (*self.log.changes, made)
        return replace(self, mesh=mesh, log=replace(self.log, changes=changes))

    def doubted(self, *doubts: Doubt) -> Prepared:
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
    made = None
    if orientation.axis != "z" or orientation.tilt_rad > 1e-6:
        values: dict[str, object] = {"how": orientation.why, "axis": orientation.axis}
        if wanted.up is None:
            values["tilt_rad"] = orientation.tilt_rad
        made = Change("prepared_up", "up axis", values, 1)
    turned = state.mesh.moved(state.mesh.vertices @ orientation.rotation.T)
    return replace(state.after(turned, made).doubted(*orientation.doubts), rotation=orientation.rotation)


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
    made = None
    if unit_m != 1.0:
        values = {"why": why, "unit_m": unit_m, "unit": wanted.unit, "height_m": wanted.height_m}
        made = Change("prepared_scale", "scale", values, 1)
    in_metres = replace(state, log=state.log.scaled(unit_m))
    return in_metres.after(state.mesh.moved(unit_m * state.mesh.vertices), made)


def _cut(state: Prepared, wanted: Wanted) -> Prepared:
    """What was scanned with the statue cut off as asked, with debris that hung on it; what is still there is refused."""
    mesh, beyond = state.mesh, wanted.cut_beyond
    if wanted.cut_below_m:
        cut = Change("prepared_cut_below", "cut", {"below_m": wanted.cut_below_m}, 1)
        state = _without(state, cut_below(mesh, wanted.cut_below_m), cut)
    if beyond is not None and np.isfinite(beyond[1]):
        place = {"azimuth_deg": beyond[0], "beyond_m": beyond[1]}
        cut = Change("prepared_cut_beyond", "cut", place, 1)
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
