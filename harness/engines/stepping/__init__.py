"""One room for every contact engine: whole steps, and shorter ones around the events that it locates; from these to a `Run`.

In the order in which a run passes them: `frame` (gravity or table, step by step), `loop` (what comes next, when to stop, what an
imposed impact leaves), `step_state` (what an engine offers, one step with two coefficients, the two clocks of places and of
velocities, what is written to a body). What comes next is told by `contact_gaps`; `settings` holds the numbers of all these.
`coulomb` accounts for the friction that acted; `step_log` and `columns` hold what was passed, `reduce` makes the record of it
(with `support`).
"""
