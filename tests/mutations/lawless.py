"""Engines whose law is none of the chain: their own errors, a bound that allows everything, no point that it claims."""

import dataclasses

from multibody_xval.engines import Capabilities, Formulation, FrictionLaw, Preset
from multibody_xval.engines.interface.law import Law
from reference_lcp.schemes.sequential import SequentialSimulation
from tests.mutations.faulty import Faulty, Lane


def altered(lane, **factors):
    """Give a lane of another chain, but for its drive, whose base pulls as that of the given one does."""
    chain = dataclasses.replace(
        lane.chain, **{name: part * getattr(lane.chain, name) for name, part in factors.items()}
    )
    return dataclasses.replace(lane, chain=chain)


def lawful(name, law, **factors):
    """Give an engine with a chain of its own, and one preset with a law."""

    class Lawful(Faulty):
        capabilities = Capabilities(
            title="With a law", package="faulty-engines", licence="MIT", friction_law=FrictionLaw.COULOMB,
            presets={Formulation.JOINT: {"tuned": Preset("With a law.", {}, law=lambda _: law)}},
        )  # fmt: skip

        def _build(self, lanes, formulation, preset):
            return SequentialSimulation([model(altered(lane, **factors)) for lane in lanes])

    Lawful.name = name
    return Lawful


def model(lane, _constants=None):
    """Give the scheme."""
    return Lane(lane, None)


HEAVIER, HARDER = {"inner_mass": 2.0}, {"normal_force": 1.1}
SCHEME = Law(formula="equation (5)", model=model)

Sound = lawful("faulty-lawful", SCHEME)
ItsOwnLaw = lawful(
    "faulty-own-law", dataclasses.replace(SCHEME, model=lambda lane, _: model(altered(lane, **HEAVIER))), **HEAVIER
)
Unbounded = lawful("faulty-unbounded", dataclasses.replace(SCHEME, period_bound=1.0), **HARDER)
ClaimsNothing = lawful(
    "faulty-claims-nothing", dataclasses.replace(SCHEME, unmodelled_reason=lambda _: "it is shy"), **HARDER
)
