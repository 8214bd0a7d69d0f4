"""What Bullet's solver is told: every parameter of a world, and what the length of a step or a rest asks of it."""

from __future__ import annotations

from typing import Final

import pybullet

from harness.engines.pybullet.settings import BulletSettings

MIRRORED_RESIDUAL: Final = 1e-2
"""Share of a level's residual in a mirrored world: started from the last step's impulses the solver iterations get there soon."""
RESTING_RESIDUAL: Final = 1e-4
"""Share of it for bodies that rest one on the other: what the iterations leave of a step there adds up to a creep that goes with
the square root of the residual (6e-7 m a minute at 4 ms; 6e-5 without it), and they need as many as"""
RESTING_ITERATIONS: Final = 2000
"""this (docs/engines.md)."""
SHORT: Final = 0.1
"""Share of a step below which nothing is taken back of what a standing foot has crept along: it holds an impact."""
NO_RESTITUTION_BELOW_M_S: Final = 1e9
"""Every contact is slower than this, so none bounces."""


class Solver:
    """Parameters of one world's solver."""

    def __init__(self, settings: BulletSettings, client: int, *, mirrored: bool) -> None:
        self.settings, self.client, self.mirrored, self.resting = settings, client, mirrored, False
        self.length_s = settings.dt_s

    def begin(self) -> None:
        """Send every parameter: some are global to the process and outlive a client."""
        pybullet.setPhysicsEngineParameter(
            numSubSteps=0,
            contactBreakingThreshold=self.settings.reach,
            enableConeFriction=int(self.settings.cone_friction),
            globalCFM=0.0,
            contactSlop=0.0,
            restitutionVelocityThreshold=NO_RESTITUTION_BELOW_M_S,
            deterministicOverlappingPairs=1,
            enableFileCaching=0,
            constraintSolverType=pybullet.CONSTRAINT_SOLVER_LCP_SI,
            physicsClientId=self.client,
        )
        self.set_length(self.settings.dt_s)

    def rest(self, resting: bool) -> None:
        """Whether the steps that follow are of bodies at rest."""
        if resting != self.resting:
            self.resting = resting
            self.set_length(self.settings.dt_s)

    def set_length(self, step_s: float) -> None:
        """The length of the steps that follow; what is a share of a penetration for each step goes with it.

        A step of another length than the level's holds an event, whose impulses are solved more tightly.
        """
        self.length_s = step_s
        s, erp = self.settings, self.settings.erp_for(step_s)
        tight, share = step_s != s.dt_s, step_s / s.dt_s
        iterations, residual = s.iterations, s.residual_for()
        if tight or self.mirrored:
            iterations = max(iterations, s.event_iterations)
            residual *= MIRRORED_RESIDUAL if self.mirrored else s.event_residual
        elif self.resting:
            iterations, residual = max(iterations, RESTING_ITERATIONS), RESTING_RESIDUAL * residual
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=step_s,
            erp=erp,
            contactERP=erp,
            frictionERP=share**2 if share > SHORT else 0.0,
            numSolverIterations=iterations,
            solverResidualThreshold=residual,
            # Impulses of an event are no guess for the next step's, nor the last step's for an event's.
            warmStartingFactor=0.0 if tight else 1.0,
            physicsClientId=self.client,
        )
