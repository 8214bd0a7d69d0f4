"""A hull of few corners lies within the full one; convex parts cover the statue, are the same each time, and made once."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from meshes import MeshError, Solid, coacd_alone, decomposition
from meshes.decomposition import Parts, decompose, parts_of
from meshes.solid import solid_from_mesh, thinned
from tests.budgets_meshes import BOXES_REL, HULL_GAP_M, PARTS_MISSING_REL, WITHIN_HULL_M
from tests.meshes import toadstool
from tests.meshes.shapes import box, misfit

COARSE = {"concavity": 0.2, "max_parts": 8, "max_vertices": 32}


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    parts_of.cache_clear()
    return tmp_path / "rockcheck" / "meshes"


def same(one: Parts, other: Parts) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def convex(points: np.ndarray) -> bool:  # type: ignore[type-arg]
    return len(ConvexHull(points).vertices) == len(points)


def test_parts_cover_the_statue_within_its_hull(statue: Solid) -> None:
    found = decompose(statue, **COARSE)  # type: ignore[arg-type]
    hull = ConvexHull(statue.vertices_m)
    assert 2 <= len(found) <= COARSE["max_parts"]
    for corners in found:
        assert len(corners) <= COARSE["max_vertices"]
        assert convex(corners)
        assert np.max(corners @ hull.equations[:, :3].T + hull.equations[:, 3]) <= WITHIN_HULL_M
    volume = statue.mass_kg / statue.density_kg_m3
    excess_rel, missing_rel = misfit(statue, found)
    assert 0.0 < excess_rel < 0.5 * (hull.volume / volume - 1.0)
    assert 0.0 <= missing_rel < PARTS_MISSING_REL
    assert same(found, decompose(statue, **COARSE))  # type: ignore[arg-type]


def test_three_boxes_are_three_parts() -> None:
    body = toadstool.build()
    found = decompose(body)
    assert len(found) == 3
    assert max(misfit(body, found)) <= BOXES_REL
    # A hull fills the space under the cap.
    assert ConvexHull(body.vertices_m).volume * 2500.0 / body.mass_kg - 1.0 > 0.5


def test_a_convex_body_is_one_part() -> None:
    body = solid_from_mesh(*box(0.4, 0.3, 1.0), density_kg_m3=2500.0)
    found = decompose(body)
    assert len(found) == 1
    assert max(misfit(body, found)) <= WITHIN_HULL_M


def test_a_mesh_is_decomposed_once(own_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    body = toadstool.build()
    first = parts_of(body)
    assert len(list(own_folder.iterdir())) == 1
    calls = []
    monkeypatch.setattr(decomposition, "decompose", lambda *given: calls.append(given) or first)
    parts_of.cache_clear()
    assert same(first, parts_of(toadstool.build(1000.0))), "its mass is not its shape"
    assert calls == []
    parts_of(body, 0.2)
    vertices, faces = toadstool.surface()
    parts_of(solid_from_mesh(vertices * [1.0, 1.0, 1.01], faces, density_kg_m3=2500.0))
    assert len(calls) == 2, "another parameter and another mesh are decomposed"


def test_a_damaged_file_is_made_anew(own_folder: Path) -> None:
    body = toadstool.build()
    first = parts_of(body)
    (file,) = own_folder.iterdir()
    whole = file.read_bytes()
    for damage in (b"", whole[: len(whole) // 2], b"\x80\x04N."):
        file.write_bytes(damage)
        parts_of.cache_clear()
        assert same(first, parts_of(body))
        assert file.read_bytes() == whole


def test_where_nothing_can_be_kept_it_is_computed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert len(parts_of(toadstool.build())) == 3


def test_what_cannot_be_decomposed_says_so(statue: Solid, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(MeshError, match="concavity"):
        decompose(statue, concavity=0.0)
    monkeypatch.setattr(decomposition, "missing", lambda: "coacd is not installed")
    with pytest.raises(MeshError, match="coacd is not installed"):
        parts_of(statue)


@pytest.mark.parametrize(
    ("program", "cause"),
    [("os.kill(os.getpid(), signal.SIGSEGV)", "was ended by SIGSEGV"), ("sys.exit(3)", "ended with code 3")],
)
def test_a_search_that_crashes_ends_itself_alone_and_is_not_begun_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str, cause: str
) -> None:
    count = tmp_path / "count"
    script = tmp_path / "crash.py"
    script.write_text(f"import os, signal, sys\nopen({str(count)!r}, 'a').write('.')\n{program}\n")
    monkeypatch.setattr(coacd_alone, "__file__", str(script))
    monkeypatch.setattr(decomposition, "_FAILED", {})
    for _ in range(2):
        with pytest.raises(MeshError, match=cause):
            parts_of(toadstool.build())
    assert count.read_text() == "."


def test_a_process_of_its_own_finds_the_same_parts() -> None:
    """The search in this process, with the very options, and in its own: the same corners to the last bit."""
    import coacd

    body = toadstool.build()
    options = (decomposition.CONCAVITY, decomposition.MAX_PARTS, 0)
    found = decomposition._searched(body.vertices_m, body.faces, options)
    here = coacd.run_coacd(
        coacd.Mesh(body.vertices_m, body.faces.astype(np.int32)), threshold=options[0], max_convex_hull=options[1],
        preprocess_mode="off", resolution=500, mcts_iterations=50, mcts_nodes=10, mcts_max_depth=2, seed=0,
    )  # fmt: skip
    assert len(found) == len(here)
    assert all(np.array_equal(a, b) for a, (b, _) in zip(found, here, strict=True))


@pytest.mark.parametrize("kind", ["linked", "open"])
def test_parts_that_others_could_have_put_there_are_not_taken(own_folder: Path, kind: str) -> None:
    body = toadstool.build()
    first = parts_of(body)
    (file,) = own_folder.iterdir()
    others = json.dumps([np.zeros((4, 3)).tolist()])
    file.write_text(f"{hashlib.sha256(others.encode()).hexdigest()}\n{others}")
    if kind == "open":
        own_folder.chmod(0o777)
    else:
        own_folder.rename(own_folder.with_name("elsewhere"))
        own_folder.symlink_to(own_folder.with_name("elsewhere"))
    parts_of.cache_clear()
    assert same(first, parts_of(body))


def test_a_hull_within_a_budget_nears_the_full_one_from_inside(statue: Solid) -> None:
    full = ConvexHull(statue.vertices_m)
    (small, wide_m), (large, narrow_m) = thinned(statue.vertices_m, 64), thinned(statue.vertices_m, 128)
    for corners, budget in ((small, 64), (large, 128)):
        assert len(corners) == budget
        rows = {tuple(vertex) for vertex in corners}
        assert all(tuple(statue.vertices_m[each]) in rows for each in statue.vertices_m.argmin(axis=0))
    assert ConvexHull(small).volume < ConvexHull(large).volume < full.volume
    assert narrow_m < HULL_GAP_M
    assert narrow_m < wide_m


def test_points_within_the_budget_are_all_corners_of_their_hull() -> None:
    cube = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    corners, gap_m = thinned(np.vstack([cube, cube.mean(axis=0)]), 8)
    assert gap_m == 0.0
    assert np.array_equal(corners, cube)
