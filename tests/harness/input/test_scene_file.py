"""From a scene file to plain numbers: what is assumed is said, what is compared is named."""

import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from harness import InputError, Scene, load_scene
from harness.input.tables import NUMBERS
from tests import doubles
from tests.fuzz.originals import SCENE, prepare
from tests.harness.input.test_tables import GOOD
from tests.scenes_for_tests import SCENES


def written(folder: Path, text: str) -> Path:
    path = folder / "scene.toml"
    path.write_text(text)
    return path


def test_what_is_assumed_is_said(tmp_path: Path) -> None:
    scene = load_scene(written(tmp_path, GOOD))
    assert scene.statue.height_m == 1.0
    assumed = {each.values["key"]: each.values["value"] for each in scene.findings if each.code == "key_assumed"}
    assert assumed == {"statue.height_m": 1.0, "statue.depth_m": scene.statue.depth_m}
    assert "key_not_used" in doubles.codes(scene.findings)
    chosen = load_scene(scene.source, ["contact.floor_impact='static'", "model.friction_normal='static'"])
    (unused,) = (each.values["keys"] for each in chosen.findings if each.code == "key_not_used")
    assert unused[2:] == ["contact.floor_impact", "model.friction_normal"]
    paper = load_scene(scene.source, ["model.preset='paper'", "contact.restitution=0.9"])
    (unused,) = (each.values["keys"] for each in paper.findings if each.code == "key_not_used")
    assert unused[2:] == ["model.preset"]


def test_a_doubt_of_what_is_not_there_is_a_caution(tmp_path: Path) -> None:
    drawn = '[uncertainty]\n"contact.floor" = { kind = "lognormal", cov = 0.15 }\n'
    found = load_scene(written(tmp_path, GOOD + drawn)).findings
    assert [each.values["keys"] for each in found if each.code == "key_not_used" and each.severity == "caution"] == [
        ["uncertainty.contact.floor"]
    ]


def test_an_amplitude_in_g_is_a_share_of_the_scenes_gravity(tmp_path: Path) -> None:
    motion = "[motion.x]\nkind = 'harmonic'\namplitude_g = 0.25\nfrequency_hz = 1.0\n"
    scene = load_scene(written(tmp_path, GOOD + motion))
    assert scene.base_excitation.x.peak_m_s2 == 0.25 * 9.81
    weak = load_scene(written(tmp_path, GOOD + motion), ["gravity_m_s2=4.0"])
    assert weak.base_excitation.x.peak_m_s2 == 1.0


def test_the_papers_preset_is_its_two_choices(tmp_path: Path) -> None:
    scene = load_scene(
        written(tmp_path, GOOD + "[model]\npreset = 'paper'\n[contact]\nrestitution = 0.85\n"),
        ["model.friction_normal='dynamic'"],
    )
    assert (scene.form.friction_normal, scene.form.pedestal_at_impact) == ("dynamic", "unchanged")
    assert scene.contact.restitution == 0.85


def test_an_inertia_that_no_body_of_that_size_has_is_refused(tmp_path: Path) -> None:
    scene = tmp_path / "s.toml"
    scene.write_text(GOOD, encoding="utf-8")
    with pytest.raises(InputError, match=r"statue\.inertia_kg_m2: .* 400 .* got 400\.1$"):
        load_scene(scene, ["statue.inertia_kg_m2=400.1"])  # m (2 H)² with H = 1 m, twice the centroid's height
    assert load_scene(scene, ["statue.inertia_kg_m2=399.9"]).statue.inertia_kg_m2 == 399.9


def test_a_pedestal_must_carry_the_whole_base(tmp_path: Path) -> None:
    pedestal = "[pedestal]\nmass_kg = 1.0\nwidth_m = 0.1\ndepth_m = 1.0\nheight_m = 0.1\n"
    with pytest.raises(InputError, match=r": pedestal\.width_m: "):
        load_scene(written(tmp_path, GOOD + pedestal))
    with pytest.raises(InputError, match=r": pedestal\.width_m: "):
        load_scene(written(tmp_path, GOOD + pedestal), ["pedestal.width_m=0.3", "pedestal.offset_m=0.2"])


