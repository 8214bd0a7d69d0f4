"""Where pybullet is not installed, this folder is skipped and says so."""

from pathlib import Path

import pytest

from harness.engines import load


def pytest_collect_file(file_path: Path) -> None:
    """Skip before the first import: the modules tested here import pybullet, so that their tests could not say it themselves."""
    reason = load("pybullet").missing()
    if file_path.name.startswith("test_") and reason is not None:
        pytest.skip(reason, allow_module_level=True)
