"""Tasks that engines run, as plain data."""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cache
from typing import Annotated, Any, Self

from pydantic import TypeAdapter
from pydantic_core import to_json

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.interface.registry import LAW_SUFFIX, engine, law_of
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.parameters import ChainRatios, Excitation, Modulation, Ratio, left_out
from multibody_xval.scenarios.runs.sources import sources_of
from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, steps_per_period_for
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.observables.stick_slip import STICK_MARGIN
from reference_lcp.terminal import visible

RESULT_FORMAT = 4
"""Increased when the meaning of a result changes: results of other formats are not taken from a store."""


SOURCES = "sources"
"""Of a task's content: the digest of the files that compute its result."""


def key_of(text: str) -> str:
    """Hash of a task's text, under which its result is stored."""
    return hashlib.sha256(text.encode()).hexdigest()


def unsourced_key(content: bytes | str) -> str:
    """Give the key of a content whatever files have computed its result."""
    known = {name: value for name, value in json.loads(content).items() if name != SOURCES}
    return key_of(to_json(known).decode())


SOME = -1
"""Length of what an engine gives as many numbers of as it has coordinates, at least one."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """What all tasks have in common: the variant that runs it, and how its result is named."""

    variant: Variant

    @property
    def cells(self) -> int:
        """Cells of its chain: tasks with equally many are run together; 0 without one."""
        return 0

    @property
    def series(self) -> Mapping[str, int] | None:
        """Name and length of all that a motion to its end gives; ``None`` where a steady state is sought."""
        return {}

    @property
    def preloaded(self) -> bool:
        """Whether its normal forces change, or masses may part: presets have options of their own for that."""
        return False

    def unsupported_reason(self) -> str | None:
        """Give the reason why the variant cannot represent the case, as far as that is known without running it."""
        return None

    def content(self) -> dict[str, Any]:
        """Everything that the result depends on: the task, the engine's version, its options and its sources."""
        law = law_identity(self.variant) if self.variant.engine.endswith(LAW_SUFFIX) else {}
        content = {"format": RESULT_FORMAT, "task": self.as_data(), **_identity(self.variant), **law}
        return content | {"options": options_of(self.variant.preset.modulated())} if self.preloaded else content

    def as_data(self) -> dict[str, Any]:
        """Give the task as plain data, ready for JSON; later parameters with their default are left out."""
        return self._schema().dump_python(self, mode="json")

    @classmethod
    @cache
    def _schema(cls) -> TypeAdapter[Any]:
        return TypeAdapter(cls)

    def key(self) -> str:
        """Hash of the content: equal for equal tasks with equal engines."""
        return key_of(self.text())

    def text(self) -> str:
        """Give the content as JSON, one text for equal contents."""
        return to_json(self.content()).decode()


@dataclass(frozen=True, kw_only=True)
class ChainTask(Task):
    """A task with a chain."""

    friction_ratio: Ratio
    """μ λ_N / (k_c U0), a number or one a cell."""
    ratios: ChainRatios = field(default_factory=ChainRatios)

    @property
    def cells(self) -> int:
        """Cells of its chain."""
        return self.ratios.cells

    @property
    def chain(self) -> Chain:
        """Build the chain."""
        return self.ratios.chain(self.friction_ratio)


class Start(StrEnum):
    """Where the search for a steady state begins."""

    LAW = "law"
    """In the steady state of the law by which the variant says that it steps; where there is none, as the other."""
    HARMONIC_BALANCE = "harmonic balance"
    """In what harmonic balance gives, which knows no engine."""


class Recorded(StrEnum):
    """What the result of a steady state has beside its numbers, or instead of them."""

    NOTHING = ""
    PERIOD = "period"
    """The last period in full, see `multibody_xval.scenarios.runs.recorded`."""
    LAW = "law"
    """A period of the engine and of its law from the same state, to which the law leads from rest, and nothing else:
    ``distance``, the largest difference of positions, and ``reference``, that of the engine from the reference, both
    over the displacement scale.
    """


