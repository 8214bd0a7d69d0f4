"""What is told of work before it begins, and what it takes: `python -m tests.measures.forecasts [KIND]`.

Every command runs in a process of its own that tells its forecast however short the work is; told and taken are seconds of
processor time of that process and all that it starts.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

PROGRAM: Final = """
from harness.questions.scene import workload
workload.REPORTED_FROM_S = 0.0
from reports.cli import main
main()
"""
UNITS: Final[Mapping[str, float]] = {"s": 1.0, "min": 60.0, "h": 3600.0, "days": 86400.0}
PEDESTAL: Final = "scenes/paestum_pedestal.toml"
FLOOR: Final = "scenes/paestum_floor.toml"
SMALL_STUDY: Final = """
title = "a few conditions, with and without pedestal"
scene = "{scene}"
[[vary]]
key = "contact.restitution"
values = [0.85, 0.9]
[[vary]]
key = "motion.x.frequency_hz"
values = [2.0, 3.0, 4.5]
[[vary]]
key = "pedestal"
values = ["none", "keep"]
[[variant]]
name = "own impact"
engines = ["analytic", "pymunk", "pybullet"]
set = {{ "contact.restitution" = "momentum" }}
"""
COMMANDS: Final[Mapping[str, Sequence[str]]] = {
    "free rocking": ("run", "scenes/free_rocking.toml"),
    "floor": ("run", FLOOR, "--set", "duration_s=40", "--set", "motion.x.amplitude_g=0.12"),
    "fall": ("run", FLOOR),
    "pedestal": ("run", PEDESTAL, "--set", "duration_s=20", "--set", "motion.x.amplitude_g=0.2"),
    "pedestal outgrown": ("run", PEDESTAL),
    "witness": ("run", PEDESTAL, "--witness"),
    "wall": ("run", FLOOR, "--set", "wall.side=right", "--set", "wall.distance_m=0.6"),
    "mesh and record in space": ("run", "scenes/maria.toml"),
    "space": ("run", "scenes/3d_effects_base.toml"),
    "thrown": ("run", "scenes/cube_toss.toml"),
    "study": ("study", "{study}"),
    "assess": ("assess", PEDESTAL, "-e", "analytic", "-e", "pymunk"),
}


def told_s(words: str) -> tuple[float, float]:
    """The least and the most seconds of processor time that a forecast tells."""
    before = words.split(" of processor time")[0]
    found = re.findall(r"([\d.e+]+) (s|min|h|days)\b", before.rsplit(":", maxsplit=1)[-1])
    each = [float(value) * UNITS[unit] for value, unit in found]
    return min(each), max(each)


def taken(arguments: Sequence[str]) -> tuple[str, float]:
    """The forecast that a command tells, and the processor seconds that it and its processes take."""
    command = [sys.executable, "-c", PROGRAM, *arguments]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    said = process.stderr.read() if process.stderr is not None else ""
    _, _, usage = os.wait4(process.pid, 0)
    return next(
        (line for line in said.splitlines() if "of processor time" in line), said
    ), usage.ru_utime + usage.ru_stime


def main(kinds: Sequence[str]) -> None:
    """Print of each command what was told and taken, and by which factor the one is outside the other."""
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "study.toml"
        study.write_text(SMALL_STUDY.format(scene=Path(PEDESTAL).resolve()), encoding="utf-8")
        for number, (kind, arguments) in enumerate(COMMANDS.items()):
            if kinds and kind not in kinds:
                continue
            given = [item.format(study=study) for item in arguments]
            words, spent_s = taken([*given, "--out", str(Path(folder) / str(number))])
            if "of processor time" not in words:
                print(f"{kind}: nothing told: {words}", flush=True)
                continue
            least_s, most_s = told_s(words)
            print(f"{kind}: told {least_s:.3g} to {most_s:.3g} s, taken {spent_s:.3g} s: ", end="")
            print(f"{least_s / spent_s:.2f} to {most_s / spent_s:.2f} times", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
