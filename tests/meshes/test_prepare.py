"""The scanner bench: a statue of known truth scanned with every fault, and recovered; the log says what was done."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meshes import MeshError, Solid, load_solid
from meshes import prepare as module
from meshes.doubts import doubts
from meshes.mesh import RawMesh
from meshes.prepare import Prepared, Wanted, prepare, prepare_mesh
from meshes.processing_log import EdgeCount, measure
from meshes.solid import mass_properties
from tests.budgets_meshes import CORNER_ASKED_M, DECIMATION_VOLUME_REL, QUIET_SCAN_REL, ROUND_OFF_REL, SURVEY_ASKED_REL
from tests.meshes.scanner import COARSE, Faults, scan, write

DENSITY = 2700.0


def test_mass_properties_and_corners_are_recovered(statue: Solid, noisy: Prepared) -> None:
    solid = noisy.solid(density_kg_m3=DENSITY)
    for name in ("mass_kg", "centroid_height_m", "inertia_planar_kg_m2"):
        assert getattr(solid, name) == pytest.approx(getattr(statue, name), rel=SURVEY_ASKED_REL), name
    for name in ("corner_left_m", "corner_right_m", "depth_m"):
        assert getattr(solid, name) == pytest.approx(getattr(statue, name), abs=CORNER_ASKED_M), name


def test_the_account_names_every_step_with_its_effect(noisy: Prepared) -> None:
    log = noisy.log
    assert [change.step for change in log.changes] == ["debris", "up axis", "scale", "base", "decimation"]
    assert log.changes[0].count == COARSE.debris
    base = log.changes[3]
    assert 0.0 < base.volume_rel < 0.01
    assert base.code == "prepared_base"
    assert base.centroid_m is not None


def test_the_result_is_closed_and_in_metres(noisy: Prepared, tmp_path: Path) -> None:
    assert EdgeCount.of(noisy.mesh.faces).closed
    assert len(noisy.mesh.faces) < 31_000
    noisy.write(tmp_path / "prepared.ply")
    again = load_solid(tmp_path / "prepared.ply", unit="m", density_kg_m3=DENSITY)
    assert again.mass_kg == pytest.approx(noisy.solid(density_kg_m3=DENSITY).mass_kg, rel=1e-6)


@pytest.mark.parametrize("up", ["z", "-z", "x", "-x", "-y"])
def test_any_up_axis_is_found(statue: Solid, up: str) -> None:
    faults = Faults(edge_m=0.05, noise_m=0.0, debris=0, up=up, units_per_m=1.0)
    solid = prepare_mesh(scan(statue, faults), Wanted(unit="m")).solid(density_kg_m3=DENSITY)
    assert solid.mass_kg == pytest.approx(statue.mass_kg, rel=QUIET_SCAN_REL)
    assert solid.corner_right_m == pytest.approx(statue.corner_right_m, abs=CORNER_ASKED_M)


def test_a_closed_body_on_its_side_is_stood_up(statue: Solid) -> None:
    faults = Faults(edge_m=1.0, noise_m=0.0, debris=0, open_below=False, up="x", units_per_m=1.0)
    prepared = prepare_mesh(scan(statue, faults), Wanted(unit="m"))
    solid = prepared.solid(density_kg_m3=DENSITY)
    assert solid.corner_right_m == pytest.approx(statue.corner_right_m, rel=1e-6)
    assert [change.step for change in prepared.log.changes] == ["up axis"]


def test_scale_from_a_known_height(statue: Solid) -> None:
    faults = replace(COARSE, edge_m=0.05, noise_m=0.0, units_per_m=3.7)
    solid = prepare_mesh(scan(statue, faults), Wanted(height_m=statue.height_m)).solid(density_kg_m3=DENSITY)
    assert solid.height_m == pytest.approx(statue.height_m, rel=ROUND_OFF_REL)
    assert solid.mass_kg == pytest.approx(statue.mass_kg, rel=3 * QUIET_SCAN_REL)


def test_glb_is_in_metres_by_its_standard(statue: Solid, tmp_path: Path) -> None:
    file = write(
        scan(statue, Faults(edge_m=1.0, noise_m=0.0, debris=0, open_below=False, units_per_m=1.0)), tmp_path / "s.glb"
    )
    assert prepare(file, Wanted(up="y")).solid(density_kg_m3=DENSITY).mass_kg == pytest.approx(statue.mass_kg, rel=1e-5)


def test_inside_out_is_turned_and_accounted(statue: Solid) -> None:
    inside_out = RawMesh(statue.vertices_m, np.ascontiguousarray(statue.faces[:, ::-1]), "scan")
    prepared = prepare_mesh(inside_out, Wanted(unit="m"))
    assert [change.step for change in prepared.log.changes] == ["orientation"]
    assert prepared.solid(density_kg_m3=DENSITY).mass_kg == pytest.approx(statue.mass_kg, rel=ROUND_OFF_REL)


def test_some_faces_turned_are_turned_back(statue: Solid) -> None:
    faces = statue.faces.copy()
    faces[::7] = faces[::7, ::-1]
    prepared = prepare_mesh(RawMesh(statue.vertices_m, faces, "scan"), Wanted(unit="m"))
    assert prepared.log.changes[0].count == len(faces[::7])
    assert measure(prepared.mesh).volume_m3 == pytest.approx(statue.mass_kg / DENSITY, rel=ROUND_OFF_REL)


def test_small_holes_are_closed_and_accounted(statue: Solid) -> None:
    middle = statue.vertices_m[statue.faces].mean(axis=1)
    kept = np.linalg.norm(middle - middle[len(middle) // 2], axis=1) > 0.03
    prepared = prepare_mesh(RawMesh(statue.vertices_m, statue.faces[kept], "scan"), Wanted(unit="m", up="z"))
    assert "holes" in [change.step for change in prepared.log.changes]
    assert measure(prepared.mesh).volume_m3 == pytest.approx(statue.mass_kg / DENSITY, rel=QUIET_SCAN_REL)


def test_a_wide_hole_is_refused_with_advice(statue: Solid) -> None:
    middle = statue.vertices_m[statue.faces].mean(axis=1)
    kept = np.linalg.norm(middle - np.array([0.1, 0.0, 0.9]), axis=1) > 0.3
    with pytest.raises(MeshError, match="MeshLab"):
        prepare_mesh(RawMesh(statue.vertices_m, statue.faces[kept], "scan"), Wanted(unit="m", up="z"))


def test_the_limit_on_repair_is_a_limit(statue: Solid, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_INVENTED_REL", 1e-6)
    with pytest.raises(MeshError, match=r"0\.0001 %, got .*debris .* base ") as refused:
        prepare_mesh(scan(statue, replace(COARSE, edge_m=0.05)), Wanted(unit="mm"))
    assert "base" in refused.value.got, "which step invents is named"
    assert "ProcessingLog" not in str(refused.value)


def test_decimation_keeps_its_bounds_and_every_base_vertex(statue: Solid) -> None:
    dense = scan(statue, Faults(edge_m=0.04, noise_m=0.0, debris=0, open_below=False, up="z", units_per_m=1.0))
    prepared = prepare_mesh(dense, Wanted(unit="m", up="z", max_faces=12_000))
    made = prepared.log.changes[-1]
    assert made.step == "decimation"
    assert made.volume_rel is not None
    assert abs(made.volume_rel) <= DECIMATION_VOLUME_REL
    base = {tuple(vertex) for vertex in dense.vertices[dense.vertices[:, 2] <= 1e-3]}
    left = {tuple(vertex) for vertex in prepared.mesh.vertices}
    assert base <= left


@pytest.mark.parametrize(
    ("most", "bounds", "says"),
    [
        (2_000, {"MOST_VOLUME_REL": 1e-9}, "volume"),
        (2_000, {"MOST_VOLUME_REL": 1.0, "MOST_CENTROID_SHARE": 1e-12}, "centroid"),
        (100, {}, "base"),
    ],
)
def test_more_faces_than_asked_are_explained(
    most: int, bounds: dict[str, float], says: str, statue: Solid, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, limit in bounds.items():
        monkeypatch.setattr(module, name, limit)
    mesh = RawMesh(np.array(statue.vertices_m), np.array(statue.faces), "statue")
    enough = prepare_mesh(mesh, Wanted(unit="m", up="z", max_faces=len(mesh.faces)))
    assert "scan_faces_kept" not in {each.code for each in enough.log.found}
    prepared = prepare_mesh(mesh, Wanted(unit="m", up="z", max_faces=most))
    (told,) = [each.values for each in prepared.log.found if each.code == "scan_faces_kept"]
    assert len(prepared.mesh.faces) > most
    assert (told["faces"], told["asked"], told["cause"]) == (len(prepared.mesh.faces), most, says)


def test_measure_agrees_with_trimesh(statue: Solid) -> None:
    ours = measure(RawMesh(statue.vertices_m, statue.faces, "solid"))
    theirs = mass_properties(statue.vertices_m, statue.faces)
    assert ours.volume_m3 == pytest.approx(theirs.volume_m3, rel=ROUND_OFF_REL)
    np.testing.assert_allclose(
        ours.inertia_per_density_m5, theirs.inertia_per_density_m5, atol=1e-3 * ROUND_OFF_REL**0.5
    )


@pytest.mark.parametrize(
    ("name", "wanted", "watertight_as_read", "volume_m3"),
    [
        ("maria.obj", Wanted(unit="m"), True, 0.1935),
        ("maria_acephalous.obj", Wanted(unit="m"), True, None),
        ("demosthenes-low-res.obj", Wanted(height_m=0.7), False, None),
    ],
)
def test_real_scans_become_watertight_and_raise_no_alarm(
    data_dir: Path, name: str, wanted: Wanted, watertight_as_read: bool, volume_m3: float | None
) -> None:
    prepared = prepare(data_dir / "meshes" / name, wanted)
    assert EdgeCount.of(prepared.mesh.faces).closed
    assert ("base" in [change.step for change in prepared.log.changes]) != watertight_as_read
    assert doubts(prepared.mesh.vertices, prepared.mesh.faces, "{}") == ()
    mass_kg = prepared.solid(density_kg_m3=DENSITY).mass_kg
    assert mass_kg > 50.0
    if volume_m3 is not None:
        assert prepared.log.changes == (), "what is closed is left as it is"
        assert mass_kg / DENSITY == pytest.approx(volume_m3, abs=1e-4)
