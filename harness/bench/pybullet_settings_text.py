"""The words of docs/pybullet_contact.md; its numbers are measured by `settle`."""

from __future__ import annotations

from typing import Final

TEXT: Final = """# The base contact in pybullet: what was chosen, and on what evidence

`python -m harness.bench.pybullet_settings` writes this page. {about}

A plane touches a rigid body only at vertices of its convex hull. So the statue stands on one small sphere at each vertex of
its hull that a lean of up to 1.5 rad can bring down (all of them where there is a wall), the pedestal on one at each lower
corner, and floor, wall and pedestal's top are planes, lowered by the spheres' radius: a sphere's centre is the vertex itself,
and the contact of a sphere with a plane is a closed form with one fixed point. What is left of the radius r is a rolling of
r·θ (1 nm · θ).

It stops serving where an edge, not a vertex, is touched: the pedestal's edge against the statue; and the top's plane has no
end, while the pedestal has. Both need some part of the statue to come down to the height of the pedestal's top beside it.
Throughout the run it is looked at whether that can happen before the next look, twenty steps ahead at most. Before it does,
the same state goes on in a world with edges. There the pedestal has a box beside its plane, and the statue its hull or its
convex parts, whichever the scene needs (docs/meshes.md), each drawn 1.1 mm inside (`full_shape_from_s`, `full_shape` in the
record). Feet over the top meet the plane and not the box; feet beside it, hull and parts meet the box and not the plane;
where a foot comes over an edge the world is made anew. While the edges may be met no event is located. With the skip
`base_only` off this world is there from the start.

## Bodies (0.25 ms)

{head}
{contacts}

Boxes and hulls touch at points that the engine seeks anew in each step. They wander, the sweeps of the solver leave a yaw,
and the body walks. A sphere against a box is sought by iteration (GJK) too and is now and then missed for one step when the
gap is nearly zero, the more often the better the equations are solved (49 of 4100 steps at a residual of 1e-14, 0.334 g, 3
Hz, μ_s 0.20), which lets a pedestal slip that static friction just holds (0.017 rad off); against a plane it never was. So
even in a world with edges no foot stands on the box. While they did, this world was 4e-4 to 1.5e-2 rad off on scenes in which
it touches nothing, with no gain from finer steps; it is off by 1e-6 to 6e-5 rad at 0.25 ms now
(`tests/harness/engines/pybullet/test_full_shape.py`). A hull on an edge still is sought by iteration: a base that overhangs
is off by 2e-3 rad.

## One setting changed at a time (0.25 ms, on the pedestal)

{head}
{variations}

An impact that falls inside a step would be off by up to a step. It is therefore met at its instant. Short steps take the foot
nearly to its support; before each of them the statue is lowered by what its feet have drifted off the support, because the
engine lets a gap close at the speed that closes it within the step, whatever its length. A last one leaves it a little above
and brings the velocities to the instant; the places then go on by these velocities, and the velocity turns on with the arm of
the foot that stands. The impact is a step in which nothing
pulls, solved a thousand times more tightly, of which only the velocities are kept: it takes no time. A prescribed impact is put
in its place. The step in which the pedestal halts ends there, one in which static friction gives way acts with
the coefficient of its mean: static friction's force up to the instant that the two steps before foretell, kinetic after it. A
penetration is corrected in proportion to the step, or short steps would throw the bodies up. The residual is the squared
change of velocity at which the sweeps end, at 0.25 ms; it scales with the square of the step. The order of bodies changes how
fast the sweeps converge, not what they converge to: with a residual of 0 both orders agree. So it is a probe of the finest rung
alone.

A foot that comes down in a short swing gathers speed in the half step by which velocities are older than places: its instant is
foreseen with what it gained in the last step, and it is set back so far that the velocity of the instant takes it down (short of
that it would be stopped at the present one). A swing shorter than eight steps, as its first part shows its forces, is followed in
five parts, until one is longer, or shorter than a quarter of a step and left to die out. So a rattle, rocking of 1e-5 rad in
swings of some milliseconds from which a statue rises (docs/pymunk.md, "Rattling"), is followed by steps of that length; before,
it ended at an impact below 0.003 rad/s or a swing of three steps. `python -m harness.bench.micro_rocking pybullet` gives the
largest error in 3 s against the analytic model, rad:

| seed of `harness.bench.coverage` | 4 ms | 2 ms | 1 ms | 0.5 ms | 0.25 ms | before, 4 ms | 1 ms | 0.25 ms |
|---|---|---|---|---|---|---|---|---|
| 10129 | 1.0e-4 | 3.6e-5 | 1.2e-5 | 2.1e-6 | 1.0e-6 | 1.0e-1 | 1.0e-1 | 3.7e-6 |
| 20399 | 1.9e-4 | 2.0e-5 | 7.9e-6 | 3.2e-6 | 2.8e-6 | 3.2e-3 | 3.3e-3 | 1.7e-5 |
| 20809 | 2.8e-5 | 4.4e-5 | 2.2e-5 | 1.8e-6 | 8.1e-7 | 8.7e-3 | 8.7e-3 | 8.7e-3 |
| 20844 | 3.1e-3 | 8.8e-4 | 3.6e-4 | 1.2e-4 | 4.7e-6 | 2.2e-1 | 2.2e-1 | 1.3e-1 |
| 20866 | 3.4e-4 | 1.0e-4 | 1.2e-5 | 2.1e-6 | 8.6e-7 | 3.3e-4 | 3.0e-4 | 3.5e-5 |

While the pedestal tips nothing is located: the engine makes whole steps, and the record says from when, for how long
in all and why (`plain_from_s`, `plain_for_s`, `plain_because`, from a tilt of 10⁻³ rad on). The pedestal's own impacts on
the floor are met by no shorter step, and with it moving the
statue's are not what the layer takes them for. On random scenes (seeds 0 to 15 of `harness.bench.tipping`, light, narrow
and tall pedestals; 13 of them away from the pedestal's edge) events located in the tipping put the rotation up to 2.1e-2 rad
off the finest plain run at 0.25 ms; now it is off by 4.1e-5 to 2.8e-3 rad, as plain steps are. To 1e-3 rad the stated
uncertainty held on 16 of 18 with 405 000 steps, and holds on 18 with 165 000.

A step moves a body along the tangent of the circle on which it turns about its foot, off the foot's place by ω²·r·dt²/2. Across
the support Bullet takes that back in the next step, so that its velocity is the chord's; along it friction asks for none, and
the velocity is the tangent's: wrong by half a step's turning, which is of first order in everything that follows. Bullet's
friction anchors take it back there too: a contact keeps the place where it was made, and a whole step returns to it (a shorter
one by its square, an impact not at all). With it free rocking over four impacts is off by 2e-5, 9e-6, 3e-7 and 1e-7 rad at 4, 2,
1 and 0.5 ms, without it by 3.6e-4, 1.9e-4, 1.0e-4 and 5e-5 (`tests/harness/engines/pybullet/test_order.py`). An anchor keeps its
sphere's point of contact while that turns, which lifts it by r·θ²/2: hence spheres of 1 nm. A foot that slides has no place to
come back to: when the statue's friction passes half of its limit its feet have no anchors until it is below 0.35 of it.
Against a box, whose points of contact wander, there are none.

A scan rests on many vertices of one plane. Where those that have left it stay contacts, if only of no force, the sweeps over
them do not reach their end, and the statue comes up a little too early: 5e-4 rad at the end of a scan's first swing at 4 ms. So a
vertex is a contact up to a gap of a hundred-thousandth of the body's radius (`reach`). A standing foot must stay one, and a
step takes it off by half the square of the angle turned: what turns faster has its contacts made anew with a wider reach.

A scene that is its own mirror image across the rocking plane (no motion across it, base and inertia the same on both sides)
is computed by half (skip `mirror`): one foot for each pair, and bodies that turn in the plane alone. Such bodies are Bullet's
rigid bodies, whose sweeps begin from the impulses of the last step, not from none, and go on to a residual a hundredth of the
rung's. It leaves the plane by nothing, and at rest it does not creep on any rung (`python -m harness.bench.memory creep
pybullet`); the whole of a scene, whose sweeps end early, still creeps by some 1e-4 m a minute. A rigid body takes over an
inertia that was set only when a step has moved it: without one such step, far above everything, its first step acts with the
inertia of its shape. In a world with edges such a scene keeps all its feet, and its bodies turn in the plane alone. Of the
whole of a scene the pedestal's plane is a link of its own: in one shape with its spheres the sweeps left more of a turn about
the vertical, and seed 103 of `harness.bench.coverage` was 9e-4 rad off (2.8e-6 now).

## The ladder, on the pedestal

{head}
{on_pedestal}

## The ladder, on the floor

{head}
{on_floor}

## Two coefficients of friction, prescribed ratios (μ_k = 0.15, on the pedestal; cost of the whole run)

{head}
{conditions}

## What a rung is expected to err by

Every rung's largest error, rad, by `python -m harness.bench.pybullet_levels`: these cases, with two coefficients of friction and
with imposed ratios too, and the bench's standard set, each by half and by the whole.

| | 4 ms | 2 ms | 1 ms | 0.5 ms | 0.25 ms | 0.125 ms | residual 0 |
|---|---|---|---|---|---|---|---|
| planar, on the floor | 3.1e-4 | 1.3e-4 | 2.7e-5 | 7.4e-6 | 6.2e-6 | 2.8e-6 | 7.6e-7 |
| planar, on a pedestal | 5.8e-4 | 3.5e-4 | 1.2e-4 | 4.0e-5 | 3.8e-5 | 1.7e-5 | 4.3e-6 |
| a scan, or motion across the plane | 3.0e-4 | 1.2e-4 | 5.0e-5 | 2.1e-5 | 3.4e-5 | 2.1e-5 | 5.6e-5 |

On the floor El Centro and the pulse decide, on a pedestal 0.334 g at 3 Hz with two coefficients: friction stands near its
static limit there for some steps, and from 2 ms on it is the whole of the scene, whose sweeps end early, that errs more than
its half, which is off by 1.1e-5 rad at 2 ms.

What a rung is expected to err by is the least uncertainty that a run on it states, and decides where a climb to an accuracy
begins (`ON_FLOOR_RAD`, `ON_PEDESTAL_RAD`, `ACROSS_RAD` in `adapter.py`). It is the largest of a rung and those
finer, rounded up, and on the floor twice that and more: with the plain values two of the thirty random scenes from seed 18000 of
`harness.bench.coverage`, run to 1e-4 rad, were off by 1.01 and 1.28 times what they stated; with these one is, by 1.04. To 1e-3
rad the statement holds on 60 of 60 (`python -m harness.bench.coverage pybullet 18000 60`), for 134 runs of 210 448 steps.

## Cost of the loop over a bare one (gravity, step, read-outs), µs per step

| | bare | whole loop | more |
|---|---|---|---|
{overhead}
"""
