"""What goes wrong between a scan and a solid."""

from __future__ import annotations


class MeshError(ValueError):
    """The mesh cannot be used as it is: what was `wanted`, what came, what to do; `place` is the file, where it is told."""

    def __init__(self, wanted: str, got: str, advice: str = "", place: str = "") -> None:
        super().__init__(wanted, got, advice, place)
        self.wanted, self.got, self.advice, self.place = wanted, got, advice, place

    def at(self, place: str) -> MeshError:
        """The same, in that file."""
        return MeshError(self.wanted, self.got, self.advice, place)

    def __str__(self) -> str:
        text = f"wanted {self.wanted}, got {self.got}" + (f" — {self.advice}" if self.advice else "")
        return f"{self.place}: {text}" if self.place else text
