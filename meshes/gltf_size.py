"""What a glTF file says of itself: a kilobyte may ask for gigabytes of zeros, or for one mesh ten thousand times; how it is
packed.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, Final

from meshes.errors import MeshError

MOST_ELEMENTS: Final = 100_000_000
"""Vertices and indices of all nodes together: a scan of ten million faces has 35 million."""
_GLB_MARK: Final = b"glTF"
_LOOKS: Final = re.compile("material|texture|light|variant|xmp", re.IGNORECASE)
"""Extensions that change how a surface looks, not where it is."""
_FAN: Final = 6
_FLOAT: Final = 5126
_HEADER: Final = 20
"""Bytes of a GLB before its JSON: mark, version, length; the chunk's length and kind."""


def must_be_readable(file: Path) -> None:
    """Refuse a glTF or GLB whose nodes unfold to more than MOST_ELEMENTS, or whose geometry is packed in a way that is not read;
    what does not parse is left to the reader.
    """
    data = file.read_bytes()
    if data.startswith(_GLB_MARK):
        data = data[_HEADER : _HEADER + int.from_bytes(data[12:16], "little")]
    try:
        document = json.loads(data)
        total, packed = _elements(document), _packed(document)
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return
    if packed:
        raise MeshError(
            "a glTF whose geometry is plain triangles",
            packed,
            "export it again without compression (Blender reads Draco and writes a plain GLB; gltf-transform copy unpacks"
            " Draco and meshopt)",
            place=str(file),
        )
    if total > MOST_ELEMENTS:
        raise MeshError(
            f"at most {MOST_ELEMENTS:,} vertices and indices in all nodes",
            f"{total:,}",
            "export the statue alone, decimated",
            place=str(file),
        )


def _packed(document: dict[str, Any]) -> str:
    """What of the geometry is written in a way that is not read; empty for nothing."""
    parts = [part for mesh in document.get("meshes", ()) for part in mesh["primitives"]]
    named = {*document.get("extensionsRequired", ()), *(name for part in parts for name in part.get("extensions", ()))}
    named |= {name for view in document.get("bufferViews", ()) for name in view.get("extensions", ())}
    packed = sorted(name for name in named if not _LOOKS.search(name))
    positions = [document["accessors"][part["attributes"]["POSITION"]] for part in parts]
    packed += ["triangle fans"] if any(part.get("mode") == _FAN for part in parts) else []
    packed += ["sparse positions"] if any("sparse" in each for each in positions) else []
    packed += ["whole numbers for positions"] if any(each["componentType"] != _FLOAT for each in positions) else []
    return ", ".join(packed)


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
