"""What a scan of two million faces costs: `python -m tests.measures.scan_cost [EDGE_M]` makes one of the generated statue.

Reading, inspecting and preparing are measured in a process of their own that does nothing else; the slenderness rose of 360
azimuths after it.
"""

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Final

import numpy as np

from meshes import footprint
from meshes.prepare import Wanted, inspect
from tests.meshes import togatus
from tests.meshes.scanner import Faults, scan, write

EDGE_M: Final = 0.0038
"""Longest edge of the scan made: some two million faces on the statue of 1.46 m."""
MEASURE: Final = "--measure"


def measure(file: Path) -> dict[str, Any]:
    """Wall and processor time, s, of inspecting and preparing a scan in millimetres, peak memory of this process, and results."""
    wall, cpu = time.perf_counter(), time.process_time()
    found = inspect(file, Wanted(unit="mm"), density_kg_m3=2700.0)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    solid = found.solid
    if solid is None:
        raise RuntimeError(f"the scan of a statue that stands does not stand: {found.refusal}")
    begin = time.perf_counter()
    rose = footprint.slenderness_rose_rad(solid.footprint_m, solid.centroid_height_m, np.arange(360.0))
    return {
        "faces": len(found.raw.faces),
        "kept_faces": len(found.prepared.mesh.faces),
        "wall_s": wall,
        "cpu_s": cpu,
        "memory_gib": memory,
        "rose_s": time.perf_counter() - begin,
        "weakest_deg": float(np.rad2deg(rose.min())),
        "mass_kg": solid.mass_kg,
    }


def main(arguments: list[str]) -> None:
    """Make the scan, measure it apart, print one line."""
    if arguments[:1] == [MEASURE]:
        print(json.dumps(measure(Path(arguments[1]))))
        return
    edge = float(arguments[0]) if arguments else EDGE_M
    with tempfile.TemporaryDirectory() as folder:
        file = write(scan(togatus.build(), Faults(edge_m=edge, noise_m=2e-4)), Path(folder) / "scan.ply")
        command = [sys.executable, "-m", "tests.measures.scan_cost", MEASURE, str(file)]
        found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    print(
        f"{found['faces']} faces inspected and prepared ({found['kept_faces']} kept): {found['wall_s']:.1f} s, of processor"
        f" {found['cpu_s']:.1f} s, {found['memory_gib']:.2f} GiB; mass {found['mass_kg']:.2f} kg of 707; a rose of 360 azimuths"
        f" in {1e3 * found['rose_s']:.2f} ms"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
