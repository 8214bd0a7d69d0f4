"""One layer for every contact engine: whole steps, and shorter ones around the events that it locates.

In the order in which a run passes them: `schedule` (gravity or table, step by step), `loop` (what comes next), `watch` (when to
stop), `step_state` (the two clocks, of places and of velocities), `stepper` (one step with two coefficients of friction),
`backend` (what an engine offers). What comes next is told by `contact_gaps`, `contact_time`, `micro_rocking`, `slip_onset` and
`rest_spell`, and met by `locating` and `imposing`; `settings` holds the numbers of all these. `writing` and `interventions`
account for what is written to a body; `step_log` and `columns` make the trajectory; `plain_steps` is the loop of engines as they
come.
"""
