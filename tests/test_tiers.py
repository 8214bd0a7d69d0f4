"""Every test stands in one tier, and the list of the fast ones names what is there."""

import importlib.util
from pathlib import Path

import pytest


def test_the_fast_files_are_there(root: Path) -> None:
    listed = (root / "tests" / "fast.txt").read_text(encoding="utf-8").split()
    assert len(listed) > 30
    assert [file for file in listed if not (root / file).is_file()] == []
    assert listed == sorted(set(listed))


@pytest.mark.parametrize(
    ("tier", "file"),
    [
        ("fast", "tests/harness/model/test_history.py"),
        ("engines", "tests/harness/engines/test_contract.py"),
        ("measures", "tests/measures/test_pages.py"),
    ],
)
def test_a_file_is_of_one_tier(root: Path, request: pytest.FixtureRequest, tier: str, file: str) -> None:
    spec = importlib.util.spec_from_file_location("conftest_read", root / "tests" / "conftest.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.tier_of(file) == tier
    marks = {mark.name for mark in request.node.iter_markers()} & {"fast", "engines", "measures"}
    assert marks == {module.tier_of("tests/test_tiers.py")}
