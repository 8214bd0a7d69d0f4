"""What goes wrong between a scan and a solid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Doubt:
    """What is doubtful of a scan: `code` names it, `values` are numbers in the unit that ends their key, and names."""

    code: str
    values: Mapping[str, Any] = field(default_factory=dict)


class MeshError(ValueError):
    """The mesh cannot be used as it is: what was `wanted`, what came, what to do; `place` is the file, where it is told.

    `doubt` is the same of a mesh that is used all the same.
    """

    def __init__(self, wanted: str, got: str, advice: str = "", place: str = "", doubt: Doubt | None = None) -> None:
        super().__init__(wanted, got, advice, place, doubt)
        self.wanted, self.got, self.advice, self.place, self.doubt = wanted, got, advice, place, doubt

    def at(self, place: str) -> MeshError:
        """The same, in that file."""
        return MeshError(self.wanted, self.got, self.advice, place, self.doubt)

    def __str__(self) -> str:
        text = f"wanted {self.wanted}, got {self.got}" + (f" — {self.advice}" if self.advice else "")
        return f"{self.place}: {text}" if self.place else text
