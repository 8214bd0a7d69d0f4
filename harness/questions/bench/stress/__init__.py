"""Numerical stability: hard scenes with the outcome that each must have, stability maps, mutated input files."""
