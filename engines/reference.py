"""The reference as an engine: the Euler scheme of equation (5), compiled."""

import importlib.metadata

from engines.interface import Capabilities, Engine, Formulation, FrictionLaw, Preset
from reference_lcp.compiled import CompiledSimulation
from reference_lcp.simulation import Lane, Simulation


class Reference(Engine):
    """The LCP scheme that every other engine is compared with."""

    name = "reference"
    capabilities = Capabilities(
        title="Reference (LCP)",
        package="multibody-xval",
        licence="MIT",
        friction_law=FrictionLaw.COULOMB,
        presets={Formulation.JOINT: {"tuned": Preset("The scheme of equation (5); it has no options.")}},
        shares_scheme=True,
        split_tolerance=0.0,
        notes="Exact Coulomb friction by a linear complementarity problem in each step; first order in the time step.",
    )

    def version(self) -> str:
        """Version of this suite."""
        return importlib.metadata.version("multibody-xval")

    def why_not_installed(self) -> str | None:
        """The reference is always there."""
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        return CompiledSimulation(lanes)
