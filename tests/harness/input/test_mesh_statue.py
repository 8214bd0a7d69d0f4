"""A scene's mesh made into a statue: hollow, cored, set against a survey, adjusted; every mistake one clear sentence."""

from pathlib import Path

import numpy as np
import pytest

import harness
from harness import InputError, load_scene
from harness.input import mesh_statue
from harness.model import Severity
from meshes.mesh import Doubt, RawMesh
from tests.budgets_meshes import ROUND_OFF_REL
from tests.meshes.scanner import write
from tests.meshes.shapes import box

SCENE = """
title = "a block with a hollow"
duration_s = 1.0
[statue.mesh]
file = "outer.ply"
density_kg_m3 = 2000.0
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An outer block of 0.4 × 0.7 × 1.5 m and, inside and off its middle, one of 0.1 × 0.3 × 1.0 m; far from the origin."""
    outer, faces = box(0.4, 0.7, 1.5)
    inner = box(0.1, 0.3, 1.0)[0] + np.array([0.15, 0.2, 0.2])
    away = np.array([3.0, -2.0, 5.0])
    write(RawMesh(outer + away, faces, "outer"), tmp_path / "outer.ply")
    write(RawMesh(inner + away, faces, "inner"), tmp_path / "inner.ply")
    write(RawMesh(inner + away + [0.2, 0.0, 0.0], faces, "beside"), tmp_path / "beside.ply")
    (tmp_path / "scene.toml").write_text(SCENE)
    return tmp_path / "scene.toml"


def test_a_hollow_statue_is_lighter_and_says_so(folder: Path) -> None:
    whole, hollow = load_scene(folder), load_scene(folder, ['statue.mesh.inner.file="inner.ply"'])
    assert whole.statue.mass_kg == pytest.approx(2000.0 * 0.42, rel=1e-6)
    assert hollow.statue.mass_kg == pytest.approx(2000.0 * 0.39, rel=1e-6)
    assert hollow.statue.centroid_height_m == pytest.approx((0.42 * 0.75 - 0.03 * 0.7) / 0.39, rel=1e-6)
    (told,) = [each.values for each in hollow.findings if each.code == "mesh_hollow"]
    assert (told["inside_kg_m3"], told["mass_kg"], told["weighed_kg"]) == (0.0, pytest.approx(780.0), None)


def test_a_core_and_a_weighed_mass_give_the_density_around_it(folder: Path) -> None:
    given = ['statue.mesh.inner.file="inner.ply"', "statue.mesh.inner.density_kg_m3=7850.0"]
    cored = load_scene(folder, [*given, "statue.mass_kg=1100.0", "statue.mesh.density_kg_m3=none"])
    assert cored.statue.mass_kg == pytest.approx(1100.0, rel=ROUND_OFF_REL)
    around = (1100.0 - 7850.0 * 0.03) / 0.39
    height = (around * 0.42 * 0.75 + (7850.0 - around) * 0.03 * 0.7) / 1100.0
    assert cored.statue.centroid_height_m == pytest.approx(height, rel=1e-6)
    assert [each.values["weighed_kg"] for each in cored.findings if each.code == "mesh_hollow"] == [1100.0]
    with pytest.raises(InputError, match=r"statue\.mesh: .* 235\.5 kg, got 200 kg"):
        load_scene(folder, [*given, "statue.mass_kg=200.0", "statue.mesh.density_kg_m3=none"])


def test_a_turned_hollow_statue_is_the_hollow_statue_turned(folder: Path) -> None:
    given = ['statue.mesh.inner.file="inner.ply"']
    straight, turned = load_scene(folder, given), load_scene(folder, [*given, "statue.mesh.azimuth_deg=90.0"])
    assert turned.statue.corner_right_m + turned.statue.corner_left_m == pytest.approx(0.7, rel=1e-6)
    assert turned.statue.inertia_kg_m2 == pytest.approx(straight.statue.inertia_tensor_kg_m2[0, 0], rel=1e-9)


def test_a_shell_outside_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match=r"statue\.mesh: .* 50 %"):
        load_scene(folder, ['statue.mesh.inner.file="beside.ply"'])
    with pytest.raises(InputError, match=r"statue.mesh.inner.file"):
        load_scene(folder, ['statue.mesh.inner.file="absent.ply"'])


def test_the_survey_is_used_where_asked(folder: Path) -> None:
    given = ["statue.centroid_height_m=0.8", "statue.inertia_kg_m2=180.0"]
    mesh, survey = (
        load_scene(folder, given),
        load_scene(folder, [*given, 'statue.mesh.use_survey=["centroid_height_m"]']),
    )
    both = load_scene(folder, [*given, 'statue.mesh.use_survey=["centroid_height_m", "inertia_kg_m2"]'])
    assert mesh.statue.centroid_height_m == pytest.approx(0.75, rel=1e-6)
    assert survey.statue.centroid_height_m == 0.8
    assert survey.statue.inertia_kg_m2 == pytest.approx(mesh.statue.inertia_kg_m2, rel=ROUND_OFF_REL)
    assert both.statue.inertia_kg_m2 == pytest.approx(180.0, rel=ROUND_OFF_REL)
    told = {each.values["key"]: each for each in survey.findings if each.code == "mesh_differs"}
    height, inertia = told["statue.centroid_height_m"], told["statue.inertia_kg_m2"]
    assert (height.values["survey"], height.values["mesh"]) == (0.8, pytest.approx(0.75, rel=1e-6))
    assert (height.values["used"], inertia.values["used"]) == ("survey", "mesh")
    assert height.severity is Severity.CAUTION
    with pytest.raises(InputError, match=r"statue\.mesh\.use_survey: .*centroid_height_m"):
        load_scene(folder, ['statue.mesh.use_survey=["centroid_height_m"]'])


