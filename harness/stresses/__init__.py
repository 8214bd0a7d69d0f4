"""Numerical stability: hard scenes with the outcome that each must have, stability maps, mutated input files."""

from harness.stresses.run import run as run

__all__ = ["run"]