def told(scene: Scene) -> set[tuple[str, str]]:
    return {(each.code, each.values["key"]) for each in scene.findings if "key" in each.values}


def test_a_mesh_is_compared_with_the_survey(root: Path) -> None:
    scene = load_scene(root / "scenes" / "paestum_floor.toml", ["statue.centroid_height_m=0.80"])
    assert ("mesh_differs", "statue.centroid_height_m") in told(scene)
    assert ("mesh_agrees", "statue.corner_left_m") in told(scene)
    assert scene.statue.solid is not None


def test_a_weighed_mass_gives_the_density(root: Path) -> None:
    scene = load_scene(root / "scenes" / "paestum_floor.toml", ["statue.mass_kg=750.0"])
    assert scene.statue.mass_kg == pytest.approx(750.0, rel=1e-12)  # the density is solved from it: one division
    assert ("mesh_differs", "statue.mesh.density_kg_m3") in told(scene)


def test_a_density_or_friction_that_no_material_has_is_doubted(root: Path) -> None:
    scan = ["statue.mass_kg=none", "statue.mesh.density_kg_m3=2.7"]
    for overrides, key in (
        (scan, "statue"),
        (["statue.mass_kg=0.7"], "statue"),
        (["pedestal.width_m=60.0"], "pedestal"),
    ):
        scene = load_scene(root / "scenes" / "paestum_pedestal.toml", overrides)
        assert {name for code, name in told(scene) if code == "odd_density"} == {key}
    (light,) = (each.values for each in scene.findings if each.code == "odd_density")
    assert light["density_kg_m3"] == pytest.approx(250.0 / (60.0 * 0.8 * 0.2), rel=1e-12)
    percent = load_scene(
        root / "scenes" / "paestum_pedestal.toml", ["contact.floor_static=20.0", "contact.statue=60.0"]
    )
    assert {name for code, name in told(percent) if code == "odd_friction"} == {
        "contact.floor_static",
        "contact.statue",
    }
    plain = doubles.codes(load_scene(root / "scenes" / "paestum_pedestal.toml").findings)
    assert not {"odd_density", "odd_friction"} & set(plain)


@pytest.mark.parametrize(
    ("override", "key"),
    [
        ("statue.mesh.file='none.ply'", "statue.mesh.file"),
        ("statue.mesh.density_kg_m3=none", "statue.mesh.density_kg_m3"),
        ("motion.x={kind='record', file='none.csv', column='a'}", "motion.x"),
    ],
)
def test_what_is_missing_is_named(root: Path, override: str, key: str) -> None:
    with pytest.raises(InputError) as caught:
        load_scene(root / "scenes" / "paestum_floor.toml", [override])
    assert any(mistake.key.startswith(key) for mistake in caught.value.mistakes), str(caught.value)


def test_every_scene_and_study_in_the_gallery_is_read(root: Path, data_dir: Path) -> None:
    from harness.input.tables import kind_of, read_model
    from harness.questions.effects3d import KIND, EffectsFile
    from harness.questions.study import rocking_spectrum
    from harness.questions.study.cases import base_of, expand, load_study

    for path in sorted((root / "scenes").glob("*.toml")):
        if kind_of(path) == rocking_spectrum.KIND:
            spectrum = read_model(rocking_spectrum.SpectrumFile, path)
            assert len(rocking_spectrum.motions_of(spectrum, path)) == len(spectrum.motion)
            continue
        if kind_of(path) == KIND:
            asked = read_model(EffectsFile, path)
            assert load_scene(path.parent / asked.scene).statue.solid is not None
        elif "\nscene = " in path.read_text():
            study = load_study(path)
            assert next(iter(expand(study, base_of(study, path)))).number == 0
        else:
            assert load_scene(path).statue.mass_kg > 0.0


