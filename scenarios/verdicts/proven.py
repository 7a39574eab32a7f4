"""Proven levels of steady states, as data that comes with the suite: the one truth of every task that asks for one.

`multibody_xval.scenarios.catalogue.proofs` makes the table, and proves it again. Ratios are the decimals that they are
printed as.
"""

import csv
import json
from collections.abc import Mapping
from dataclasses import replace
from decimal import ROUND_HALF_EVEN, Decimal
from fractions import Fraction
from functools import cache
from importlib import resources
from typing import Any, NamedTuple, Self

from pydantic import TypeAdapter

from multibody_xval.scenarios.runs.parameters import DEFAULT_AMPLITUDE, ChainRatios, Excitation
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.verdicts.steady_case import EXACT
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.prove import ProvenSteadyState

TABLE = "proven.csv"

DIGITS = 20
"""Decimals of a level in dB and of a phase."""

RADIUS = Decimal(1).scaleb(-DIGITS)
"""Largest distance of a number of the table from the true one: half a digit is rounded, half is that of the proof."""

ROUNDED_DB = 2.0**-45
"""Rounding of a level to a double [dB]: half a unit in the last place of levels below 512 dB."""

_TASK = TypeAdapter(SteadyStateTask)


class ProvenLevel(NamedTuple):
    """What is proven of one steady state."""

    transmittance_db: Decimal
    phase: Decimal
    """To `RADIUS`: transmittance [dB], and the phase of its fundamental [rad]."""
    events: int
    """Transitions of all contacts in a period."""

    @property
    def numbers(self) -> dict[str, Any]:
        """Level and phase as doubles, by the names of a result."""
        return {"transmittance_db": float(self.transmittance_db), "phase": float(self.phase)}

    @classmethod
    def of(cls, state: ProvenSteadyState) -> Self:
        """Round what is proven to the decimals of the table."""
        level, phase = (each.value.quantize(RADIUS, ROUND_HALF_EVEN) for each in (state.transmittance_db, state.phase))
        return cls(level, phase, len(state.transitions))


def steady_state_of(task: SteadyStateTask) -> SteadyStateTask:
    """Give the one task of all that ask for the same steady state, whoever searches it and in whatever units."""
    return SteadyStateTask(
        variant=EXACT,
        friction_ratio=task.friction_ratio,
        frequency_ratio=task.frequency_ratio,
        ratios=replace(task.ratios, friction_coefficient=ChainRatios().friction_coefficient),
        excitation=Excitation(kind=task.excitation.kind, amplitude=DEFAULT_AMPLITUDE[task.excitation.kind]),
        modulation=task.modulation,
    )


def chain_text(task: SteadyStateTask) -> str:
    """Give what a chain of the table has beside the canonical one, as JSON; empty of that one."""
    ratios, canonical = task.ratios.as_data(), ChainRatios().as_data()
    own: dict[str, Any] = {"ratios": {name: value for name, value in ratios.items() if value != canonical.get(name)}}
    own["modulation"] = None if task.modulation is None else vars(task.modulation)
    chain = {name: value for name, value in own.items() if value}
    return json.dumps(chain) if chain else ""


@cache
def proven_levels() -> Mapping[SteadyStateTask, ProvenLevel]:
    """Read the table, by `steady_state_of`."""
    text = resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8")
    return {
        _task_of(row): ProvenLevel(Decimal(row["transmittance_db"]), Decimal(row["phase"]), int(row["events"]))
        for row in csv.DictReader(text.splitlines())
    }


def _task_of(row: Mapping[str, str]) -> SteadyStateTask:
    point = {name: json.loads(row[name]) for name in ("friction_ratio", "frequency_ratio")}
    return _TASK.validate_python({"variant": EXACT, **point, **json.loads(row["chain"] or "{}")})


def proven_level(task: SteadyStateTask) -> ProvenLevel | None:
    """Give what is proven of the steady state of a task; ``None`` where it is none of the table."""
    return proven_levels().get(steady_state_of(task))


def exact_chain(task: SteadyStateTask) -> ExactChain:
    """Give the chain of a task in exact numbers: its ratios as decimals; under a force, the doubles of its units."""
    if task.excitation.kind == "force":
        lane, _ = task.lane()
        return ExactChain.of(*task.setting(), lane.preload)
    ratios = dict(vars(task.ratios))
    ratios.pop("friction_coefficient")
    profile, friction = ratios.pop("friction_profile"), task.friction_ratio
    bounds = _per_cell(friction, task.cells), _per_cell(profile, task.cells)
    if (pressed := task.modulation) is not None:
        ratios |= {"modulation": pressed.modulation, "modulation_multiple": pressed.multiple}
        ratios["modulation_phase"] = pressed.phase
    return ExactChain.from_ratios(
        frequency_ratio=task.frequency_ratio,
        friction_ratio=tuple(one * other for one, other in zip(*bounds, strict=True)),
        **ratios,
    )


def _per_cell(ratio: float | tuple[float, ...], cells: int) -> list[Fraction]:
    values = ratio if isinstance(ratio, tuple) else (ratio,) * cells
    return [Fraction(str(value)) for value in values]
