"""Numerical stability: hard scenes with the outcome that each must have, stability maps, mutated input files."""

from harness.stresses.run import holds as holds
from harness.stresses.run import run as run
from harness.stresses.run import sentences as sentences

__all__ = ["holds", "run", "sentences"]
