"""Exudyn's joint formulation: a connector with dry friction between outer and inner mass, by two laws."""

from abc import abstractmethod
from functools import cached_property
from typing import Any

import numpy as np

from multibody_xval.engines.exudyn.simulation import ExudynLane
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray, checked_count

STATIC_DECAY = 1e-3
"""Velocity of a slip at which what static friction is above kinetic friction has decayed to 1/e of it [m/s]: Exudyn's
own `exponentialDecayStatic`."""

STATIC_DECAY_PER_KICK = 0.04
"""The same of tuned bristles, over μ_k λ_N h / m_red: it is passed in a substep, and vanishes with the step."""


class JointLane(ExudynLane):
    """Connectors whose friction at rest may be larger than in motion."""

    @abstractmethod
    def _connector(self, cell: int) -> dict[str, Any]:
        """Parameters of the friction connector of one cell, in the units of the lane."""

    def _friction(self, cell: int, decay: float) -> dict[str, Any]:
        """Give kinetic friction, what static friction is above it, and the slip velocity at which it decays."""
        bound = float(self._chain.friction_bound[cell])
        return {
            "dynamicFrictionForce": bound,
            "staticFrictionOffsetForce": (self.lane.static_ratio - 1) * bound,
            "exponentialDecayStatic": decay,
        }

    def _assemble(self) -> None:
        from exudyn import itemInterface

        system, chain = self._system, self._chain
        still = [0.0] * (2 * chain.cells)
        node = system.AddNode(itemInterface.NodeGenericODE2(
            numberOfODE2Coordinates=len(still), referenceCoordinates=still,
            initialCoordinates=still, initialCoordinates_t=still,
        ))  # fmt: skip
        system.AddObject(itemInterface.ObjectGenericODE2(
            nodeNumbers=[node], massMatrix=chain.mass_matrix,
            stiffnessMatrix=chain.stiffness_matrix, dampingMatrix=chain.damping_matrix,
        ))  # fmt: skip
        markers = [
            system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=node, coordinate=i))
            for i in range(len(still))
        ]
        connectors = [
            system.AddObject(
                itemInterface.ObjectConnectorCoordinateSpringDamperExt(
                    markerNumbers=[markers[cell], markers[chain.cells + cell]], **self._connector(cell)
                )
            )
            for cell in self._rubbing.tolist()
        ]
        self._add_load(markers[0])
        self._add_sensors([node], connectors)
        system.Assemble()


class RegularisedLane(JointLane):
    """Friction -F ġ_T / v_reg within |ġ_T| < v_reg, -F sign ġ_T beyond; static friction decays in as wide a zone."""

    def _connector(self, cell: int) -> dict[str, Any]:
        zone = float(zone_widths(self.lane, self._preset)[cell]) / self._units.velocity
        return {**self._friction(cell, zone), "frictionProportionalZone": zone}


class BristleLane(JointLane):
    """Friction of a bristle, whose internal state is whether it slips and where its foot is.

    In a state it is, in SI units, for each contact the slip force [N] with the sign of the
    slip, 0 in stick; then for each contact the deflection of the bristle [m]. Deflections, unlike
    the positions of the feet, stay valid when a solver of periodic orbits moves all masses.
    """

    @cached_property
    def _bristles(self) -> tuple[FloatArray, FloatArray]:
        return bristles(self.lane, self._preset, self._units)

    def _connector(self, cell: int) -> dict[str, Any]:
        from exudyn import itemInterface

        data = itemInterface.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3)
        stiffness, damping = self._bristles
        return {
            "nodeNumber": self._system.AddNode(data),
            **self._friction(cell, float(static_decays(self.lane, self._preset, self._units)[cell])),
            "stickingStiffness": float(stiffness[cell]),
            "stickingDamping": float(damping[cell]),
        }

    def _solver_settings(self) -> Any:
        settings = super()._solver_settings()
        # With none, Exudyn reports success and leaves the chain where it is.
        iterations = checked_count("discontinuous_iterations", self._preset["discontinuous_iterations"])
        settings.timeIntegration.discontinuous.maxIterations = iterations
        return settings

    def _set_friction_state(self, state: State, start: int) -> None:
        units, (stiffness, damping) = self._units, self._bristles
        load = float(self.lane.loads(start, 1)[0])
        si = stiffness * units.force / units.length, damping * units.force / units.velocity
        slip, deflection = bristles_at(state, self.lane, load, *si)
        outer, inner = np.split(state.positions[0], 2)
        foot = (inner - outer - deflection) / units.length
        data = np.stack([slip / units.force, foot, np.zeros_like(slip)], axis=1)[self._rubbing]
        self._system.systemData.SetDataCoordinates(data.ravel(), self._exudyn.ConfigurationType.Initial)

    def _friction_state(self) -> FloatArray:
        current = self._exudyn.ConfigurationType.Current
        data = np.array(self._system.systemData.GetDataCoordinates(current)).reshape(-1, 3)
        outer, inner = np.split(np.array(self._system.systemData.GetODE2Coordinates(current)), 2)
        slip, deflection = np.zeros((2, self._chain.cells))
        slip[self._rubbing] = data[:, 0]
        deflection[self._rubbing] = (inner - outer)[self._rubbing] - data[:, 1]
        return np.concatenate([slip * self._units.force, deflection * self._units.length])


