"""What the third dimension changes: overturning amplitude by direction in 3D beside the planar models, and what moves it.

Azimuths are directions in the statue's own frame, counter-clockwise from x seen from above: the direction along which the
floor shakes. The statue is turned, not the floor: shaking stays along x, so every planar model sees its own section.
"""
