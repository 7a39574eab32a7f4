"""The family of faulty engines: a plugin, as any other."""

from types import SimpleNamespace

from multibody_xval.engines import Capabilities, Engine, Formulation, FrictionLaw, Preset
from tests.faulty.faults import FAULTS
from tests.faulty.scheme import Batch, Fault

SHARED = Preset("Claims the reference's own step.", shares_scheme=True, judged=("chain", "blocks"))
OTHER = Preset("The same steps, judged beside the exact motion.", judged=("chain", "blocks"))

PREFIX = "wrong-"


def family(name: str, fault: Fault) -> type[Engine]:
    """Give the engine with a fault."""

    class Faulty(Engine):
        """A copy of Euler's scheme with one fault."""

        capabilities = Capabilities(
            title=f"Euler's scheme, wrong: {fault.what}",
            package="faulty-engines",
            licence="MIT",
            friction_law=FrictionLaw.COULOMB,
            presets={Formulation.JOINT: {"tuned": SHARED, "other": OTHER}},
            batch_lanes=16,
            optional=True,
        )

        def version(self) -> str:
            """Version of the family."""
            return "1.0.0"

        def unavailable_reason(self) -> str | None:
            """It needs nothing but NumPy."""
            return None

        def _build(self, lanes, formulation, preset) -> Batch:
            return Batch(lanes, fault)

    Faulty.name = f"{PREFIX}{name}"
    return Faulty


ENGINES = SimpleNamespace(**{name.replace("-", "_"): family(name, fault) for name, fault in FAULTS.items()})
