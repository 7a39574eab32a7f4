"""The family of faulty engines: a plugin, as any other. Each has one fault, and its name is ``faulty-`` with that."""

import re
from types import SimpleNamespace

import numpy as np

from multibody_xval.engines import Capabilities, Engine, Formulation, FrictionLaw
from multibody_xval.engines.interface.scene import SceneBuilder, SteppedWorld
from tests.faulty.deadly import PROCESSES
from tests.faulty.faults import SEEN
from tests.faulty.of_clauses import OF_CLAUSES
from tests.faulty.scheme import Batch, Fault

PREFIX = "faulty-"

FAULTS = {**SEEN, **OF_CLAUSES, **PROCESSES}
"""All of them by name: each is the only thing that is wrong with its engine."""


def hinge_in(radian: float) -> SceneBuilder:
    """Give what builds a loaded hinge of 1 kg m², whose angle is in a unit."""

    def build(scene, setting) -> SteppedWorld:
        motion = np.zeros(2)  # angle and rate

        def step() -> None:
            motion[1] += setting.time_step * max(scene.load - scene.friction, 0.0)
            motion[0] += setting.time_step * motion[1]

        return SteppedWorld(step, lambda: (radian * motion[0],))

    return build


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

        scene_worlds = {Formulation.JOINT: hinge_in(fault.radian)} if fault.radian else {}

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
