"""What the contract allows, and why."""

import math

from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD

STEPS = MINIMUM_STEPS_PER_PERIOD
"""Steps a period, the coarsest that the suite compares at."""

SINGLE = 2.0**-24
"""Largest rounding of one operation in single precision, as a part of its result."""

ROUND_OFF = {"double": 1e-9, "single": 8 * SINGLE}
"""Part by which a given number may differ after an engine has stored and rescaled it, by the engine's precision:
in single precision a force is stored, turned into an impulse, shared by two points of contact, added up, and
turned into a force again."""

BOUND_MARGIN = {"double": 1e-6, "single": 1e-6 + 8 * SINGLE}
"""Part by which a reported force may pass its bound: for double precision what the reading of stick and slip takes
for equal, far above the round-off of any solver; for single precision also the rounding of coefficient, force, time
step and impulse, and of their products."""

SINGLE_RESIDUAL, SUBSTEPS_RESIDUAL = 1e-5, 2e-5
"""Periodicity residuals that certify a steady state in single precision: of a scheme of steps, and of one of substeps.

Positions and velocities are rounded by 2^-24 of themselves in every step or substep, and roundings add up as the root
of their number: 1e-6 of the displacement scale or somewhat more over a period of 400, at a resonance to 9e-6; four
times as much over 6,400, as by Rapier's default at 1,600 steps. No mixing of iterates removes it.
"""

LINEAR_TOLERANCE_DB = 0.1
"""Of the frictionless and stuck limits at 400 steps: the scheme's own first-order error there is below 0.07 dB."""

DISTANCE_GROWTH = 2 * 2 * math.pi * 2.3 / STEPS
"""By which a first-order scheme may let the distance of two motions, or the energy of a free one, grow between
two steps, over the smallest so far: 2 Δt ω_max for η_max = 2.3, where the pass band of the chain ends."""

MOMENTUM_TOLERANCE = 0.01
"""Impulse and change of momentum over a period, over the largest momentum: at 1,600 steps the sum over the steps
is within a few thousandths of the integral."""

SLIDING = 0.1
"""Slower than this, over ω U0, a reversal of the slip may lie within the step."""

TRAJECTORY_TOLERANCE = {"double": 1e-12, "single": 3 * math.sqrt(40 * STEPS) * SINGLE}
"""Positions of engines that share the scheme over forty periods, over U0: round-off, for motions do not drift apart.

In single precision a step makes some three roundings of a displacement or a velocity of about U0 or U0 ω, each with
the standard deviation `SINGLE` / √3. Nothing but a damping of a hundredth takes them away again, so that those of
all steps add up as the root of their number; three standard deviations are allowed.
"""

FRICTION_TOLERANCE = {"double": 1e-9, "single": TRAJECTORY_TOLERANCE["single"] * 0.81 / 0.3 / 2 * STEPS / (2 * math.pi)}
"""Friction of engines that share the scheme, over its bound F: a difference of velocities over a time step, and so
less exact than positions. In a step in which a contact comes to rest, an error δ of its relative velocity, over U0 ω,
is one of δ U0 ω m / (2 dt) = δ (η_r² / 2) (k U0) STEPS / (2π) of the friction, with F = 0.3 k U0 and η_r = 0.9.
"""

CREEP = 10.0
"""What a preset's residual slip compliance may add to both, and to a normal force, as a multiple of it.

A stuck contact keeps that part of the velocity that friction takes from it in a step, at most F dt / m: over
half a period that is far less than that part of U0. Friction lacks the same part, and half a dozen neighbours
pass it on.
"""

SAME_CHAIN = 0.5
"""Of positions over a period that begins at rest, over U0, at (0.3, 0.9): without any friction they differ from the
reference's by 0.41, with friction that never slips by 0.46, and with one in between by less."""

PULSE_TOLERANCE = 2 * math.pi / STEPS
"""Of positions under a pulse of the base, over U0, for an engine with its own scheme: U0 ω_r dt, which the base moves
in a step. A load that is a step late, or held for one, is within; a load of another course in time is not.
"""

SCHEME_TOLERANCE_DB = 0.02
"""Largest difference of transmittance between engines that share the Euler scheme, at equal time step [dB].

They solve the same equations: what is left is how hard the engine's friction constraint is. The
softest of them creeps at 1e-4 of the free acceleration times the step, which shifts figure 3 by
less than half of this.
"""

CONVERGED_TOLERANCE_DB = 0.25
"""Largest difference from the converged reference for an engine with its own integrator [dB].

At 400 steps a period the reference's own first-order error reaches 0.2 dB on the steepest flanks;
an engine that is no further off resolves friction as well as the scheme does.
"""

MEETING_STEPS = 2
"""Steps by which the time in the air may differ from the exact one in a cycle: lift-off and landing are met to one."""

SHORT_FLIGHT = 2 * math.pi / STEPS
"""Of the largest gap over N0 / (m Ω²): Ω Δt, as if lift-off began with the velocity N0 Δt / m of one step."""
