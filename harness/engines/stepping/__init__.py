"""One room for every contact engine: whole steps, and shorter ones around the events that it locates; from these to a `Run`.

In the order in which a run passes them: `schedule` and `frame` (gravity or table, step by step), `loop` (what comes next),
`watch` (when to stop), `step_state` (the two clocks, of places and of velocities), `stepper` and `friction` (one step with two
coefficients), `backend` (what an engine offers). What comes next is told by `contact_gaps`, `contact_time`, `micro_rocking`,
`slip_onset` and `rest_spell`, and met by `locating` and `imposing` (the map of `impact`); `settings` holds the numbers of all
these. `writing`, `interventions` and `balance` account for what is written to a body, `coulomb` for the friction that acted;
`step_log` and `columns` make the `trajectory`, `reduce` the record of it (`rocking`, `falling`, `support`, `forces`, `domain`);
`plain_steps` is the loop of engines as they come, `steering` what they refuse.
"""
