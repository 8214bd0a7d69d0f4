"""Small valid record files as the networks lay them out, from which mutated ones are made."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from tests.harness.input.motions import layouts, writers

DT_S: Final = 0.02
ONE, OTHER = (writers.wave(40, DT_S, 1.0, phase) for phase in (0.3, 0.8))


def _content(write: Callable[..., Path], *given: Any, **named: Any) -> bytes:
    """What a writer of record files writes."""
    with TemporaryDirectory() as folder:
        return write(Path(folder) / "record", *given, **named).read_bytes()


def at2() -> bytes:
    """PEER AT2."""
    return _content(writers.at2, ONE, DT_S, "090")


def v2() -> bytes:
    """CSMIP V2 with two channels."""
    return _content(layouts.usc_v2, [(ONE, "90"), (OTHER, "360")], DT_S, layouts.CSMIP_V2, whole=True)


def v2a() -> bytes:
    """GeoNet V2A with two channels."""
    return _content(layouts.geonet, [(ONE, "N28W"), (OTHER, "Up")], DT_S, corrected=True)


def smc() -> bytes:
    """USGS SMC, one channel."""
    return _content(writers.smc, ONE, 1.0 / DT_S, 45, 90, 100.0, apart=True)


def cosmos() -> bytes:
    """COSMOS with two channels."""
    return _content(writers.cosmos, [(ONE, 90), (OTHER, 400)], DT_S, milliseconds=False)


def esm() -> bytes:
    """ITACA/ESM ASCII with its header of 64 lines."""
    return _content(writers.esm, ONE, DT_S, "HNE", "20120529_070003.000")


FORMATS: Final = {
    "AT2": ("mutated.at2", at2), "V2": ("mutated.v2", v2), "V2A": ("mutated.v2a", v2a), "SMC": ("mutated.smc", smc),
    "COSMOS": ("mutated.v2c", cosmos), "ESM": ("mutated.asc", esm),
}  # fmt: skip
"""File name and content of each format."""