def reduced_mass(chain: Chain) -> FloatArray:
    """Give m_red of every cell, shape (n,)."""
    return 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)


def zone_widths(lane: Lane, preset: Preset) -> FloatArray:
    """Give the zones [m/s], shape (n,): as given, or so wide that friction neither creeps nor rings."""
    chain = lane.chain
    if "frictionProportionalZone" in preset.options:
        return np.full(chain.cells, preset["frictionProportionalZone"])
    speed = lane.drive.displacement_scale(chain) * chain.resonator_frequency
    # Slip velocity that the bound of friction at rest makes in a substep.
    kick = lane.static_ratio * chain.friction_bound * (1 / chain.outer_mass + 1 / chain.inner_mass)
    kick = kick * lane.time_step / preset["substeps"]
    return np.maximum(preset["zone"] * speed, preset["zone_per_kick"] * kick)


def static_decays(lane: Lane, preset: Preset, units: Units) -> FloatArray:
    """Give velocities at which static friction of bristles decays, shape (n,): the default, or a part of a kick."""
    if "stickingStiffness" in preset.options:
        return np.full(lane.chain.cells, STATIC_DECAY / units.velocity)
    chain, time_step = units.scaled(lane.chain), lane.time_step / units.time
    return STATIC_DECAY_PER_KICK * (chain.friction_bound / reduced_mass(chain) * time_step / preset["substeps"])


def bristles(lane: Lane, preset: Preset, units: Units) -> tuple[FloatArray, FloatArray]:
    """Give stiffness k_s of each bristle and the dashpot beside it, shape (n,) each, in `units`.

    They are given, or such that a bristle's oscillation has a phase in a substep, and a damping ratio.
    """
    if "stickingStiffness" in preset.options:
        stiffness = preset["stickingStiffness"] / (units.force / units.length)
        damping = preset["stickingDamping"] / (units.force / units.velocity)
        return np.full(lane.chain.cells, stiffness), np.full(lane.chain.cells, damping)
    mass, time_step = reduced_mass(units.scaled(lane.chain)), lane.time_step / units.time
    stiffnesses = mass * (preset["bristle_phase"] * preset["substeps"] / time_step) ** 2
    return stiffnesses, 2 * preset["bristle_damping"] * np.sqrt(stiffnesses * mass)


def bristles_at(
    state: State, lane: Lane, load: float, stiffness: FloatArray, damping: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Give slip forces, 0 in stick, and deflections of the bristles of a state, shape (n,) each.

    Without an internal state a bristle holds the load that it meets: one that started unloaded would let go of a stuck
    contact and ring. A search of periodic orbits mixes slip forces of several periods: the nearest of 0 and ±μN is
    meant.
    """
    chain = lane.chain
    if state.internal_state is not None:
        slip, deflection = np.split(state.internal_state[0], 2)
        slips = np.abs(slip) > chain.friction_bound / 2
        return np.where(slips, np.copysign(chain.friction_bound, slip), 0.0), deflection
    position, velocity = state.positions[0], state.velocities[0]
    pull = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
    pull[0] += load
    outer, inner = np.split(pull / np.diag(chain.mass_matrix), 2)
    holding = (inner - outer) / (1 / chain.outer_mass + 1 / chain.inner_mass)
    force = holding + damping * (chain.contact_directions.T @ velocity)
    slips = np.abs(force) >= lane.static_ratio * chain.friction_bound
    return np.where(slips, np.copysign(chain.friction_bound, force), 0.0), np.where(slips, 0.0, holding / stiffness)
