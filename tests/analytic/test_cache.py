"""Where compiled code is kept: pruned, safe beside other processes, and somewhere else where nothing can be written."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from analytic import _cache

ROOT = Path(__file__).resolve().parents[2]


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
    before = _cache.digest(sources)
    (sources.parent / "page.py").write_text("not of the folder\n")
    assert _cache.digest(sources) == before
    (sources / "integrator.py").write_text("one = 2\n")
    assert _cache.digest(sources) != before


def test_the_newest_two_are_kept(sources: Path) -> None:
    home = sources / "__pycache__"
    for age in range(4):
        old = home / f"compiled-{age}"
        old.mkdir(parents=True)
        os.utime(old, (1000.0 - age, 1000.0 - age))
    chosen = _cache.folder(sources)
    assert chosen is not None
    assert folders(home) == sorted(["compiled-0", chosen.name])
    (home / "compiled-other").mkdir()
    assert _cache.folder(sources) == chosen
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
    _cache.prune(home, kept=1)
    monkeypatch.undo()
    assert len(folders(home)) == 2


def test_read_only_sources_fall_back_to_the_user_s_cache_then_to_temporary_files(
    sources: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (sources / "__pycache__").write_text("a file where a folder is wanted: nothing can be made in it")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(_cache.tempfile, "tempdir", str(tmp_path))
    chosen = _cache.folder(sources)
    assert chosen is not None
    assert chosen.parent == tmp_path / "cache" / "rockcheck"
    shutil.rmtree(tmp_path / "cache")
    (tmp_path / "cache").write_text("no folder either")
    last = _cache.folder(sources)
    assert last is not None
    assert last.parent.parent == tmp_path


def test_a_user_without_a_home_is_served(sources: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", homeless)
    monkeypatch.setattr(_cache.tempfile, "tempdir", str(tmp_path))
    assert [home.name.split("-")[0] for home in _cache.homes(sources)] == ["__pycache__", "rockcheck"]


def test_where_nothing_can_be_written_nothing_is_cached(sources: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_cache, "_writable", lambda chosen: False)
    assert _cache.folder(sources) is None


def test_a_cache_removed_under_a_running_process_does_no_harm(tmp_path: Path) -> None:
    """The compiler of one process finds its folder gone between import and first call."""
    code = """
import shutil, analytic.kernel.compiler as c, analytic.kernel.small
shutil.rmtree(c._home())
print(analytic.kernel.small.twice(2.0))
assert any(c._home().iterdir()), "it was written again"
"""
    package = tmp_path / "analytic"
    shutil.copytree(ROOT / "analytic", package, ignore=shutil.ignore_patterns("__pycache__"))
    small = "from analytic.kernel.compiler import jit\n\n@jit\ndef twice(x):\n    return 2.0 * x\n"
    (package / "kernel" / "small.py").write_text(small)  # instead of a kernel that takes half a minute
    told = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stderr
    assert told.stdout.strip() == "4.0"
