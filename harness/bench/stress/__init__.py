"""Numerical stability: hard scenes with the outcome that each must have, stability maps, mutated input files."""

from harness.bench.stress.stress_run import holds as holds
from harness.bench.stress.stress_run import run as run
from harness.bench.stress.stress_run import sentences as sentences

__all__ = ["holds", "run", "sentences"]
