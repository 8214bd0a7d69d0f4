"""Most open tables (`[str, Any]`) that a room may hold beside the reader and the writer of records: they only ever get fewer."""

from __future__ import annotations

from typing import Final

OPEN_TABLES: Final = {
    "analytic": 1,
    "meshes": 1,
    "harness/records": 3,
    "harness/campaign": 1,
    "harness/effects3d": 1,
    "reports/charts": 1,
}
"""Counted; a room that is not named here holds none. Whoever removes one lowers its room's number in the same commit."""
