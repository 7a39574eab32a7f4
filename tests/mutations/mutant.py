"""A mutant: a copy of an engine's own steps with exactly one error, whose size is a number."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.law import Law, NotModelled
from multibody_xval.engines.interface.presets import Capabilities, Formulation, NormalForce, Preset
from multibody_xval.engines.interface.registry import BATCH_LANES, LAW_SUFFIX, engine, law_of
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.defaults import DEFAULT_RESIDUAL
from reference_lcp.schemes.euler import euler_simulation

FAMILY = "mutant"
"""Name of the family of engines: mutants are ``mutant@NAME@SIZE``."""

SCHEME = Variant("reference")
"""The variant whose scheme is copied by mutants that claim to share it."""


@dataclass(frozen=True)
class Original:
    """The steps without the error: those of a law, or the reference's scheme where there is none."""

    law: Law | None

    def build(self, lanes: Sequence[Lane]) -> Simulation:
        """Build every lane."""
        return euler_simulation(lanes) if self.law is None else self.law.build(lanes)


@dataclass(frozen=True, kw_only=True)
class Mutant:
    """An engine with one error."""

    name: str
    """As it is named: lower case, hyphens."""
    error: str
    """What is wrong, in terms of its size s; nothing is where s = 0."""
    build: Callable[[Original, tuple[Lane, ...], float], Simulation]
    """Builds lanes with an error of a size."""
    size: float = 1.0
    """A size with which it moves or records something else, whatever it is."""
    of: Variant = SCHEME
    """The variant that it is a copy of, and whose law it claims."""
    normal_force: NormalForce = NormalForce.LIFTING
    """How it lets the normal force change, where that is less than the original does."""
    contact: bool = False
    """Whether it says that its friction is that of a contact, whose direction scenarios ask for, and not of a joint."""
    static_friction: bool = False
    """Whether contacts may hold more at rest: only where the error is there, for these steps are slow, by Lemke's
    method."""
    excuse: str = ""
    """A text that it states instead of a law."""

    def variant(self, size: float) -> Variant:
        """Give the mutant with an error of a size, to be run as any other variant."""
        formulation = str(Formulation.CONTACT) if self.contact else self.of.formulation
        return replace(self.of, engine=f"{FAMILY}@{self.name}@{size:g}", formulation=formulation)


class MutantEngine(Engine):
    """A mutant with an error of a size, under the presets of its original; its tuned one has no error unless it is it.

    Parameters
    ----------
    mutant
        The mutant.
    size
        s >= 0, finite.
    """

    def __init__(self, mutant: Mutant, size: float):
        self._mutant, self._size = mutant, size
        self.name = mutant.variant(size).engine  # type: ignore[misc]
        self._wrong = claimed_preset(mutant)
        self.capabilities = _capabilities(mutant, size, self._wrong)  # type: ignore[misc]

    def version(self) -> str:
        """Version of the suite."""
        return engine("reference").version()

    @property
    def host(self) -> str:
        """The reference, which is the suite's own code as well."""
        return SCHEME.engine

    @property
    def states_laws_of(self) -> str:
        """Name of the original."""
        return self._mutant.of.engine

    def unavailable_reason(self) -> str | None:
        """``None``: mutants need nothing but the suite."""
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        original = Original(law_of(preset))
        wrong = preset is self._wrong
        return self._mutant.build(original, lanes, self._size) if wrong else original.build(lanes)


def claimed_preset(mutant: Mutant) -> Preset:
    """Give the preset that a mutant claims to be."""
    if mutant.excuse:
        stated = NotModelled(mutant.excuse)
        return replace(honest_preset(SCHEME), shares_scheme=False, known_deviation=mutant.excuse, law=lambda _: stated)
    honest = honest_preset(mutant.of)
    represented = mutant.normal_force if honest.represents(mutant.normal_force) else honest.normal_force
    abilities = {"static_friction": mutant.static_friction} if mutant.of == SCHEME else {}
    return replace(honest, normal_force=represented, **abilities)


def honest_preset(variant: Variant) -> Preset:
    """Give the preset of a variant as its law has it; that of the reference where it states none."""
    if law_of(variant.preset) is None:
        return replace(SCHEME.preset, static_friction=False)
    return replace(variant, engine=f"{variant.engine}{LAW_SUFFIX}").preset


def _capabilities(mutant: Mutant, size: float, wrong: Preset) -> Capabilities:
    """Give what the original can do, with the preset that is wrong beside a tuned one."""
    original = mutant.of
    tuned = honest_preset(replace(original, preset_name="tuned"))
    return replace(
        original.capabilities,
        title=f"{original.capabilities.title} with {mutant.error}, s = {size:g}",
        presets={Formulation(mutant.variant(size).formulation): {"tuned": tuned, original.preset_name: wrong}},
        batch_lanes=SCHEME.batch_lanes if law_of(wrong) is None else BATCH_LANES,
        precision="double",
        residual=DEFAULT_RESIDUAL,
        deterministic=True,
        optional=True,
    )
