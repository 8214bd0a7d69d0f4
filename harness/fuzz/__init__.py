"""Mutated input files of every kind that a user can hand in: each is read, or refused with what is wrong."""

from harness.fuzz.run import compute as compute
from harness.fuzz.run import died as died
from harness.fuzz.run import fuzz as fuzz
from harness.fuzz.run import summed as summed
from harness.fuzz.run import tasks as tasks

__all__ = ["compute", "died", "fuzz", "summed", "tasks"]
