"""What every contact engine shares: motion of the table, friction with two numbers, an imposed impact, reduction to a `Run`.

An engine's adapter owns its world; its loop is the layer's (`harness.engines.event_stepping`). Both take from here

- `frame`: the gravity of each step in the floor's accelerating frame, or the table's velocity and place;
- `friction`: when the floor's coefficient is the static one and when the kinetic;
- `impact`: the model's impact map on both bodies, for a scene that prescribes a ratio;
- `trajectory`: what the loop recorded, as arrays;
- `reduce`: from these arrays to the record (impacts, patterns, outcome, histories on the output grid, forces, energy).
"""
