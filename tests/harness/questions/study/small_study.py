"""A study small enough for every test, and what a store holds of it."""

import os
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

from harness.runs.runner import Crash
from harness.runs.task import TaskResult

BLOCK = """
title = "a block"
duration_s = 2.0
[statue]
mass_kg = 707.0
centroid_height_m = 0.774
corner_left_m = 0.3585
corner_right_m = 0.0682
inertia_kg_m2 = 152.4
height_m = 1.46
[pedestal]
mass_kg = 250.0
width_m = 0.6
depth_m = 0.8
height_m = 0.2
[motion.x]
kind = "harmonic"
amplitude_g = 0.3
frequency_hz = 2.0
"""
STUDY = """
title = "a small study"
scene = "block.toml"
[[vary]]
key = "motion.x.amplitude_g"
start = 0.05
stop = 0.6
count = 6
[[vary]]
key = "motion.x.frequency_hz"
start = 1.0
stop = 4.0
count = 5
[[vary]]
key = "contact.restitution"
values = [0.85, 0.9]
[[variant]]
name = "own"
engines = ["analytic"]
set = { "contact.restitution" = "momentum" }
"""


def written(folder: Path, text: str = STUDY) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "block.toml").write_text(BLOCK)
    (folder / "study.toml").write_text(text)
    return folder / "study.toml"


def contents(path: Path) -> list[Any]:
    with closing(sqlite3.connect(path)) as db:
        return [
            db.execute(f"SELECT * FROM {table} ORDER BY 1, 2").fetchall() for table in ("result", "plan", "history")
        ]


CONTACT = """
title = "a small study of contact"
scene = "block.toml"
[[vary]]
key = "motion.x.amplitude_g"
start = 0.2
stop = 0.6
count = 8
[[vary]]
key = "motion.x.frequency_hz"
values = [1.5, 3.0, 5.0]
[[variant]]
name = "own"
engines = ["pymunk"]
set = { "contact.restitution" = "momentum", pedestal = "none", duration_s = 0.5 }
[accuracy]
pymunk = 1e-2
[ask]
histories = true
"""
"""Runs of some 20 ms each, by an engine that needs no compiler."""


def lethal(name: str) -> TaskResult:
    """Work that takes its process with it where a task says so."""
    if name == "die":
        os._exit(3)
    return TaskResult("said", {"text": name.upper()}, 0.0)


def lost(name: str, crash: Crash) -> TaskResult:
    """What is kept of a task whose process died."""
    return TaskResult("said", {"text": str(crash)}, 0.0, failed=True)