UNKNOWN_KEYS = (
    ("title =", "Title =", "Title", "did you mean title?"),
    ("[wall]", "[record]", "record", ""),
    ("mass_kg = 707", "Mass_kg = 707", "statue.Mass_kg", "did you mean mass_kg?"),
    ("amplitude_g", "list_g", "motion.z.list_g", ""),
)
"""Keys that look like what the validator adds of its own: names of types, tags of unions."""


@pytest.mark.parametrize(("old", "new", "key", "near"), UNKNOWN_KEYS)
def test_an_unknown_key_is_named_whatever_it_looks_like(
    tmp_path: Path, old: str, new: str, key: str, near: str
) -> None:
    prepare(tmp_path)
    path = tmp_path / "scene.toml"
    path.write_text(SCENE.decode().replace(old, new), encoding="utf-8")
    with pytest.raises(InputError) as found:
        load_scene(path)
    told = [item for item in found.value.mistakes if item.got == "an unknown key"]
    assert [(item.key, item.advice) for item in told] == [(key, near)]


@pytest.mark.parametrize(
    ("motion", "key", "wanted"),
    [
        ("{kind='record'}", "motion.x.file", "this key"),
        ("{kind='record', file='a.csv', scale=nan}", "motion.x.scale", "a finite number"),
        ("{kind='record', file='a.csv', records=1}", "motion.x.records", "a known key"),
        ("{kind='samples', dt_s=0.1, accel_m_s2=[0.0, nan]}", "motion.x.accel_m_s2.1", "a finite number"),
        ("{kind='samples', dt_s=0.1, accel_m_s2=[0.0]}", "motion.x.accel_m_s2", "at least 2 of them"),
    ],
)
def test_a_wrong_key_of_a_motion_is_the_users_own_and_told_once(root: Path, motion: str, key: str, wanted: str) -> None:
    """The tag `record` is a key of a motion by its spectrum; a list of two is not too short for one that is no number."""
    with pytest.raises(InputError) as caught:
        load_scene(root / "scenes" / "free_rocking.toml", [f"motion.x={motion}"])
    (mistake,) = caught.value.mistakes
    assert mistake.key == key
    assert mistake.wanted.startswith(wanted)


POSED = "[initial]\nposition_m = [0.0, 0.0, 0.6]\n"


def test_a_pose_in_space_is_read_and_its_quaternion_made_exact(tmp_path: Path) -> None:
    turn = "quaternion_wxyz = [0.70711, 0.0, 0.70711, 0.0]\nangular_velocity_rad_s = [1.0, 2.0, 3.0]\n"
    pose = load_scene(written(tmp_path, GOOD + POSED + turn)).initial.pose
    assert pose.position_m == (0.0, 0.0, 0.6)
    assert sum(part * part for part in pose.quaternion_wxyz) == pytest.approx(1.0, rel=1e-15)
    assert pose.rotation[:, 2] == pytest.approx([1.0, 0.0, 0.0], abs=1e-15)
    assert pose.velocity_m_s == (0.0, 0.0, 0.0)
    assert pose.angular_velocity_rad_s == (1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (POSED + "theta_rad = 0.1\n", r"initial\.theta_rad: .*position_m"),
        ("[initial]\nvelocity_m_s = [0, 0, 1.0]\n", r"initial\.position_m: .*velocity_m_s"),
        (POSED + "quaternion_wxyz = [1.0, 0.1, 0.0, 0.0]\n", r"initial\.quaternion_wxyz: .* 1\.00499"),
        (POSED + "quaternion_wxyz = [1.0, 0.0, 0.0]\n", r"initial\.quaternion_wxyz"),
        ("[initial]\nposition_m = [0.0, 0.0, 0.4]\n", r"initial\.position_m: .* -0\.1 m"),
        (POSED + "[wall]\nside = 'left'\ndistance_m = 1.0\n", r"initial\.position_m: .*\[wall\]"),
        (
            POSED + "[pedestal]\nmass_kg = 1.0\nwidth_m = 1.0\ndepth_m = 1.0\nheight_m = 0.1\n",
            r"initial\.position_m: ",
        ),
    ],
)  # fmt: skip
def test_a_pose_that_contradicts_itself_or_the_scene_is_refused(tmp_path: Path, lines: str, message: str) -> None:
    statue, _, _ = GOOD.partition("[initial]")
    with pytest.raises(InputError, match=message):
        load_scene(written(tmp_path, statue.rstrip() + "\nheight_m = 1.0\n" + lines))


