"""What pages carry is made once for each installed version, and only taken from a folder that nobody else can write."""

import os
from pathlib import Path

import pytest
import vl_convert

from reports.pages import page as module
from reports.pages.page import made_once


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "rockcheck" / "pages"


class Maker:
    """Says how often it was asked."""

    def __init__(self) -> None:
        self.asked = 0

    def __call__(self) -> str:
        self.asked += 1
        return f"text α {self.asked}"


def test_one_state_is_made_once_and_another_again(cache: Path) -> None:
    make = Maker()
    assert [made_once("a", b"1", make) for _ in range(3)] == ["text α 1"] * 3
    assert made_once("a", b"2", make) == "text α 2"
    assert made_once("b", b"1", make) == "text α 3"
    assert cache.stat().st_mode & 0o777 == 0o700
    assert all(file.stat().st_mode & 0o777 == 0o600 for file in cache.iterdir())


def test_only_the_newest_states_are_kept(cache: Path) -> None:
    for state in range(5):
        made_once("a", bytes([state]), Maker())
    assert len(list(cache.iterdir())) == module.MOST_TEXTS


@pytest.mark.parametrize("damage", [b"", b"short", b"word\nother", b"\xff\xfe"])
def test_a_damaged_file_is_made_again(cache: Path, damage: bytes) -> None:
    make = Maker()
    made_once("a", b"1", make)
    (file,) = cache.iterdir()
    file.write_bytes(damage)
    assert made_once("a", b"1", make) == "text α 2"
    assert made_once("a", b"1", make) == "text α 2"


def test_a_folder_open_to_others_is_not_used(cache: Path) -> None:
    make = Maker()
    made_once("a", b"1", make)
    cache.chmod(0o777)
    assert made_once("a", b"1", make) == "text α 2"


def test_a_link_is_not_followed(cache: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir(mode=0o700)
    cache.parent.mkdir(mode=0o700)
    os.symlink(elsewhere, cache)
    assert made_once("a", b"1", Maker()) == "text α 1"
    assert not list(elsewhere.iterdir())


def test_the_chart_library_is_bundled_once(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def bundle(snippet: str) -> str:
        asked.append(snippet)
        return f"/* bundle {len(asked)} */"

    monkeypatch.setattr(vl_convert, "javascript_bundle", bundle)
    first = module.chart_library.__wrapped__()
    assert module.chart_library.__wrapped__() == first
    assert len(asked) == 1, "the bundle was made again for the same version"
    monkeypatch.setattr(module, "PAGES_SCRIPT", "window.other = vegaEmbed;")
    assert module.chart_library.__wrapped__() != first
    assert len(asked) == 2, "another script was not bundled"
