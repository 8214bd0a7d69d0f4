"""Where compiled code is kept: pruned, safe beside other processes, and somewhere else where nothing can be written."""

import os
import shutil
from pathlib import Path

import pytest

from analytic import machine_code

ROOT = Path(__file__).resolve().parents[2]
NEEDS_ROOT = pytest.mark.skipif(os.getuid() != 0, reason="only the superuser can make a folder of another user")


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    """A folder with one compiled source."""
    here = tmp_path / "package"
    here.mkdir()
    (here / "integrator.py").write_text("one = 1\n")
    return here


def folders(home: Path) -> list[str]:
    return sorted(each.name for each in home.glob("compiled-*"))


def test_every_source_of_the_folder_names_its_cache(sources: Path) -> None:
    before = machine_code.digest(sources)
    (sources.parent / "page.py").write_text("not of the folder\n")
    assert machine_code.digest(sources) == before
    (sources / "integrator.py").write_text("one = 2\n")
    assert machine_code.digest(sources) != before


def test_the_newest_two_are_kept(sources: Path) -> None:
    home = sources / "__pycache__"
    for age in range(4):
        old = home / f"compiled-{age}"
        old.mkdir(parents=True)
        os.utime(old, (1000.0 - age, 1000.0 - age))
    chosen = machine_code.folder(sources)
    assert folders(home) == sorted(["compiled-0", chosen.name])
    (home / "compiled-other").mkdir()
    assert machine_code.folder(sources) == chosen
    assert "compiled-other" in folders(home), "nothing is removed while the sources stay"


def test_a_folder_that_another_process_removes_meanwhile_is_passed_over(
    sources: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = sources / "__pycache__"
    for name in "abc":
        (home / f"compiled-{name}").mkdir(parents=True)
    real = Path.stat

    def gone(path: Path, **options: bool) -> os.stat_result:
        if path.name == "compiled-b":
            raise FileNotFoundError(path)
        return real(path, **options)

    monkeypatch.setattr(Path, "stat", gone)
    machine_code.prune(home, most=1)
    monkeypatch.undo()
    assert len(folders(home)) == 2


def test_read_only_sources_fall_back_to_the_user_s_cache_then_to_temporary_files(
    sources: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (sources / "__pycache__").write_text("a file where a folder is wanted: nothing can be made in it")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(machine_code.tempfile, "tempdir", str(tmp_path))
    chosen = machine_code.folder(sources)
    assert chosen.parent == tmp_path / "cache" / "rockcheck"
    shutil.rmtree(tmp_path / "cache")
    (tmp_path / "cache").write_text("no folder either")
    last = machine_code.folder(sources)
    assert last.parent.parent == tmp_path


def test_a_user_without_a_home_is_served(sources: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", homeless)
    monkeypatch.setattr(machine_code.tempfile, "tempdir", str(tmp_path))
    assert [home.name.split("-")[0] for home in machine_code.homes(sources)] == ["__pycache__", "rockcheck"]


def test_where_nothing_can_be_written_nothing_is_cached(sources: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine_code, "_writable", lambda chosen: False)
    assert machine_code.folder(sources) is None


def planted(kind: str, tmp_path: Path, wanted: Path) -> None:
    """A folder where the cache would stand that someone else could have put there, or could write into."""
    wanted.parent.mkdir(parents=True, exist_ok=True)
    if kind == "linked":
        (tmp_path / "elsewhere").mkdir(mode=0o700)
        wanted.symlink_to(tmp_path / "elsewhere")
        return
    wanted.mkdir(mode=0o700)
    if kind == "open":
        wanted.chmod(0o777)
    if kind == "foreign":
        os.chown(wanted, 12345, 12345)


@pytest.mark.parametrize("kind", ["linked", "open", pytest.param("foreign", marks=NEEDS_ROOT)])
@pytest.mark.parametrize("inner", [False, True])
def test_a_folder_that_others_could_have_filled_is_not_used(
    sources: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, inner: bool
) -> None:
    (sources / "__pycache__").write_text("no folder")
    (tmp_path / "cache").write_text("no folder either")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(machine_code.tempfile, "tempdir", str(tmp_path / "temporary"))
    home = tmp_path / "temporary" / f"rockcheck-{os.getuid()}"
    planted(kind, tmp_path, home / (machine_code.PREFIX + machine_code.digest(sources)) if inner else home)
    assert machine_code.folder(sources) is None
    left = [path for path in home.rglob("*") if path.is_file()]
    assert left == [], "nothing is written there"


def test_a_folder_that_can_be_replaced_is_not_used(
    sources: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without the sticky bit of a temporary folder anyone may rename what stands in it."""
    (sources / "__pycache__").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache").chmod(0o777)
    monkeypatch.setattr(machine_code.tempfile, "tempdir", str(tmp_path))
    chosen = machine_code.folder(sources)
    assert chosen.parent == tmp_path / f"rockcheck-{os.getuid()}"
    (tmp_path / "cache").chmod(0o1777)
    chosen = machine_code.folder(sources)
    assert chosen.parent.parent == tmp_path / "cache"
    assert chosen.stat().st_mode & 0o777 == 0o700
