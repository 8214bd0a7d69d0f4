"""Measurements that whoever measures brings along: each is a module that runs in a process of its own and prints rows.

A command without them leaves their parts out, and its record says so.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Final

from harness.campaign.parts import Row

Programs = Mapping[str, str]
"""Modules by what they measure."""
NONE: Final[Programs] = MappingProxyType({})


def absent(programs: Programs, wanted: Iterable[str]) -> dict[str, str]:
    """What is wanted and not brought along, and why it is left out."""
    why = "no program that measures it was given (the source tree has one: make bench, make stress)"
    return {name: why for name in wanted if name not in programs}


def ask(module: str, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a module with these arguments to its end, whatever it ends with."""
    return subprocess.run([sys.executable, "-m", module, *words], capture_output=True, text=True, check=False)


def rows(module: str, *words: str) -> list[Row]:
    """What a module prints with these arguments, a row in each line. Raises `CalledProcessError` where it fails."""
    done = ask(module, *words)
    done.check_returncode()
    return [json.loads(line) for line in done.stdout.splitlines()]
