"""MuJoCo's springs that yield: in every cell one beside the inner spring, a Jenkins element with a memory."""

from typing import Any

from engines.interface.presets import Option, Preset
from engines.mujoco.model import DEFAULT_OPTIONS, TUNED_OPTIONS, add_chain, add_masses, new_spec, set_spring
from engines.mujoco.yielding_law import yielding_spring
from engines.mujoco.yielding_state import yield_stiffness
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane

YIELD = Preset(
    "A spring parallel to the inner one that yields at the friction bound, as stiff as the step resolves.",
    {
        **DEFAULT_OPTIONS,
        "units": Option("lane", "SI", "No number comes near MuJoCo's built-in smallest and largest ones."),
        "jacobian": TUNED_OPTIONS["jacobian"],
        "disable": TUNED_OPTIONS["disable"],
        "spring_phase": Option(
            1.0,
            0.0,
            "h √(k_s / m_red), and so stiffness k_s and springyield F / k_s: half of Euler's limit of stability.",
        ),
    },
    known_deviation=(
        "a stuck contact is a spring that gives way by F / k_s, without a dashpot: it rings, at velocities up to "
        "F h / (θ m_red)"
    ),
    law=yielding_spring,
    split_tolerance=1e-12,
    versions=">=4",
    optional=True,
)


def yielding_model(lane: Lane, units: Units, preset: Preset) -> Any:
    """Compile a lane as `joint_model` does, with a tendon that yields, in each cell, in place of its dry friction."""
    chain, time_step = units.scaled(lane.chain), lane.time_step / units.time
    stiffness = yield_stiffness(chain, time_step, preset["spring_phase"])
    spec = new_spec(time_step, preset)
    for cell in range(chain.cells):
        add_masses(spec, chain, cell)
        tendon = spec.add_tendon(springlength=[0, 0])
        set_spring(tendon, stiffness[cell], 0.0)
        tendon.springyield = 1.0  # a cell without friction has its memory too
        tendon.wrap_joint(f"inner {cell}", 1)
    add_chain(spec, chain)
    model = spec.compile()
    model.tendon_springyield[: chain.cells] = chain.friction_bound / stiffness
    return model
