"""Shake-table motions: records, pulses, spectrum-compatible histories and the building's filter."""
