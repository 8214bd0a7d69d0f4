"""A scene's mistakes are all found at once, each with its place, what was wanted and what came."""

from pathlib import Path

import pytest

from harness.input import tables
from harness.model import InputError, Mistake
from harness.questions.study.cases import StudyFile

GOOD = """
title = "a block"
duration_s = 1.0
[statue]
mass_kg = 100.0
centroid_height_m = 0.5
corner_left_m = 0.1
corner_right_m = 0.1
inertia_kg_m2 = 8.7
"""


def mistakes(text: str, *overrides: str) -> dict[str, Mistake]:
    with pytest.raises(InputError, match="wanted") as caught:
        tables.parse(text, "s.toml", overrides)
    return {mistake.key: mistake for mistake in caught.value.mistakes}


def test_the_least_scene_is_accepted() -> None:
    model, content = tables.parse(GOOD, "s.toml")
    assert model.statue.mass_kg == 100.0
    assert model.contact.restitution == "momentum"
    assert content["statue"]["centroid_height_m"] == 0.5


def test_all_mistakes_are_listed_at_once_with_their_lines() -> None:
    text = GOOD.replace("duration_s = 1.0", 'duration_s = "3"').replace("mass_kg = 100.0", "mass_kg = -3.0")
    text += "[wall]\nside = 'up'\n"
    found = mistakes(text)
    assert set(found) == {"duration_s", "statue.mass_kg", "wall.side", "wall.distance_m"}
    assert (found["duration_s"].where, found["duration_s"].got) == ("s.toml:3", "'3'")
    assert "1e-09" in found["statue.mass_kg"].wanted
    assert found["wall.side"].got == "'up'"
    assert found["wall.distance_m"].got == "nothing"


def test_an_unknown_key_names_the_nearest_known_one() -> None:
    found = mistakes(GOOD.replace("mass_kg", "mas_kg"))
    assert " mass_kg?" in found["statue.mas_kg"].advice
    assert found["statue.mass_kg"].got == "nothing"


@pytest.mark.parametrize(
    ("line", "key"),
    [
        ("gravity_m_s2 = nan", "gravity_m_s2"),
        ("gravity_m_s2 = true", "gravity_m_s2"),
        ("gravity_m_s2 = 0", "gravity_m_s2"),
        ("title = 3", "title"),
        ("table = 'rolling'", "table"),
    ],
)
def test_types_are_strict(line: str, key: str) -> None:
    text = GOOD if key not in ("title",) else GOOD.replace('title = "a block"', "")
    assert key in mistakes(line + "\n" + text)


def test_keys_that_contradict_each_other_are_named() -> None:
    found = mistakes(GOOD + "[contact]\nfloor_static = 0.1\nfloor_kinetic = 0.3\n")
    assert found["contact.floor_kinetic"].wanted == "at most floor_static = 0.1"
    for acts in ("0.05", "0.21", "'moving'", "true"):
        floor = f"[contact]\nfloor_static = 0.2\nfloor_kinetic = 0.1\nfloor_impact = {acts}\n"
        assert "contact.floor_impact" in mistakes(GOOD + floor)
    found = mistakes(GOOD + "[model]\npreset = 'paper'\n")
    assert "number" in found["contact.restitution"].wanted


def test_an_unknown_kind_of_motion_lists_the_known_ones() -> None:
    found = mistakes(GOOD + "[motion.x]\nkind = 'harmonik'\n")
    assert "'harmonic'" in found["motion.x"].wanted
    assert found["motion.x"].got == "kind = 'harmonik'"


def test_broken_toml_says_where() -> None:
    assert "line 1" in mistakes("title = = 3")[""].got


def test_overrides_set_add_and_remove_keys() -> None:
    model, _ = tables.parse(
        GOOD + "[wall]\nside = 'left'\ndistance_m = 1\n",
        "s.toml",
        ["duration_s=2", "wall=none", "contact.statue = 0.4"],
    )
    assert (model.duration_s, model.wall, model.contact.statue) == (2.0, None, 0.4)


@pytest.mark.parametrize("item", ["duration_s", "=3", "title.x=3"])
def test_an_override_that_makes_no_sense_is_a_mistake(item: str) -> None:
    found = mistakes(GOOD, item)
    assert all(mistake.where == "--set" for mistake in found.values())


def test_a_mistake_that_an_override_made_is_not_blamed_on_the_file() -> None:
    found = mistakes(GOOD, "duration_s=-1", "contact.statue=0")
    assert [found[key].where for key in ("duration_s", "contact.statue")] == ["--set", "--set"]
    assert (
        mistakes(GOOD.replace("mass_kg = 100.0", "mass_kg = -1.0"), "duration_s=-1")["statue.mass_kg"].where
        == "s.toml:5"
    )


def test_a_file_without_end_is_refused(tmp_path: Path) -> None:
    long = tmp_path / "long.toml"
    long.write_bytes(b"#" * (tables.MAX_BYTES + 1))
    with pytest.raises(InputError, match=r"long\.toml: .* 1e\+07 "):
        tables.read(long)
    long.write_bytes(b"#" * tables.MAX_BYTES)
    assert len(tables.read(long)) == tables.MAX_BYTES


def test_a_statue_by_numbers_wants_all_of_them() -> None:
    found = mistakes(GOOD.replace("inertia_kg_m2 = 8.7", ""))
    assert "statue.mesh" in found["statue.inertia_kg_m2"].wanted


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ('title = "s"\nscene = "a.toml"\n[[variant]]\nname = "v"\nengines = ["analytic"]\n', "rockcheck study s.toml"),
        ('[[option]]\nname = "o"\nset = { "statue.mass_kg" = 1.0 }\n', "rockcheck assess SCENE --options s.toml"),
    ],
)
def test_a_file_of_another_kind_is_one_mistake_with_the_command_that_takes_it(text: str, command: str) -> None:
    found = mistakes(text)
    assert list(found) == [""]
    assert command in found[""].advice


def test_a_study_that_is_a_scene_is_told_so(tmp_path: Path) -> None:
    path = tmp_path / "s.toml"
    path.write_text(GOOD)
    with pytest.raises(InputError, match="rockcheck run") as caught:
        tables.read_model(StudyFile, path)
    assert len(caught.value.mistakes) == 1


def test_a_scan_and_another_encoding_are_told(tmp_path: Path) -> None:
    (tmp_path / "latin.toml").write_bytes('title = "\xe8"'.encode("latin-1"))
    (tmp_path / "bust.OBJ").write_bytes(b"v 0 0 0")
    for name, wanted in (("latin.toml", "a text in UTF-8"), ("bust.OBJ", "a TOML file")):
        with pytest.raises(InputError) as caught:
            tables.read(tmp_path / name)
        assert [mistake.wanted for mistake in caught.value.mistakes] == [wanted]