def test_a_block_may_have_all_its_moments_of_inertia(tmp_path: Path) -> None:
    moments = "inertia_xyz_kg_m2 = [9.0, 8.7, 1.5]\n"
    tensor = load_scene(written(tmp_path, GOOD + moments)).statue.inertia_tensor_kg_m2
    assert tensor.tolist() == [[9.0, 0.0, 0.0], [0.0, 8.7, 0.0], [0.0, 0.0, 1.5]]


@pytest.mark.parametrize(
    ("moments", "message"),
    [
        ("[9.0, 8.0, 1.5]", r"statue\.inertia_xyz_kg_m2: .* 8\.7 .* got 8"),
        ("[20.0, 8.7, 1.5]", r"statue\.inertia_xyz_kg_m2: "),
        ("[9.0, 8.7]", r"statue\.inertia_xyz_kg_m2"),
    ],
)
def test_moments_of_inertia_that_no_body_has_are_refused(tmp_path: Path, moments: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load_scene(written(tmp_path, GOOD + f"inertia_xyz_kg_m2 = {moments}\n"))


@pytest.mark.parametrize(
    ("overrides", "key", "got"),
    [
        ({"wall.distance_m": 0.1}, "wall.distance_m", "0.1"),
        ({"wall.distance_m": 0.14, "pedestal.offset_m": 0.05}, "wall.distance_m", "0.14"),
        ({"pedestal": None, "wall.distance_m": 0.3, "initial.theta_rad": 0.35}, "initial.theta_rad", "0.35"),
        ({"wall.side": "left", "initial.theta_rad": -0.3}, "initial.theta_rad", "-0.3"),
    ],
)
def test_a_wall_that_is_reached_at_the_start_is_refused(
    tmp_path: Path, overrides: dict[str, Any], key: str, got: str
) -> None:
    # A base from −0.1 to 0.1 m, 1 m high, on a pedestal of 0.4 m: its side is 0.1 m beside the base.
    block = "mass_kg = 50.0\ncentroid_height_m = 0.5\ncorner_left_m = 0.1\ncorner_right_m = 0.1\ninertia_kg_m2 = 4.0\n"
    under = "[pedestal]\nmass_kg = 50.0\nwidth_m = 0.4\ndepth_m = 0.4\nheight_m = 0.1\n"
    text = f'title = "a wall"\nduration_s = 1.0\n[statue]\n{block}height_m = 1.0\n{under}[wall]\nside = "right"\n'
    path = written(tmp_path, text + "distance_m = 0.2\n")
    assert load_scene(path).wall is not None
    with pytest.raises(InputError) as refused:
        load_scene(path, overrides)
    assert [(item.key, item.got) for item in refused.value.mistakes] == [(key, got)]


def test_a_motion_by_formula_loads_no_reader_of_records() -> None:
    path = Path(__file__).parents[3] / "scenes" / "free_rocking.toml"
    code = f"import sys, harness; harness.load_scene({str(path)!r}); print([n for n in sys.modules if '.readers' in n])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("key", NUMBERS)
def test_a_case_or_an_option_that_takes_a_number_of_a_block_away_is_refused(key: str) -> None:
    """What a file is refused for, one by one, as of a study's case and an option all keys are read at once."""
    from harness.questions.assess.probability import reread
    from harness.questions.study.cases import BaseScene

    path = SCENES / "free_rocking.toml"
    away = {f"statue.{key}": "none"}
    with pytest.raises(InputError, match="not all of them"):
        BaseScene(path, tomllib.loads(path.read_text(encoding="utf-8"))).scene(away)
    with pytest.raises(InputError, match="not all of them"):
        reread(load_scene(path), away, "option")
