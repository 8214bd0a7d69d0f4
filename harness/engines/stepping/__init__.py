"""One room for every contact engine: whole steps, and shorter ones around the events that it locates; from these to a `Run`.

In the order in which a run passes them: `loop` (what comes next, when to stop, what an imposed impact leaves), `step_state` (what
an engine offers, when a foot comes down, one step with two coefficients, the two clocks of places and of velocities, what is
written to a body, and the numbers of all these). `trajectory` holds gravity or table, step by step, and what was passed;
`support` tells where the statue stands and accounts for the friction that acted; `reduce` makes the record of it all.
"""
