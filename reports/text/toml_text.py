"""A scene's content as TOML text, for the page's settings to repeat a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def toml_text(content: Mapping[str, Any]) -> str:
    """TOML of nested mappings of strings, numbers, booleans and lists; keys without a value are left out."""
    import tomli_w

    return tomli_w.dumps(_given(content))


def _given(content: Mapping[str, Any]) -> dict[str, Any]:
    return {
        key: _given(value) if isinstance(value, Mapping) else value
        for key, value in content.items()
        if value is not None
    }
