"""A lane with the normal direction of its contacts resolved, as a frictional system of all masses and contacts."""

import numpy as np

from reference_lcp import FrictionalStep, Lane


class ResolvedLane:
    """3n freedoms, u_1 … u_n, v_1 … v_n, y_1 … y_n [m], all zero at rest with closed contacts, and n contacts.

    The lane has a preload or none.
    """

    def __init__(self, lane: Lane):
        self.lane, n = lane, lane.chain.cells
        none, identity = np.zeros((n, n)), np.eye(n)
        self.freedoms, self.contacts = 3 * n, n
        self.mass_matrix = np.diag(
            np.concatenate([lane.chain.outer_mass, lane.chain.inner_mass, lane.chain.inner_mass])
        )
        self.normal_directions = np.vstack([none, none, identity])
        self.tangential_directions = np.vstack([-identity, identity, none])

    def step(self, time, position, velocity, time_step) -> FrictionalStep:
        chain, along, preload = self.lane.chain, 2 * self.contacts, self.lane.preload
        factor = 1.0 if preload is None else preload.factor(np.asarray(time))
        force = -self.normal_directions @ (chain.normal_force * factor)
        force[:along] -= chain.stiffness_matrix @ position[:along] + chain.damping_matrix @ velocity[:along]
        force[0] += float(self.lane.drive.load(chain, np.asarray(time)))
        return FrictionalStep(
            mass_matrix=self.mass_matrix,
            force=force,
            velocity=velocity,
            time_step=time_step,
            normal_directions=self.normal_directions,
            tangential_directions=self.tangential_directions,
            normal_gap=self.normal_directions.T @ position,
            relative_velocity=self.tangential_directions.T @ velocity,
            friction_coefficient=chain.friction_coefficient,
        )
