"""An engine in a package of its own: the step of equation (5) in NumPy, with the friction of each cell clipped."""

import numpy as np

import multibody_xval as xval

OPTIONS = {"compliance": xval.Option.own(1e-3, "part of the slip velocity that a stuck contact keeps per step [-]")}
TUNED = xval.Preset(
    "Contacts stick without any creep.",
    OPTIONS,
    changes={"compliance": (0.0, "a contact that its friction can hold does not move")},
    shares_scheme=True,  # its step is the reference's own
    judged=("chain", "blocks"),  # its errors fail a report
)
DEFAULT = xval.Preset(
    "As the engine comes.",
    OPTIONS,
    residual_slip_compliance=1e-3,
    known_deviation="a stuck contact creeps by a thousandth of what it would slip",
)


class Tiny(xval.Engine):
    name = "tiny"
    capabilities = xval.Capabilities(
        title="Tiny",
        package="tiny-engine",
        licence="MIT",
        friction_law=xval.FrictionLaw.COULOMB,
        presets={xval.Formulation.JOINT: {"tuned": TUNED, "default": DEFAULT}},
    )

    def version(self):
        return "1.2.3"

    def unavailable_reason(self):
        return None  # or why it cannot be used here

    def _build(self, lanes, formulation, preset):
        return xval.SequentialSimulation([TinyLane(lane, preset) for lane in lanes])


class TinyLane(xval.LaneModel):
    """One chain under one drive."""

    def __init__(self, lane, preset):
        self.lane, self.sticks = lane, 1 - preset["compliance"]

    def run(self, state, start, steps):
        """Advance from a state at the step `start`; gives a row per step."""
        x, v, rows = state.positions[0].copy(), state.velocities[0].copy(), []
        for load in self.lane.loads(start, steps):
            v, friction = self.end_velocity(x, v, load)
            x = x + self.lane.time_step * v
            rows.append((x, v, friction))
        positions, velocities, friction = (np.array(column) for column in zip(*rows, strict=True))
        normal_force = self.lane.preloads(start, steps)
        return xval.Trajectory(self.lane.times(start, steps), positions, velocities, friction, normal_force)

    def end_velocity(self, x, v, load):
        """Give the velocities after a step, and the friction on the inner masses [N]."""
        chain, dt, mass = self.lane.chain, self.lane.time_step, np.diag(self.lane.chain.mass_matrix)
        force = -chain.stiffness_matrix @ x - chain.damping_matrix @ v
        force[0] += load
        free = v + dt * force / mass
        reduced_mass = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)
        sticking = -self.sticks * reduced_mass * (chain.contact_directions.T @ free) / dt
        friction = np.clip(sticking, -chain.friction_bound, chain.friction_bound)
        return free + dt * (chain.contact_directions @ friction) / mass, friction
