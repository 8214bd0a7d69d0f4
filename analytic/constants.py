"""Numbers that every model of one scene must share; defined here once, for those outside this package too."""

from __future__ import annotations

from typing import Final

GRAVITY_M_S2: Final = 9.81
"""Where a scene names no other: standard gravity to three digits."""
OVERTURN_RAD: Final = 1.5
"""|θ| at which a statue counts as overturned: well beyond every balance point, and below the π/2 of a block that lies flat, which
a contact engine misses by the depth to which its contacts sink in."""
