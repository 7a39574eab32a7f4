"""Exudyn's joint formulation: a connector with dry friction between outer and inner mass, by two laws."""

from typing import Any

import numpy as np

from engines.exudyn.bristle_state import bristles_at
from engines.exudyn.lane import ExudynLane
from engines.exudyn.law import bristle, zone
from engines.interface.presets import Option, Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray, checked_count

_SHARED_OPTIONS = {
    "units": Option("lane", "SI", "Tolerances are then relative to what moves, whatever its size."),
    "module": Option("fast", "checked", "The build without range checks needs a quarter less time."),
    "solver": Option("Newmark", "generalised alpha", "Accelerations then follow from the state: restarts are exact."),
    "relative_tolerance": Option(1e-10, 1e-8, "Newton residual over the first; a period then repeats to 1e-8."),
    "absolute_tolerance": Option(1e-13, 1e-10, "Newton residual in the units of the lane, where forces are small."),
    "smallest_step": Option(1e-6, 1e-8, "Over dt, not in seconds; adaptive steps fail below it."),
}

REGULARISED_TUNED = Preset(
    "Steps and proportional zone small enough that creep stays below what a transmittance shows.",
    {
        **_SHARED_OPTIONS,
        "substeps": Option(
            32, 1, "Steps inside each dt: the zone is as wide as they are long, and the error in proportion to it."
        ),
        "zone": Option(2.5e-4, 0.0, "frictionProportionalZone over s ω_r, with s the displacement scale of the drive."),
        "zone_per_kick": Option(
            0.5, 0.0, "Smallest frictionProportionalZone over F h / m_red, h the substep: in less, Newton may fail."
        ),
    },
    known_deviation=(
        "friction is proportional to the slip velocity within a zone: a stuck contact creeps, and the error is in"
        " proportion to the width of the zone, whatever the time step"
    ),
    law=zone,
    static_friction=True,
    split_tolerance=1e-9,
    varied={"zone": (1e-3, 4e-3, 16e-3)},
)

BRISTLE_TUNED = Preset(
    "Bristles as stiff as the step resolves, and one correction of the friction state a step.",
    {
        **_SHARED_OPTIONS,
        "substeps": Option(4, 1, "Steps inside each dt: reversals that graze are seen at the end of a step only."),
        "bristle_phase": Option(
            0.4, 0.0, "h √(k_s / m_red), and so stickingStiffness k_s; at 1.8 far cells err by 0.8 dB, at 0.6 by 0.5."
        ),
        "bristle_damping": Option(0.4, 0.0, "stickingDamping over 2 √(k_s m_red); more delays reversals, 0 rings."),
        "discontinuous_iterations": Option(
            1, 5, "Corrections of the friction state a step, whatever their error; 5 at coarse steps stall the orbit."
        ),
    },
    known_deviation=(
        "a stuck contact is a stiff spring that gives way by F / k_s, and sticks only from the end of a substep "
        "on: short sticks are missed or made up"
    ),
    law=bristle,
    static_friction=True,
    split_tolerance=1e-9,
)

_SHARED_DEFAULTS = {
    "units": Option("SI", "SI", "The chain in SI units."),
    "module": Option("fast", "checked", "Changes the cost only."),
    "solver": Option("generalised alpha", "generalised alpha", "Exudyn's own, of spectral radius 0.9."),
    "relative_tolerance": Option(1e-8, 1e-8, "Exudyn's own."),
    "absolute_tolerance": Option(1e-10, 1e-10, "Exudyn's own."),
    "smallest_step": Option(1e-6, 1e-8, "Over dt, not in seconds; met by no motion of a stable step."),
    "substeps": Option(1, 1, "One step inside each dt."),
}

# A restart has to find the accelerations anew, which generalised alpha carries from step to step: runs split inexactly.
REGULARISED_DEFAULT = Preset(
    "The solver with its own settings, and a proportional zone that a newcomer would write.",
    {
        **_SHARED_DEFAULTS,
        "frictionProportionalZone": Option(
            1e-3,
            0.0,
            "[m/s] Needed: without a zone or a bristle, friction jumps. Exudyn's own for spheres.",
        ),
    },
    known_deviation=(
        "friction is proportional to the slip velocity within a zone of 1e-3 m/s: a stuck contact creeps, "
        "whatever the time step"
    ),
    law=zone,
    static_friction=True,
    split_tolerance=1e-4,
)

BRISTLE_DEFAULT = Preset(
    "The solver with its own settings, and the bristle of Exudyn's own friction oscillator.",
    {
        **_SHARED_DEFAULTS,
        "stickingStiffness": Option(1e4, 0.0, "[N/m] Needed; the value of Exudyn's example of a friction oscillator."),
        "stickingDamping": Option(1e2, 0.0, "[N s/m] As there: a hundredth of the stiffness."),
        "discontinuous_iterations": Option(5, 5, "Exudyn's own."),
    },
    known_deviation="a stuck contact is a spring of 1e4 N/m, so soft that it gives way by as much as the chain moves",
    law=bristle,
    static_friction=True,
    split_tolerance=0.05,
)


