"""Charts that zoom and their still pictures."""

from typing import Any

Json = dict[str, Any]
"""A chart, or a part of one, as its library takes it: which keys it knows is the library's."""