DEFAULT_EXCITATION = Excitation()


@dataclass(frozen=True, kw_only=True)
class SteadyStateTask(ChainTask):
    """The steady state of one chain under one harmonic excitation, by one variant."""

    frequency_ratio: float
    """ω / ω_r, with ω_r of the first cell."""
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD
    """Fewest steps a period; more are taken where dt ω_max <= 0.4 needs them."""
    excitation: Annotated[Excitation, left_out(DEFAULT_EXCITATION)] = DEFAULT_EXCITATION
    """What drives the chain; a moving base unless something else is given."""
    modulation: Annotated[Modulation | None, left_out(None)] = None
    """How the normal force changes over the period; ``None`` where it is constant."""
    start: Annotated[Start, left_out(Start.LAW)] = Start.LAW
    recorded: Annotated[Recorded, left_out(Recorded.NOTHING)] = Recorded.NOTHING

    @property
    def chain(self) -> Chain:
        """Build the chain, whose friction is referred to this excitation."""
        return self.ratios.chain(self.friction_ratio, self.excitation.displacement)

    @property
    def preloaded(self) -> bool:
        """Whether its normal forces change."""
        return self.modulation is not None

    @property
    def series(self) -> Mapping[str, int] | None:
        """Distances of one period from its law; nothing else of it has an end."""
        return {"distance": 1, "reference": 1} if self.recorded is Recorded.LAW else None

    def recording(self, recorded: Recorded) -> Self:
        """Give the task whose result has something else."""
        return replace(self, recorded=recorded)

    def setting(self) -> tuple[Chain, PeriodicDrive]:
        """Build the chain and its drive."""
        chain = self.chain
        return chain, self.excitation.drive(chain, self.frequency_ratio)

    def unsupported_reason(self) -> str | None:
        """Give the reason why the variant cannot represent the contacts; ``None`` without one."""
        return self.variant.preset.unsupported_reason(self.lane()[0], str(self.variant)) if self.preloaded else None

    def lane(self) -> tuple[Lane, int]:
        """Build the lane, and give its number of steps a period."""
        chain, drive = self.setting()
        steps = steps_per_period_for(chain, drive, self.steps_per_period)
        preload = None if self.modulation is None else self.modulation.preload(drive)
        return Lane.periodic(chain, drive, steps, preload), steps

    def content(self) -> dict[str, Any]:
        """Everything that the result depends on: the law, too, where one is compared with."""
        return super().content() | (law_identity(self.variant) if self.recorded is Recorded.LAW else {})


@cache
def _identity(variant: Variant) -> dict[str, Any]:
    """Version, options and sources that a variant's results depend on; no version where the engine is not installed."""
    adapter = engine(variant.engine)
    preset = adapter.preset(variant.formulation, variant.preset_name)
    version = None if adapter.unavailable_reason() else visible(adapter.version())
    identity = {"version": version, "options": options_of(preset), SOURCES: sources_of(adapter)}
    return identity if preset.stick_margin == STICK_MARGIN else identity | {"stick_margin": preset.stick_margin}


@cache
def law_identity(variant: Variant) -> dict[str, Any]:
    """Formula and constants of the law that the results of a law, and of comparisons with one, depend on."""
    law = law_of(variant.preset)
    if law is None:
        return {}
    return {
        "law": visible(law.formula),
        "constants": {name: repr(each.value) for name, each in sorted(law.constants.items())},
    }


def options_of(preset: Preset) -> dict[str, str]:
    """Give the options of a preset as a result's content has them."""
    return {name: repr(option.value) for name, option in sorted(preset.options.items())}


def versions_of(names: Iterable[str]) -> str:
    """Give name and version of every engine of these names that is installed, each once, in order."""
    engines = [engine(name) for name in dict.fromkeys(names)]
    return ", ".join(
        f"{adapter.name} {adapter.version()}" for adapter in engines if adapter.unavailable_reason() is None
    )
