"""How far a number of a scene is known where nobody says: a distribution for each kind of key, and where its width comes from."""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Final, Literal


@dataclass(frozen=True)
class Assumption:
    """Keys (`*` stands for an axis), their distribution's kind and width, and the source of that width."""

    keys: str
    kind: Literal["lognormal", "normal", "uniform"]
    width: float
    source: str


ASSUMPTIONS: Final = (
    Assumption(
        "contact.floor",
        "lognormal",
        0.15,
        "repeated sliding of one pair of dry stones scatters by 10 to 20 % of its mean",
    ),
    Assumption("contact.statue", "lognormal", 0.15, "as for contact.floor"),
    Assumption(
        "contact.floor_impact",
        "uniform",
        0.5,
        "of the way from the kinetic to the static coefficient: which one acts at an impact is a choice between laws",
    ),
    Assumption(
        "motion.scale", "lognormal", 0.10, "how far a strength is known once a record or a peak has been chosen"
    ),
    Assumption(
        "motion.*.frequency_hz", "lognormal", 0.05, "how far a table, or a floor's own period, holds its frequency"
    ),
    Assumption(
        "statue.mesh.density_kg_m3",
        "lognormal",
        0.03,
        "marble weighs 2700 to 2900 kg/m³ (stonewalls.ch, weight of stones)",
    ),
    Assumption(
        "motion.time_scale",
        "lognormal",
        0.05,
        "our own: as for a frequency; the time between two records of a motion, and so its periods and its duration",
    ),
    Assumption("statue.mass_kg", "lognormal", 0.03, "from a volume: marble weighs 2700 to 2900 kg/m³ (stonewalls.ch)"),
    Assumption(
        "statue.centroid_height_m",
        "lognormal",
        0.02,
        "our own: a bore of a tenth of the volume in the lower or upper half of a block moves its centroid by 2.5 %",
    ),
    Assumption("statue.mesh.adjust.centroid_rel", "normal", 0.02, "our own: as for statue.centroid_height_m"),
    Assumption("statue.corner_left_m", "uniform", 0.005, "our own: a worn or chipped edge, half a centimetre"),
    Assumption("statue.corner_right_m", "uniform", 0.005, "our own: a worn or chipped edge, half a centimetre"),
    Assumption("statue.mesh.adjust.base_rel", "uniform", 0.02, "our own: a worn edge, 4 to 5 mm of a base of 0.45 m"),
    Assumption(
        "statue.mesh.contact_tolerance_m", "lognormal", 0.5, "our own: what touches is known to a factor of about two"
    ),
    Assumption(
        "statue.mesh.azimuth_deg", "normal", 2.0, "our own: a statue set by eye along a wall or a joint of the floor"
    ),
    Assumption("pedestal.offset_m", "uniform", 0.01, "our own: a place measured with a tape from the pedestal's edges"),
    Assumption(
        "contact.restitution",
        "normal",
        0.037,
        "repeated first impacts of limestone blocks scatter so, noise included (BED #92, doi 10.60756/uminho-jh25)",
    ),
)
"""Widths that the project chose itself say so: no publication is behind them."""


def assumption(key: str) -> Assumption | None:
    """What is assumed of a key, None where nothing is."""
    return next((item for item in ASSUMPTIONS if fnmatchcase(key, item.keys)), None)
