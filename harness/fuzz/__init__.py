"""Mutated input files of every kind that a user can hand in: each is read, or refused with what is wrong."""

from harness.fuzz.run import fuzz as fuzz

__all__ = ["fuzz"]
