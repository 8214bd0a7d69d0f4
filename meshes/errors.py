"""What goes wrong between a scan and a solid."""

from __future__ import annotations


class MeshError(ValueError):
    """The mesh cannot be used as it is; the sentence says what was wanted, what came and what to do."""
