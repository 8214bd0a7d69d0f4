"""The bench and the stress run: what a run costs and errs by, and where engines stop being right.

`rockcheck bench` is `bench_run.py`: run time against error, what a target takes, what skips gain together and alone, how cost
grows. `rockcheck stress` is `stress_run.py`: hard scenes and stability maps. Both are measured in parts (`parts.py`). What stands
beside other projects' programs, or holds the whole to its claims, is measured in the source tree (`make bench`, `make stress`).
Nothing else in the harness imports this room.
"""
