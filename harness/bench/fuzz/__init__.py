"""Mutated input files of every kind that a user can hand in: each is read, or refused with what is wrong."""

from harness.bench.fuzz.fuzz_run import compute as compute
from harness.bench.fuzz.fuzz_run import died as died
from harness.bench.fuzz.fuzz_run import fuzz as fuzz
from harness.bench.fuzz.fuzz_run import summed as summed
from harness.bench.fuzz.fuzz_run import tasks as tasks

__all__ = ["compute", "died", "fuzz", "summed", "tasks"]
