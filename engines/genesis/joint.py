"""Genesis's joint formulation: the dry friction of a slide joint between outer and inner mass."""

import numpy as np

from engines.genesis.law import joint_friction
from engines.genesis.scene import IMPEDANCE, PRECISION, Scene, chain_model, constraint_parameters
from engines.genesis.simulation import GenesisSimulation
from engines.interface.presets import NormalForce, Option, Preset
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

JOINT_TUNED = Preset(
    "One step of Newton, then one sweep without softness: friction stops a contact within a step, as in equation (5).",
    {
        "precision": PRECISION,
        "units": Option("lane", "SI", "Numbers near one, and time steps for the unit of time: a scene has one step."),
        "integrator": Option("Euler", "approximate_implicitfast", "Velocities first, then positions."),
        "iterations": Option(1, 25, "The sweep after it decides what friction is."),
        "noslip_iterations": Option(
            1, 0, "One sweep without softness: frictions do not touch each other's masses, so that it is exact."
        ),
        "time constant in steps": Option(
            2 / IMPEDANCE[1], None, "Of solref: the reference acceleration is -ġ_T / dt, and stops a stuck contact."
        ),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)

JOINT_DEFAULT = Preset(
    "A joint's frictionloss, and Genesis's own options.",
    {
        "precision": PRECISION,
        "units": Option(
            "steps", "SI", "A scene has one time step: masses, forces and accelerations keep their numbers in SI units."
        ),
        "integrator": Option("approximate_implicitfast", "approximate_implicitfast", "Genesis's own."),
        "iterations": Option(25, 25, "Genesis's own."),
        "noslip_iterations": Option(0, 0, "Genesis's own: a stuck contact creeps."),
        "time constant": Option(0.01, 0.01, "Genesis's own, of solref [s], whatever the time step."),
    },
    known_deviation=(
        "friction is a soft constraint with a time constant, whatever the time step: a stuck contact comes to rest "
        "with one of 5.3 ms and creeps, and a finer step does not help"
    ),
    law=joint_friction,
    split_tolerance=1e-9,
    normal_force=NormalForce.MODULATED,
)


class JointSimulation(GenesisSimulation):
    """Lanes with a dry friction in every joint of an inner mass."""

    def _units_of(self, lane: Lane) -> Units:
        if self._preset["units"] == "steps":
            return Units(length=lane.time_step**2, mass=1.0, time=lane.time_step)
        return Units.in_steps(self._preset["units"], lane)

    def _new_scene(self, masses: FloatArray) -> Scene:
        cells = self.lanes[0].chain.cells
        scene = Scene(chain_model(cells)[0], masses, 1.0, self._preset)
        scene.set_joint_constraints(
            np.stack([constraint_parameters(self._time_constant(lane), 1.0, IMPEDANCE) for lane in self.lanes])
        )
        scene.set_bounds(np.stack([chain.friction_bound for chain in self._chains]))
        return scene

    def _time_constant(self, lane: Lane) -> float:
        """Give the time constant of friction in time steps; Genesis takes at least two."""
        if "time constant" not in self._preset.options:
            steps: float = self._preset["time constant in steps"]
            return steps
        return max(2.0, self._preset["time constant"] / lane.time_step)

    def _before_step(self, step: int) -> None:
        if any(lane.preload is not None for lane in self.lanes):
            bounds = [
                chain.friction_coefficient * lane.preloads(step, 1)[0] / units.force
                for lane, chain, units in zip(self.lanes, self._chains, self._units, strict=True)
            ]
            self._scene.set_bounds(np.stack(bounds))
