"""One problem and its options, whichever way they are stated; and the memory in which the kernel finds them."""

import copy
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

import analytic
from analytic import AnalyticInputError, Block, Harmonic, Keywords, Options, Problem, simulate, solve
from analytic.kernel import records
from analytic.kernel.records import PARAMS, TASK, layout, packing, row
from analytic.problem import encode, encode_base, encode_motion
from analytic.solver import prepare
from tests.analytic.paestum import PEDESTAL, STATUE

MOTION = Harmonic(3.0, 2.0)


def test_the_keywords_are_the_fields_of_the_problem_and_its_options() -> None:
    named = {item.name: item.default for item in (*fields(Problem), *fields(Options))}
    assert set(Keywords.__annotations__) | {"block", "motion_x", "motion_z"} == set(named)


def test_a_problem_is_solved_as_its_keywords_are() -> None:
    told = simulate(STATUE, MOTION, pedestal=PEDESTAL, floor_static=0.2, floor_kinetic=0.15, duration_s=2.0, dt_s=0.01)
    problem = Problem(STATUE, MOTION, analytic.ZeroExcitation(), 2.0, PEDESTAL, 0.2, 0.15)
    stated = solve(problem, Options(dt_s=0.01))
    assert told.theta_rad.tobytes() == stated.theta_rad.tobytes()
    assert told.events == stated.events


def test_an_unknown_keyword_and_a_missing_duration_are_refused() -> None:
    with pytest.raises(TypeError, match="friction"):
        simulate(STATUE, MOTION, duration_s=1.0, friction=0.3)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="duration_s"):
        simulate(STATUE, MOTION)  # type: ignore[call-arg]


@pytest.mark.parametrize(
    ("wrong", "name"),
    [
        ({"duration_s": 0.0}, "duration_s"),
        ({"theta0_rad": 1.5}, "theta0_rad"),
        ({"statue_friction": -0.1}, "statue_friction"),
        ({"floor_static": 0.1, "floor_kinetic": 0.2}, "kinetic"),
        ({"dt_s": 0.0}, "dt_s"),
        ({"dt_s": float("nan")}, "dt_s"),
        ({"accuracy_rad": -1.0}, "accuracy_rad"),
        ({"step_cap_s": 0.0}, "step_cap_s"),
        ({"accuracy_rad": float("nan")}, "accuracy_rad"),
    ],
)
def test_wrong_numbers_are_named(wrong: dict[str, Any], name: str) -> None:
    given: dict[str, Any] = {"duration_s": 1.0} | wrong
    with pytest.raises(AnalyticInputError, match=name):
        simulate(STATUE, MOTION, **given)
    with pytest.raises(AnalyticInputError, match="mass_kg"):
        Block.rectangle(width_m=0.1, height_m=1.0, mass_kg=-1.0)


def test_the_everyday_names_of_motions_stay() -> None:
    assert analytic.Rest is analytic.ZeroExcitation
    assert analytic.Record is analytic.SampledAcceleration


@pytest.mark.parametrize("record", [records.Params, records.State, records.Results, records.Counts, records.Base])
def test_what_is_packed_is_what_numpy_and_the_compiler_read(record: type) -> None:
    kinds = layout(record)
    assert kinds.names is not None
    values = tuple(
        kinds[name].type(k % 2 if kinds[name] == np.bool_ else k + 1).item() for k, name in enumerate(kinds.names)
    )
    memory = bytearray(kinds.itemsize)
    packing(record).pack_into(memory, 0, *values)
    assert np.frombuffer(memory, kinds)[0].item() == values
    assert packing(record).unpack_from(memory) == values


def test_every_number_of_a_problem_reaches_the_kernel_by_its_name() -> None:
    params = encode(Problem(STATUE, MOTION, MOTION, 2.0, PEDESTAL, 0.2, 0.15), Options())
    given = np.array([row(params)], PARAMS)[0]
    for name in PARAMS.names or ():
        assert given[name] == getattr(params, name)


def test_what_is_packed_for_a_run_stands_where_the_compiler_reads_it() -> None:
    motions = (Harmonic(3.0, 2.0, phase_rad=0.5, ramp_s=0.2), analytic.Pulse("one_sine", 4.0, 1.0, 0.3))
    problem = Problem(STATUE, *motions, 2.0, PEDESTAL, 0.2, 0.15)
    task = prepare(problem, encode(problem, Options(dt_s=0.01)), 3)
    read = np.frombuffer(task.memory, TASK)[0]
    assert read["params"].item() == row(encode(problem, Options(dt_s=0.01)))
    assert read["base"].item() == row(encode_base(problem))
    for name, motion in zip(("motion_x", "motion_z"), motions, strict=True):
        assert read[name]["params"].item() == row(encode_motion(motion)[0])
    assert read["output"].item() == (task.history.ctypes.data, 201, task.events.ctypes.data, 3)
    state, results, counts = task.run()
    left = np.frombuffer(task.memory, TASK)[0]
    assert (left["state"].item(), left["counts"].item()) == (row(state), row(counts))
    assert results.peak_slip_m == left["results"]["peak_slip_m"] > 0.0


def test_a_copied_block_has_arrays_and_addresses_of_its_own() -> None:
    block = Block.rectangle(width_m=0.2, height_m=1.0)
    assert block.addresses == tuple(each.ctypes.data for each in (*block.arrays, block.stands_m))
    copied = copy.deepcopy(block)
    assert "addresses" not in vars(copied)
    assert "arrays" not in vars(copied)
    assert copied == block
    assert copied.addresses != block.addresses
