"""A floor scanned with the statue, and surfaces that cross themselves: seen, refused with the cut, else no alarm."""

import re
import resource
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from harness.input.scene_file import load_scene
from meshes import MeshError, Solid
from meshes import doubts as module
from meshes.beside import SHEET, SHEET_WIDER, WIDER, attached_floor, cut_below
from meshes.doubts import MOST_PINCHED, MOST_WRONG, crossings, pinched, wrongly_sided
from meshes.mesh import RawMesh
from meshes.prepare import Prepared, Wanted, inspect, prepare, prepare_mesh
from meshes.processing_log import EdgeCount
from meshes.repair import Part
from tests import doubles
from tests.budgets_meshes import CUT_VOLUME_REL, FORMER_LIMIT, NOISE_REL
from tests.meshes import toadstool
from tests.meshes.loft import loft
from tests.meshes.scanner import write
from tests.meshes.shapes import slab, together, union

FLOOR_M = 6.0
SLAB_M = 0.04


def hourglass(around: int, levels: int, top_m: float) -> Part:
    """Rings whose radius goes from 0.3 m through nought to `top_m` < 0: the wall crosses itself at the neck."""
    turn = 2.0 * np.pi * np.arange(around) / around
    rings = [
        np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(around, height)])
        for radius, height in zip(np.linspace(0.3, top_m, levels), np.linspace(0.0, 1.5, levels), strict=True)
    ]
    return loft(np.stack(rings))


@pytest.fixture(scope="module")
def on_a_slab(statue: Solid) -> RawMesh:
    """The generated statue with 6 m by 6 m of floor, closed below."""
    body = (np.array(statue.vertices_m), np.array(statue.faces))
    return RawMesh(*union([body, slab(0.5 * FLOOR_M, 0.5 * FLOOR_M, -0.5 * SLAB_M, 0.5 * SLAB_M)]), "slab")


@pytest.fixture(scope="module")
def on_a_sheet(on_a_slab: RawMesh) -> RawMesh:
    """The same as a scanner sees it: the floor from above only, open all round."""
    seen = on_a_slab.vertices[on_a_slab.faces][:, :, 2].min(axis=1) > 0.0
    return on_a_slab.with_faces(on_a_slab.faces[seen])


@pytest.mark.parametrize("name", ["on_a_slab", "on_a_sheet"])
def test_a_floor_is_refused_with_the_cut_that_takes_it_off(
    name: str, statue: Solid, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    file = write(request.getfixturevalue(name), tmp_path / "floor.ply")
    with pytest.raises(MeshError, match="--cut-below") as caught:
        inspect(file, Wanted(unit="m", up="z"), density_kg_m3=2700.0)
    told = re.search(r"--cut-below ([0-9.]+) \(", str(caught.value))
    found = inspect(file, Wanted(unit="m", up="z", cut_below_m=float(told.group(1))), density_kg_m3=2700.0)
    lost = 0.5 * SLAB_M if name == "on_a_slab" else SLAB_M
    assert found.solid.height_m == pytest.approx(statue.height_m - lost, abs=lost)
    assert found.solid.mass_kg == pytest.approx(statue.mass_kg, rel=CUT_VOLUME_REL)
    assert "cut" in {change.step for change in found.prepared.log.changes}


def test_a_cut_within_the_floor_leaves_a_floor(on_a_slab: RawMesh) -> None:
    with pytest.raises(MeshError, match="--cut-below"):
        prepare_mesh(on_a_slab, Wanted(unit="m", up="z", cut_below_m=0.5 * SLAB_M))
    with pytest.raises(MeshError, match=r"got 3 m$"):
        prepare_mesh(on_a_slab, Wanted(unit="m", up="z", cut_below_m=3.0))


def test_a_floor_that_is_the_statue_s_own_is_kept_when_told(on_a_slab: RawMesh) -> None:
    mesh = prepare_mesh(on_a_slab, Wanted(unit="m", up="z", cut_below_m=0.0)).mesh
    assert float(np.ptp(mesh.vertices[:, 0])) == pytest.approx(FLOOR_M)


def test_the_slab_is_wider_by_what_was_built(on_a_slab: RawMesh, statue: Solid) -> None:
    floor = attached_floor(on_a_slab.vertices, on_a_slab.faces)
    assert SLAB_M <= floor.cut_m <= 2.0 * SLAB_M
    assert floor.times >= FLOOR_M**2 / float(ConvexHull(statue.vertices_m[:, :2]).volume)
    # A plate of a little less than the limit is a plinth.
    pillar = slab(0.5, 0.5, 0.0, 2.0)
    for times, seen in ((0.98 * WIDER, False), (1.02 * WIDER, True)):
        half = 0.5 * times**0.5
        stepped = union([pillar, slab(half, half, -0.05, 0.05)])
        assert attached_floor(*stepped).certain is seen  # a wide plinth is said, and kept


@pytest.mark.parametrize("times", [2.0, 2.4, 2.9])
def test_a_thin_floor_of_under_three_times_the_base_is_seen(times: float, statue: Solid) -> None:
    base = statue.footprint_m[:, :2]
    width = (times * float(np.prod(np.ptp(base, axis=0)))) ** 0.5
    assert width**2 < WIDER * float(np.prod(np.ptp(base, axis=0)))
    body = (np.array(statue.vertices_m), np.array(statue.faces))
    thick = 0.5 * SHEET * statue.height_m
    square = union([body, slab(0.5 * width, 0.5 * width, -0.5 * thick, 0.5 * thick)])
    floor = attached_floor(*square)
    assert width**2 > SHEET_WIDER * float(ConvexHull(statue.vertices_m[:, :2]).volume)
    assert floor.cut_m == pytest.approx(thick, abs=0.005 * statue.height_m)


def test_a_cut_is_level_and_open_only_there(statue: Solid) -> None:
    mesh = cut_below(RawMesh(np.array(statue.vertices_m), np.array(statue.faces), "statue"), 0.3)
    count = EdgeCount.of(mesh.faces)
    assert count.boundary > 0
    assert count.branching == count.misoriented == 0
    edges = np.sort(np.vstack([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]]), axis=1)
    ends, uses = np.unique(edges, axis=0, return_counts=True)
    assert np.ptp(mesh.vertices[ends[uses == 1].ravel(), 2]) == 0.0


