"""The main job: the paper's study and the example scenes, each with its report."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Final

from harness import study_cli
from harness.cli import compute, guarded, summary
from harness.paths import data_folder
from harness.run import write_result
from reports.page import write_report

SCENES: Final = Path(__file__).resolve().parent.parent / "scenes"
OUT: Final = Path("out")
ALWAYS: Final = ("paestum_pedestal", "paestum_floor", "free_rocking")
WITH_DATA: Final = ("maria",)
STUDY: Final = "paestum_table2"


def main() -> int:
    """Run the study and the scenes into `out/`; returns 1 when a run failed."""
    start = time.perf_counter()
    pages: list[Path] = []
    names = list(ALWAYS)
    if data_folder().is_dir():
        names += WITH_DATA
    else:
        print(f"left out: {', '.join(WITH_DATA)} (real data absent: set ROCKCHECK_DATA)", file=sys.stderr)
    _, done = study_cli.run(SCENES / f"{STUDY}.toml", OUT / STUDY)
    pages.append(write_report(OUT / STUDY))
    print(f"{STUDY}: {done}")
    bad = done.failed > 0
    for name in names:
        result = compute(SCENES / f"{name}.toml", None, None, None, None, None, quiet=False)
        write_result(result, OUT / name)
        pages.append(write_report(OUT / name))
        print(summary(result))
        bad = bad or result.failed
    print(f"\ndone in {time.perf_counter() - start:.0f} s. Reports:")
    for page in pages:
        print(f"  {page}")
    return int(bad)


if __name__ == "__main__":
    sys.exit(guarded(main))
