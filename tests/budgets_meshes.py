"""Tolerances of the mesh tests, each with the sentence that derives it."""

SURVEY_REL = 1e-9
"""The togatus is solved by a root-finder to 1e-10 of its targets; the constants in the source carry 16 digits."""

SURVEY_ASKED_REL = 5e-3
"""The generated statue must agree with the survey within half a per cent, as every recovered scan must."""

RESOLVED_ABS = 1e-8
"""Two starts of the root-finder agree to its relative step of 1e-10 on proportions of order one, with a margin of 100."""

ROUND_OFF_REL = 1e-12
"""Sums over a few thousand float64 terms: a few hundred units in the last place."""

FACET_REL = 2e-3
"""A cylinder of 128 facets holds (1 - sin(x)/x), x = 2π/128, that is 4e-4, less volume than the round one."""

CENTROID_TOLERANCE_M = 1e-3
"""The brief of the statue: its centroid at mid-depth within a millimetre."""

FLAT_BASE_M = 1e-12
"""The plinth's lower corners are typed as z = 0 and only translated: rounding alone."""

FLOAT32_ROUNDING_M = 2e-7
"""glTF keeps single precision: coordinates below 2 m round by at most 2 m times 2^-24, 1.2e-7 m."""

CORNER_ASKED_M = 1e-3
"""Corners recovered from a scan with 1 mm of noise must be within that noise."""

QUIET_SCAN_REL = 1e-3
"""A scan without noise loses only its ragged rim: 6 mm of the base's height closed straight down, chamfer included."""

DECIMATION_VOLUME_REL = 1e-3
"""The bound that decimation states for itself."""

HULL_GAP_M = 5e-3
"""With 128 vertices over a body of 1.5 m, sagitta of a facet of 0.15 m on a curve of 0.4 m: 7 mm at worst, half on average."""

OUTLINE_NOISE_SHARE = 1.5
"""A side fitted to n >= 40 points is off by 2σ/√n at its ends, 0.3 σ; two sides and a joined bump of 4σ stay below 1.5 σ."""

SAME_PLANE_RAD = 4e-4
"""pybullet's own error at 0.25 ms over the first second, from spheres at the base's corners (measured/pybullet_settings.md)."""

WITHIN_HULL_M = 1e-9
"""Corners of a part against the planes of the statue's hull: rounding of the exact cut and of the hull's own planes."""

PARTS_MISSING_REL = 0.02
"""Twice the 1 % of a scan's volume that 3000 triangles and 64 corners a part leave out (`tests.measures.exact_shapes`)."""

BOXES_REL = 2e-3
"""Three boxes are three convex parts; CoACD cuts within a hundredth of the body's size of their seams: 1.4e-3 measured."""

CUT_VOLUME_REL = 0.06
"""A cut above a floor may take 4 cm of the plinth's 0.31 m² with it: 0.0124 m³ of the statue's 0.262, rounded up."""

LEVELLED_RAD = 0.03
"""A base ragged by 3 mm over 220 mm may tip by twice their ratio, 0.027; a clean one is level to rounding."""

NAMED_UP_RAD = 0.2
"""A cut ragged by 12 mm (three times that at its peaks) over 220 mm rests within 0.16 of its mean plane."""

NOISE_REL = 2e-3
"""Noise of 7 mm at each of 3500 vertices over a radius of 0.3 m: 2 · 7/300/sqrt(3500) is 8e-4 of the volume; rounded up."""

FORMER_LIMIT = 0.01
"""Share of faces that pass through another one from which scans were refused, noisy ones as well."""
