"""What every preset of every engine makes of the contract's random chains, bit by bit.

``python -m tests.golden.engines`` prints a digest of every array of `run` and `advance` by variant: run it in two work
trees on one machine, and compare. Modulated contacts are among the lanes where a preset takes them, and
models of steps among the variants.
"""

import dataclasses
import hashlib
import json
import sys
from collections.abc import Iterator, Sequence

import numpy as np

from multibody_xval.engines.contract.lanes import lane_of, modulated_lane, pulse_lane_of, random_lanes, scaled_state
from multibody_xval.engines.interface.variant import Variant, variants_named
from reference_lcp.chain.simulation import Lane
from reference_lcp.errors import ParameterError

STEPS = 60


def cases() -> dict[str, list[Lane]]:
    """Give batches of lanes by name."""
    canonical = lane_of(0.3, 0.6)
    return {
        "random": random_lanes(),
        "pulse": [pulse_lane_of(0.3)],
        "modulated": [modulated_lane(0.5), modulated_lane(0.9, 2)],
        "lifting": [modulated_lane(1.5)],
        "static": [dataclasses.replace(canonical, static_ratio=1.2)],
    }


def arrays(variant: Variant, lanes: Sequence[Lane]) -> Iterator[tuple[str, np.ndarray]]:
    """Give every array of a run, of a run that goes on, and of steps without a record."""
    simulation = variant.build(lanes)
    try:
        start = scaled_state(lanes)
        first = simulation.run(start, 0, STEPS)
        for number, trajectory in enumerate(first):
            for name, value in vars(trajectory).items():
                if isinstance(value, np.ndarray):
                    yield f"run {number} {name}", value
        end = simulation.advance(start, 0, STEPS)
        yield "advance positions", end.positions
        yield "advance velocities", end.velocities
        after = simulation.advance(end, STEPS, STEPS)
        yield "later positions", after.positions
    finally:
        simulation.close()


def digest(variant: Variant, lanes: Sequence[Lane]) -> str:
    """Give one digest of all arrays; or why there are none."""
    try:
        whole = hashlib.sha256()
        for name, values in arrays(variant, lanes):
            whole.update(name.encode() + np.ascontiguousarray(values).tobytes())
        return whole.hexdigest()[:16]
    except (ParameterError, RuntimeError) as problem:
        return f"{type(problem).__name__}: {problem}"


if __name__ == "__main__":
    for engine_variant in variants_named(sys.argv[1:] or ["all:all:all"]):
        if engine_variant.unavailable_reason is None:
            digests = {name: digest(engine_variant, lanes) for name, lanes in cases().items()}
            print(json.dumps({str(engine_variant): digests}), flush=True)