STATIC_DECAY = 1e-3
"""Velocity of a slip at which what static friction is above kinetic friction has decayed to 1/e of it [m/s]: Exudyn's
own `exponentialDecayStatic`."""

STATIC_DECAY_PER_KICK = 0.04
"""The same of tuned bristles, over μ_k λ_N h / m_red: it is passed in a substep, and vanishes with the step."""


def proportional_zone(lane: Lane, cell: int, preset: Preset) -> float:
    """Zone [m/s] in which friction is not yet at its bound: as given, or so wide that it neither creeps nor rings."""
    if "frictionProportionalZone" in preset.options:
        return float(preset["frictionProportionalZone"])
    chain = lane.chain
    inertia = 1 / chain.outer_mass[cell] + 1 / chain.inner_mass[cell]
    held = lane.static_ratio * float(chain.friction_bound[cell])
    kick = held * inertia * lane.time_step / preset["substeps"]
    speed = lane.drive.displacement_scale(chain) * chain.resonator_frequency
    return max(preset["zone"] * speed, preset["zone_per_kick"] * kick)


class JointLane(ExudynLane):
    """Connectors whose friction at rest may be larger than in motion."""

    def _friction(self, cell: int, decay: float) -> dict[str, Any]:
        """Give kinetic friction, what static friction is above it, and the slip velocity at which it decays."""
        bound = float(self._chain.friction_bound[cell])
        return {
            "dynamicFrictionForce": bound,
            "staticFrictionOffsetForce": (self.lane.static_ratio - 1) * bound,
            "exponentialDecayStatic": decay,
        }


class RegularisedLane(JointLane):
    """Friction -F ġ_T / v_reg within |ġ_T| < v_reg, -F sign ġ_T beyond; static friction decays in as wide a zone."""

    def _connector(self, cell: int) -> dict[str, Any]:
        zone = proportional_zone(self.lane, cell, self._preset) / self._units.velocity
        return {**self._friction(cell, zone), "frictionProportionalZone": zone}


class BristleLane(JointLane):
    """Friction of a bristle, whose internal state is whether it slips and where its foot is.

    In a state it is, in SI units, for each contact the slip force [N] with the sign of the
    slip, 0 in stick; then for each contact the deflection of the bristle [m]. Deflections, unlike
    the positions of the feet, stay valid when a solver of periodic orbits moves all masses.
    """

    def _connector(self, cell: int) -> dict[str, Any]:
        from exudyn import itemInterface

        node = self._system.AddNode(
            itemInterface.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3)
        )
        return {
            "nodeNumber": node,
            **self._friction(cell, self._static_decay(cell)),
            "stickingStiffness": float(self._stiffness[cell]),
            "stickingDamping": float(self._damping[cell]),
        }

    def _static_decay(self, cell: int) -> float:
        """Velocity at which static friction decays, in the units of the lane: the default, or a part of a kick."""
        if "stickingStiffness" in self._preset.options:
            return STATIC_DECAY / self._units.velocity
        kick = self._chain.friction_bound[cell] / self._reduced_mass[cell] * self._time_step / self._substeps
        return STATIC_DECAY_PER_KICK * float(kick)

    @property
    def _stiffness(self) -> FloatArray:
        """Stiffness k_s of each bristle in the units of the lane."""
        if "stickingStiffness" in self._preset.options:
            unit = self._units.force / self._units.length
            return np.full(self._chain.cells, self._preset["stickingStiffness"] / unit)
        phase = self._preset["bristle_phase"] * self._substeps / self._time_step
        stiffness: FloatArray = phase**2 * self._reduced_mass
        return stiffness

    @property
    def _damping(self) -> FloatArray:
        """Dashpot beside each bristle in the units of the lane."""
        if "stickingDamping" in self._preset.options:
            unit = self._units.force / self._units.velocity
            return np.full(self._chain.cells, self._preset["stickingDamping"] / unit)
        damping: FloatArray = self._preset["bristle_damping"] * 2 * np.sqrt(self._stiffness * self._reduced_mass)
        return damping

    def _solver_settings(self) -> Any:
        settings = super()._solver_settings()
        # With none, Exudyn reports success and leaves the chain where it is.
        iterations = checked_count("discontinuous_iterations", self._preset["discontinuous_iterations"])
        settings.timeIntegration.discontinuous.maxIterations = iterations
        return settings

    def _set_friction_state(self, state: State, start: int) -> None:
        units = self._units
        stiffness, damping = self._stiffness * units.force / units.length, self._damping * units.force / units.velocity
        load = float(self.lane.loads(start, 1)[0])
        slip, deflection = bristles_at(state, self.lane, load, stiffness, damping)
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
