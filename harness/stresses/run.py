"""The stress run: hard scenes, stability maps, mutated inputs; one record."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from harness import record
from harness.fuzz import fuzz
from harness.record import SCHEMA_VERSION
from harness.run import check_folder
from harness.stresses import more, scenes, stability

INPUTS: Final = 10_000
QUICK_INPUTS: Final = 500
QUICK_SCENES: Final = ("released 1e-3 rad below balance", "height to width 50", "floor friction 5")


def run(folder: Path, quick: bool = False, told: Callable[[str], None] = lambda text: None) -> dict[str, Any]:
    """Run everything and write `result.json` into `folder`; `quick` takes a few scenes, cells and inputs.

    `told` hears what is at work. Raises `InputError` for a folder that cannot be written.
    """
    check_folder(folder)
    start = time.perf_counter()
    catalogue = list(scenes.rows(told, lambda hard: not quick or hard.name in QUICK_SCENES))
    if not quick:
        catalogue += list(more.rows(told))
    found: dict[str, Any] = {
        "schema_version": SCHEMA_VERSION,
        "kind": "stress",
        "title": "Numerical stability",
        "scenes": catalogue,
        "cells": [cell.as_dict() for cell in stability.cells(told, quick)],
        "fuzz": fuzz(QUICK_INPUTS if quick else INPUTS, told=told),
        "versions": record.versions(),
        "machine": record.machine(),
    }
    found["seconds"] = time.perf_counter() - start
    plain: dict[str, Any] = record.to_plain(found)
    folder.mkdir(parents=True, exist_ok=True)
    record.write_json(folder / "result.json", plain)
    return plain


def holds(found: dict[str, Any]) -> bool:
    """Whether every hard scene came out, every cell is explained and no mutated input did harm."""
    unexplained = [cell for cell in found["cells"] if cell["category"] != "stable" and not cell["explained"]]
    harm = sum(item["tracebacks"] + item["hangs"] + item["half_written"] for item in found["fuzz"])
    return all(row["holds"] for row in found["scenes"]) and not unexplained and harm == 0


def sentences(found: dict[str, Any]) -> list[str]:
    """What the record says: scenes that did not come out, cells by category, mutated inputs that did harm."""
    wrong = [row for row in found["scenes"] if not row["holds"]]
    told = [f"{len(found['scenes']) - len(wrong)} of {len(found['scenes'])} hard scenes come out as they must."]
    for row in wrong:
        bad = "; ".join(f"{name}: {got}" for name, got in row["got"].items() if got != row["wanted"])
        told.append(f"“{row['name']}” (wanted: {row['wanted']}): {bad}.")
    counts = Counter(cell["category"] for cell in found["cells"])
    told.append("Cells of the stability maps: " + ", ".join(f"{n} {name}" for name, n in counts.items()) + ".")
    told += [
        f"Unexplained: {cell['engine']}, {cell['setting']}, {cell['difficulty']}: {cell['category']}, {cell['evidence']}."
        for cell in found["cells"]
        if cell["category"] != "stable" and not cell["explained"]
    ]
    inputs = sum(item["inputs"] for item in found["fuzz"])
    bad_inputs = [(item["reader"], case["seed"]) for item in found["fuzz"] for case in item["found"]]
    told.append(f"{inputs} mutated inputs, {len(bad_inputs)} kept as failures.")
    told += [f"Mutated {reader}, seed {seed}: not refused in words." for reader, seed in bad_inputs]
    return told
