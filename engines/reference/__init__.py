"""The reference as an engine: the Euler scheme of equation (5), compiled, and the exact motion."""

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, NormalForce, Preset
from multibody_xval.engines.shared.pip_engine import installed_version
from reference_lcp.chain.simulation import Lane, Simulation

EXACT = "exact"
"""Name of the preset without a time step."""

SERIES_ROUND_OFF = 1e-12
"""Split tolerance of the exact motion: a run that is split begins another power series there, with sums of some thirty
terms in another order: thirty roundings a step, of a motion of a few displacement scales, over 100 steps."""


class Reference(Engine):
    """The LCP scheme that every other engine is compared with."""

    name = "reference"
    capabilities = Capabilities(
        title="Reference (LCP)",
        package="multibody-xval",
        licence="MIT",
        friction_law=FrictionLaw.COULOMB,
        presets={
            Formulation.JOINT: {
                "tuned": Preset(
                    "The scheme of equation (5), one Euler step a time step.",
                    shares_scheme=True,
                    normal_force=NormalForce.LIFTING,
                    static_friction=True,
                ),
                EXACT: Preset(
                    "The motion between events in closed form, without a time step; for harmonic drives or none.",
                    split_tolerance=SERIES_ROUND_OFF,
                    batch_lanes=1,
                    optional=True,
                    static_friction=True,
                ),
            }
        },
        batch_lanes=64,
        notes="Exact Coulomb friction by a linear complementarity problem in each step; first order in the time step.",
    )

    def version(self) -> str:
        """Version of this suite."""
        return installed_version("multibody-xval")

    def unavailable_reason(self) -> str | None:
        """The reference is always there."""
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        from multibody_xval.engines.reference.simulations import exact_simulation
        from reference_lcp.schemes.euler import euler_simulation

        if preset is self.capabilities.presets[formulation][EXACT]:
            return exact_simulation(lanes)
        return euler_simulation(lanes)
