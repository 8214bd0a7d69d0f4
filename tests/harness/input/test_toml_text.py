"""TOML that would take a machine's memory, or holds what TOML does not, is refused before it is used."""

import tomllib
from pathlib import Path

import pytest

from harness.input.tables import MOST_KEYS, MOST_PARTS, content_of, override, read
from harness.model import LONGEST, InputError, Mistake

HUGE = "9" * 5000


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (f"a = {HUGE}", ""),
        (f"a = [1, {{ b = 0x{'f' * 5000} }}]", "a.b"),
        ("[t]\na = 9223372036854775808", "t.a"),
        ("a = -9223372036854775809", "a"),
        ("x = 1\n" + "a." * 50_000 + "a = 1", "line 2"),
        ("[" + ' . "a b"' * (MOST_PARTS + 1) + "]", "line 1"),
        ("".join(f"k{i}.a = 1\n" for i in range(MOST_KEYS + 1)), ""),
        ("a = " + "[" * 100_000, ""),
        ("a = " + "{a=" * 9000, ""),
    ],
)
def test_what_is_no_toml_to_be_read_is_refused_with_its_place(text: str, key: str) -> None:
    with pytest.raises(InputError) as refused:
        content_of(text, "scene.toml")
    assert [(each.where, each.key) for each in refused.value.mistakes] == [("scene.toml", key)]


def test_whole_numbers_of_64_bits_and_texts_with_points_are_read() -> None:
    text = f'a = [{-(2**63)}, {2**63 - 1}]\nb = "{"x" * 100_000}"\nc.{".".join("d" * (MOST_PARTS - 2))} = 1'
    assert content_of(text, "")["a"] == [-(2**63), 2**63 - 1]
    with pytest.raises(tomllib.TOMLDecodeError):
        content_of("a =", "")


@pytest.mark.parametrize("value", [HUGE, f"0x{'f' * 5000}", "[" * 100_000, "{" + "a." * 100_000 + "a = 1}"])
def test_a_key_of_the_command_line_is_held_to_the_same(value: str) -> None:
    with pytest.raises(InputError) as refused:
        override({}, [f"statue.mass_kg={value}"])
    assert {(each.where, each.key) for each in refused.value.mistakes} == {("--set", "statue.mass_kg")}


def test_what_came_is_shown_in_part_where_it_is_long() -> None:
    said = str(Mistake("file", "key", "a word", "x" * 100_000))
    assert len(said) < LONGEST + 100
    assert said.endswith("(100000 characters)")


def test_a_mark_before_a_scene_is_no_mistake(tmp_path: Path) -> None:
    path = tmp_path / "marked.toml"
    path.write_text('title = "x"\n', encoding="utf-8-sig")
    assert read(path) == 'title = "x"\n'
