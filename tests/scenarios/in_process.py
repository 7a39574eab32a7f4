"""Evaluators that compute in this process, and engines that are wrong."""

import dataclasses

from engines.interface.variant import Variant
from reference_lcp import CompiledSimulation
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.executor import InProcessExecutor


def evaluator(store) -> Evaluator:
    return Evaluator(store, InProcessExecutor())


def rub_harder(monkeypatch, factor: float) -> None:
    """Make the variant ``mujoco`` the reference with a friction bound that is too large by this factor."""
    build = Variant.build

    def wrong(self, lanes):
        if self.engine != "mujoco":
            return build(self, lanes)
        chains = [dataclasses.replace(lane.chain, normal_force=factor * lane.chain.normal_force) for lane in lanes]
        return CompiledSimulation(
            [dataclasses.replace(lane, chain=chain) for lane, chain in zip(lanes, chains, strict=True)]
        )

    monkeypatch.setattr(Variant, "build", wrong)
