"""A chain with Exudyn's bristles as a model."""

import numpy as np

from engines.exudyn.bristle_state import bristles_at
from engines.exudyn.generalised_alpha import GeneralisedAlphaLane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray


class BristleModelLane(GeneralisedAlphaLane):
    """Contacts keep the force of their slip and the place of their foot; states hold the deflection instead."""

    def _contacts_at(self, state: State, load: float) -> FloatArray:
        slip, deflection = bristles_at(state, self.lane, load, self._numbers.first, self._numbers.second)
        return np.vstack([slip, self._elongation(state.positions[0]) - deflection])

    def _internal_state(self, positions: FloatArray, contacts: FloatArray) -> FloatArray:
        return np.concatenate([contacts[0], self._elongation(positions) - contacts[1]])[None]

    def _elongation(self, positions: FloatArray) -> FloatArray:
        elongation: FloatArray = self.lane.chain.contact_directions.T @ positions
        return elongation
