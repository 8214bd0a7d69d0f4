"""Measurements that the source tree holds and the packages alone do not: each runs in a process of its own and prints rows.

Where the source tree is not here, the record says so.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Final

from harness.campaign.parts import Row

ROOT: Final = Path(__file__).resolve().parents[2]


def missing(module: str) -> str | None:
    """Why a module of the source tree cannot be run here, or None."""
    folder = "/".join(module.split(".")[:2])
    return None if (ROOT / folder).is_dir() else f"{folder} of the source tree is not here"


def ask(module: str, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a module with these arguments to its end, whatever it ends with."""
    command = [sys.executable, "-m", module, *words]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def rows(module: str, *words: str) -> list[Row]:
    """What a module prints with these arguments, a row in each line. Raises `CalledProcessError` where it fails."""
    done = ask(module, *words)
    done.check_returncode()
    return [json.loads(line) for line in done.stdout.splitlines()]
