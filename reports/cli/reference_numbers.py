"""The numbers of a steady state and of a proof, ready for JSON."""

from __future__ import annotations

import math
from dataclasses import asdict
from decimal import Decimal
from enum import StrEnum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable

    from reference_lcp.exact.proof.prove import ProvenSteadyState
    from reference_lcp.observables.stick_slip import Transition
    from reference_lcp.one_call import SteadyState


def plain(value: Any) -> Any:
    """Give decimals and words as texts, arrays as lists, and a number that is not finite as ``None``."""
    if isinstance(value, dict):
        return {name: plain(own) for name, own in value.items()}
    if isinstance(value, list | tuple):
        return [plain(own) for own in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    return str(value) if isinstance(value, Decimal | StrEnum) else value


def numbers_of(state: SteadyState) -> dict[str, Any]:
    """Give the numbers of a steady state, those of its error bar too if there is one."""
    orbit, bar, changes = state.orbit, state.error_bar, _changes(state.transitions)
    extra: dict[str, Any] = {"reason": orbit.reason} if orbit.reason else {}
    if bar is not None:
        changes = [own | {"error_bar_s": error} for own, error in zip(changes, bar.transition_time, strict=True)]
        extra |= {
            "error_bar_db": bar.transmittance_db,
            "floor_db": bar.floor_db,
            "error_bar_phase_rad": bar.phase,
            "error_bar_stuck_fraction": bar.stuck_fraction,
            "missing_transitions": _changes(bar.missing_transitions),
            "order": bar.order,
            "extrapolated_db": bar.extrapolated_db,
        }
    numbers = {
        "transmittance_db": state.transmittance_db,
        "phase_rad": state.phase,
        "residual": orbit.residual,
        "status": orbit.status,
        "periods": orbit.periods,
        "steps_per_period": orbit.trajectory.steps,
        "stuck_fraction": state.stuck_fraction,
        "transitions": changes,
    }
    return plain(numbers | extra)


def _changes(transitions: Iterable[Transition]) -> list[dict[str, Any]]:
    return [{"cell": own.cell, "time_s": own.time, "kind": own.kind} for own in transitions]


def numbers_of_proof(proven: ProvenSteadyState) -> dict[str, Any]:
    """Give all that is proven."""
    return {"status": "proven", "reason": None} | plain(asdict(proven))
