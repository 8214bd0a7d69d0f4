"""An invented result folder of every kind of record."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Final

from tests.reports import invented_records, invented_study
from tests.reports.invented_effects import write_effects
from tests.reports.invented_run import write_invented

WRITERS: Final[Mapping[str, Callable[[Path], Path]]] = {
    "run": lambda folder: write_invented(folder, disagree=True, mesh=True),
    "table": invented_study.write_table_study,
    "map": invented_study.write_map_study,
    "rose": invented_study.write_rose_study,
    "effects": write_effects,
    "assessment": invented_records.write_assessment,
    "comparison": invented_records.write_comparison,
    "validation": invented_records.write_validation,
    "bench": invented_records.write_bench,
    "stress": invented_records.write_stress,
    "trust": invented_records.write_trust,
}
"""What writes each into a folder, which it returns."""
RUNS: Final[Mapping[str, Callable[[Path], Path]]] = {
    "agreed": write_invented,
    "apart": partial(write_invented, disagree=True),
    "meshed": partial(write_invented, mesh=True),
    "bare": partial(write_invented, pedestal=False),
}
"""What writes other runs: their models agree or not, the statue has a mesh, or no pedestal."""
