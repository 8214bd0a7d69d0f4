"""How large a glTF file says it will be: a kilobyte may ask for gigabytes of zeros, or for one mesh ten thousand times."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

from meshes.errors import MeshError

MOST_ELEMENTS: Final = 100_000_000
"""Vertices and indices of all nodes together: a scan of ten million faces has 35 million."""
_GLB_MARK: Final = b"glTF"
_HEADER: Final = 20
"""Bytes of a GLB before its JSON: mark, version, length; the chunk's length and kind."""


def must_be_bounded(file: Path) -> None:
    """Refuse a glTF or GLB whose nodes unfold to more than MOST_ELEMENTS; what does not parse is left to the reader."""
    data = file.read_bytes()
    if data.startswith(_GLB_MARK):
        data = data[_HEADER : _HEADER + int.from_bytes(data[12:16], "little")]
    try:
        total = _elements(json.loads(data))
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return
    if total > MOST_ELEMENTS:
        raise MeshError(
            f"at most {MOST_ELEMENTS:,} vertices and indices in all nodes",
            f"{total:,}",
            "export the statue alone, decimated",
            place=str(file),
        )


def _elements(document: dict[str, Any]) -> int:
    """Elements of all accessors once, and of every mesh as often as a node places it."""
    counts: list[int] = [int(accessor["count"]) for accessor in document.get("accessors", ())]
    sizes: list[int] = []
    for mesh in document.get("meshes", ()):
        parts = mesh["primitives"]
        used = [part["attributes"]["POSITION"] for part in parts] + [
            part["indices"] for part in parts if "indices" in part
        ]
        sizes.append(sum(counts[index] for index in used))
    placed: list[int] = [node["mesh"] for node in document.get("nodes", ()) if "mesh" in node]
    return sum(counts) + sum(sizes[mesh] for mesh in placed)