def test_adjusted_by_shares_and_said(folder: Path) -> None:
    plain = load_scene(folder).statue
    scene = load_scene(folder, ["statue.mesh.adjust.centroid_rel=0.03", "statue.mesh.adjust.base_rel=-0.02"])
    assert scene.statue.centroid_height_m == pytest.approx(1.03 * plain.centroid_height_m, rel=ROUND_OFF_REL)
    assert scene.statue.corner_right_m == pytest.approx(0.98 * plain.corner_right_m, rel=ROUND_OFF_REL)
    assert [each.values for each in scene.findings] == [
        {"changes": {"centroid": 0.03, "base": -0.02}},
        {"keys": ["contact.floor_static", "contact.floor_kinetic"]},
    ]
    with pytest.raises(InputError, match=r"adjust.centroid_rel.*wanted a number"):
        load_scene(folder, ["statue.mesh.adjust.centroid_rel=0.9"])


def test_the_contact_tolerance_is_the_scene_s(folder: Path) -> None:
    assert load_scene(folder, ["statue.mesh.contact_tolerance_m=0.005"]).statue.solid is not None
    with pytest.raises(InputError, match="contact_tolerance_m"):
        load_scene(folder, ["statue.mesh.contact_tolerance_m=0.0"])


def test_a_second_body_in_the_file_is_refused_by_a_run_too(folder: Path) -> None:
    vertices, faces = box(0.4, 0.7, 1.5)
    both = RawMesh(np.vstack([vertices, vertices + np.array([3.0, 0.0, 0.0])]), np.vstack([faces, faces + 8]), "pair")
    write(both, folder.with_name("outer.ply"))
    with pytest.raises(InputError) as caught:
        load_scene(folder)
    (mistake,) = caught.value.mistakes
    assert (mistake.key, mistake.wanted) == ("statue.mesh", "one body")
    assert mistake.got.startswith("2 of 0.42 m³, 0.42 m³")
    assert str(mistake).count("wanted") == 1


def test_a_shell_facing_inward_in_the_file_is_a_hollow(folder: Path) -> None:
    outer, faces = box(0.4, 0.7, 1.5)
    inner = box(0.1, 0.3, 1.0)[0] + np.array([0.15, 0.2, 0.2])
    write(
        RawMesh(np.vstack([outer, inner]), np.vstack([faces, faces[:, ::-1] + 8]), "both"),
        folder.with_name("outer.ply"),
    )
    assert load_scene(folder).statue.mass_kg == pytest.approx(2000.0 * 0.39, rel=1e-6)


def test_the_checks_of_a_scan_are_made_once_for_its_content(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder.parent / "cache"))
    asked: list[int] = []

    def counted(vertices: np.ndarray, faces: np.ndarray, how: str) -> tuple[Doubt, ...]:
        asked.append(len(faces))
        return (Doubt("scan_pinched", {"share": len(asked)}),)

    def looked() -> list[int]:
        mesh_statue._doubts.cache_clear()  # another process
        return [each.values["share"] for each in load_scene(folder).findings if each.code == "scan_pinched"]

    monkeypatch.setattr(mesh_statue, "doubts", counted)
    assert looked() == looked() == [1]
    (kept,) = (folder.parent / "cache" / "rockcheck" / "meshes").glob("doubts-*.txt")
    for damage in (b"", b"[]", b'word\n["looked at, said another"]', b"\xff"):
        before = len(asked)
        kept.write_bytes(damage)
        assert looked() == looked() == [before + 1]
    before = len(asked)
    outer = folder.parent / "outer.ply"
    write(RawMesh(box(0.4, 0.7, 1.6)[0], box(0.4, 0.7, 1.6)[1], "outer"), outer)
    assert looked() == [before + 1]
    kept.parent.chmod(0o777)  # where others may write nothing is taken
    assert looked() == [before + 2]
    mesh_statue._doubts.cache_clear()


def test_a_base_that_reaches_over_the_centroid_is_refused(tmp_path: Path) -> None:
    """A dish lower than the tolerance of contact touches with its rim, as a scene may say."""
    vertices, faces = box(0.2, 0.2, 0.095)
    vertices[vertices[:, 2] > 0.0, :2] *= 2.0
    write(RawMesh(vertices, faces, ""), tmp_path / "dish.ply")
    scene = {
        "title": "dish", "duration_s": 1.0, "motion": {"x": {"kind": "rest"}}, "contact": {"statue": 0.6},
        "statue": {"mesh": {
            "file": str(tmp_path / "dish.ply"), "unit": "m", "up": "z", "density_kg_m3": 2700.0, "contact_tolerance_m": 0.1,
        }},
    }  # fmt: skip
    with pytest.raises(InputError, match="statue"):
        harness.scene(scene)
