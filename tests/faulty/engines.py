"""The family of faulty engines: a plugin, as any other. Each has one fault, and its name is ``faulty-`` with that."""

import re
from types import SimpleNamespace

from multibody_xval.engines import Capabilities, Engine, Formulation, FrictionLaw
from tests.faulty.deadly import PROCESSES
from tests.faulty.faults import SEEN
from tests.faulty.of_clauses import OF_CLAUSES
from tests.faulty.scheme import Batch, Fault

PREFIX = "faulty-"

FAULTS = {**SEEN, **OF_CLAUSES, **PROCESSES}
"""All of them by name: each is the only thing that is wrong with its engine."""


def family(name: str, fault: Fault) -> type[Engine]:
    """Give the engine with a fault."""

    class Faulty(Engine):
        capabilities = Capabilities(
            title=f"Euler's scheme, wrong: {fault.what}",
            package="faulty-engines",
            licence="MIT",
            friction_law=FrictionLaw.COULOMB,
            presets={Formulation.JOINT: fault.presets},
            batch_lanes=16,
            optional=True,
        )

        def version(self) -> str:
            return "1.0.0"

        def unavailable_reason(self) -> str | None:
            return None

        def _build(self, lanes, formulation, preset) -> Batch:
            return Batch(lanes, fault, preset)

    Faulty.name = f"{PREFIX}{name}"
    return Faulty


class TakesEverything(family("takes", Fault("any formulation, preset and lane is taken"))):
    def build(self, lanes, formulation="joint", preset="tuned"):
        return Batch(lanes, SEEN["sound"])


ENGINES = SimpleNamespace(
    takes=TakesEverything,
    **{re.sub(r"\W", "_", name): family(name, fault) for name, fault in FAULTS.items()},
)