@pytest.mark.parametrize(
    ("around", "levels", "top_m"), [(4, 2, -0.24), (16, 4, -0.15), (64, 160, -0.15), (64, 200, -0.2)]
)
def test_an_hourglass_is_no_body(around: int, levels: int, top_m: float, tmp_path: Path) -> None:
    part = hourglass(around, levels, top_m)
    assert EdgeCount.of(part[1]).closed
    file = write(RawMesh(*part, "hourglass"), tmp_path / "hourglass.ply")
    with pytest.raises(MeshError, match="hourglass"):
        prepare(file, Wanted(unit="m", up="z"))
    scene = tmp_path / "scene.toml"
    scene.write_text(
        'title = "t"\nduration_s = 1.0\n[statue]\nmesh = { file = "hourglass.ply", unit = "m", density_kg_m3 = 2700.0 }\n'
        '[motion.x]\nkind = "pulse"\nshape = "one_sine"\namplitude_g = 0.1\nduration_s = 0.5\n'
    )
    assert {"scan_pinched", "scan_wrongly_sided"} & set(doubles.codes(load_scene(scene).findings))


def test_what_is_inside_out_or_buried_is_measured() -> None:
    vertices, faces = slab(0.5, 0.5, 0.0, 2.0)
    assert wrongly_sided(vertices, faces) == pinched(vertices, faces) == 0.0
    buried = together((vertices, faces), slab(0.25, 0.25, 0.5, 1.5))
    share = 2.5 / 12.5  # areas of the inner and of both boxes
    assert wrongly_sided(*buried) == pytest.approx(share, abs=3.0 * (share * (1.0 - share) / 400) ** 0.5)


def test_good_bodies_raise_no_alarm(statue: Solid, noisy: Prepared) -> None:
    scanned = noisy.mesh.vertices, noisy.mesh.faces
    for vertices, faces in ((statue.vertices_m, statue.faces), toadstool.surface(), scanned):
        assert attached_floor(vertices, faces) is None
        assert pinched(vertices, faces) < 0.2 * MOST_PINCHED
        assert wrongly_sided(vertices, faces) < 0.5 * MOST_WRONG


def test_noise_that_folds_a_few_faces_is_said_and_refuses_nothing() -> None:
    turn = 2.0 * np.pi * np.arange(60) / 60
    heights = np.linspace(0.0, 1.0, 60)
    vertices, faces = loft(
        np.stack([np.column_stack([0.3 * np.cos(turn), 0.3 * np.sin(turn), 0 * turn + z]) for z in heights])
    )
    quiet = RawMesh(vertices, faces, "quiet")
    inside = (vertices[:, 2:] > 0.05) & (vertices[:, 2:] < 1.0)
    noise = 0.4 / 59 * np.random.default_rng(0).normal(size=vertices.shape) * inside
    clean, noisy = (
        prepare_mesh(quiet.moved(vertices + each), Wanted(unit="m", up="z")) for each in (0.0 * noise, noise)
    )
    (doubt,) = crossings(noisy.mesh.vertices, noisy.mesh.faces)
    assert doubt.values["share"] > FORMER_LIMIT
    assert doubt in noisy.log.found
    masses = [each.solid(density_kg_m3=2700.0).mass_kg for each in (clean, noisy)]
    assert masses[1] == pytest.approx(masses[0], rel=NOISE_REL)


def test_a_fan_of_20_000_triangles_is_looked_at_within_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_PAIRS", 2_000_000)
    around = 20_000
    turn = 2.0 * np.pi * np.arange(around) / around
    vertices = np.vstack([np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn]), [[0.0, 0.0, 0.0]]])
    faces = np.column_stack([np.arange(around), (np.arange(around) + 1) % around, np.full(around, around)])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    piercing, looked_at = module._piercing(vertices, faces, np.arange(around), shared=0)
    assert not piercing.size
    assert 0 < looked_at < around
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1_000_000  # KiB; all pairs are 6 GB
