"""Drake's joint formulation: actuators that hold the inner masses, with at most the friction bound."""

from typing import Any

import numpy as np

from engines.drake.diagram import Mechanism, joint_numbers
from engines.drake.lane import SHARED_DEFAULT_OPTIONS, SHARED_TUNED_OPTIONS, DrakeLane, add_slider, set_options
from engines.drake.law import actuator, near_rigid_actuator
from engines.interface.presets import Option, Preset
from reference_lcp.validation import FloatArray

JOINT_TUNED = Preset(
    "Actuators whose gain of velocity is beyond what Drake resolves in a step: then it takes the largest that it does.",
    {
        **SHARED_TUNED_OPTIONS,
        "d": Option(
            1e6,
            0.0,
            "Gain of velocity over m_red / δt. A stuck contact creeps with λ_T / d; Drake cuts d off above "
            "4e3 m_i / δt, so that every larger one acts alike.",
        ),
    },
    known_deviation=(
        "dashpots act with the velocity at the end of a step; a stuck contact is a damper as strong as Drake's "
        "near-rigid limit lets it be, and creeps with λ_T / d, a thousandth of that"
    ),
    law=near_rigid_actuator,
    split_tolerance=1e-12,
)

JOINT_DEFAULT = Preset(
    "Actuators with a gain that a newcomer would write, in SI units.",
    {
        **SHARED_DEFAULT_OPTIONS,
        "PdControllerGains.d": Option(1e3, 0.0, "[N s/m] Needed: a joint of Drake has no dry friction of its own."),
    },
    known_deviation="a stuck contact is a damper of 1e3 N s/m and creeps with λ_T / d, whatever the time step",
    law=actuator,
    split_tolerance=1e-12,
)


class DrakeJointLane(DrakeLane):
    """Friction −d ġ_T, implicit in the velocity at the end of the step, and cut off at the bound.

    A stuck contact creeps with λ_T / d. Drake limits d to 4π² m_i / (β² δt), with β = 0.1: what is stiffer
    would not be resolved by its solver in a step.
    """

    def _mechanism(self, builder: Any) -> Mechanism:
        from pydrake.multibody.plant import MultibodyPlant

        chain = self._chain
        plant = builder.AddSystem(MultibodyPlant(self._time_step))
        set_options(plant, self._preset)
        parent = plant.world_body()
        for cell in range(chain.cells):
            spring = chain.chain_stiffness[cell], chain.chain_damping[cell]
            parent = add_slider(plant, f"outer {cell}", parent, chain.outer_mass[cell], spring)
            inner_spring = chain.inner_stiffness[cell], chain.inner_damping[cell]
            add_slider(plant, f"inner {cell}", parent, chain.inner_mass[cell], inner_spring)
        for cell in self._rubbing.tolist():
            self._add_actuator(plant, cell)
        plant.Finalize()
        return Mechanism(
            plant,
            outer=joint_numbers(plant, [f"outer {cell}" for cell in range(chain.cells)]),
            inner=joint_numbers(plant, [f"inner {cell}" for cell in range(chain.cells)]),
            across=np.zeros(0, dtype=np.intp),
            forces=self._armed(builder, plant) if self._rubbing.size else None,
            constant_force=np.zeros(2 * chain.cells),
        )

    def _add_actuator(self, plant: Any, cell: int) -> None:
        from pydrake.multibody.tree import PdControllerGains

        joint = plant.GetJointByName(f"inner {cell}")
        bound = float(self._chain.friction_bound[cell])
        actuator = plant.AddJointActuator(f"friction {cell}", joint, effort_limit=bound)
        actuator.set_controller_gains(PdControllerGains(p=0.0, d=self._gain(cell)))

    def _gain(self, cell: int) -> float:
        """Force over relative velocity in stick, in the plant's units."""
        if "PdControllerGains.d" in self._preset.options:
            return float(self._preset["PdControllerGains.d"])
        chain = self._chain
        reduced_mass = 1 / (1 / chain.outer_mass[cell] + 1 / chain.inner_mass[cell])
        return float(self._preset["d"] * reduced_mass / self._time_step)

    def _armed(self, builder: Any, plant: Any) -> Any:
        """Set rest as the target of the actuators, without which they do nothing; give the port of their forces."""
        from pydrake.multibody.tree import default_model_instance
        from pydrake.systems.primitives import ConstantVectorSource

        rest = builder.AddSystem(ConstantVectorSource(np.zeros(2 * self._rubbing.size)))
        instance = default_model_instance()
        builder.Connect(rest.get_output_port(), plant.get_desired_state_input_port(instance))
        return plant.get_net_actuation_output_port(instance)

    def _contact_forces(self, mechanism: Mechanism, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        friction = np.zeros((rows.shape[0], self._chain.cells))
        friction[:, self._rubbing] = rows * self._units.force
        return friction, self.lane.preloads(0, rows.shape[0])
