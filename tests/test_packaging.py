"""What is installed is whole, and the tests are collected where pybullet has no wheels."""

import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="module")
def project(root: Path) -> dict[str, Any]:
    return tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))


def test_every_file_that_is_no_code_is_in_the_wheel(root: Path, project: dict[str, Any]) -> None:
    """Templates, marks of types and the example scenes: each is matched by a pattern of pyproject.toml."""
    tools = project["tool"]["setuptools"]
    listed = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, text=True, check=False).stdout.split()
    if not listed:
        pytest.skip("no version control here")
    packages = ("analytic", "meshes", "harness", "reports")
    packaged = {
        path
        for package, patterns in tools["package-data"].items()
        for home in (packages if package == "*" else (package,))
        for pattern in patterns
        for path in (root / home).glob(pattern)
    }
    patterns = (pattern for patterns in tools["data-files"].values() for pattern in patterns)
    packaged |= {path for pattern in patterns for path in root.glob(pattern)}
    rooms = (*packages, "scenes")
    data = {root / name for name in listed if name.partition("/")[0] in rooms and not name.endswith(".py")}
    assert len(data) > 30
    assert data <= packaged


def test_no_pybullet_is_asked_for_where_it_has_no_wheels(root: Path, project: dict[str, Any]) -> None:
    """A requirement without its marker would have it built from source, or stop the installation, above CPython 3.11."""
    lock = (root / "requirements.lock").read_text(encoding="utf-8").splitlines()
    for lines in (project["project"]["dependencies"], lock):
        (wanted,) = (line for line in lines if line.startswith("pybullet"))
        marker = wanted.partition(";")[2]
        assert all(part in marker for part in ("3.12", "linux", "x86_64"))


def test_the_tests_are_collected_without_pybullet(root: Path) -> None:
    """Three files of tests stopped the whole collection on CPython 3.13."""
    code = (
        "import sys; sys.modules['pybullet'] = None; import pytest; "
        "sys.exit(pytest.main(['--collect-only', '-q', '-p', 'no:cacheprovider', '--assert=plain', "
        "'tests/harness', 'tests/reports']))"
    )
    told = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stdout[-2000:]
    assert "pybullet cannot be imported" in told.stdout
