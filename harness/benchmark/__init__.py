"""Run time against error, what each skip gains, how cost grows: one record, one run."""

from harness.benchmark.run import run as run

__all__ = ["run"]
