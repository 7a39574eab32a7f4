"""Evaluators that compute in this process, and engines that are wrong."""

import dataclasses
from collections.abc import Mapping

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.base import Scenario, run_with_predictions
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.verdicts.finding import Finding, Verdict
from reference_lcp import Chain, CompiledSimulation


def evaluator(store) -> Evaluator:
    return Evaluator(store, InProcessExecutor())


def findings(scenario: Scenario, *variants: Variant, laws: bool = False) -> list[Finding]:
    """Run a scenario in memory, where asked with what laws predict of it."""
    with opened_store(None) as store, evaluator(store) as running:
        return run_with_predictions(scenario, variants, running) if laws else scenario.run(variants, running)


def rub_harder(monkeypatch, factor: float) -> None:
    """Make the variant ``mujoco`` the reference with a friction bound that is too large by this factor."""
    misread_the_chain(monkeypatch, normal_force=factor)


def misread_the_chain(monkeypatch, **factors: float) -> None:
    """Make the variant ``mujoco`` the reference, but for parameters of the chain that are wrong by these factors."""
    build = Variant.build

    def wrong(self, lanes):
        if self.engine != "mujoco":
            return build(self, lanes)
        return CompiledSimulation([dataclasses.replace(lane, chain=_scaled(lane.chain, factors)) for lane in lanes])

    monkeypatch.setattr(Variant, "build", wrong)


def press_harder(monkeypatch, spoilt: Variant, factor: float) -> None:
    """Let one variant press its masses together harder by a factor; all others, its law among them, do not."""
    build = Variant.build

    def harder(self, lanes):
        if self != spoilt:
            return build(self, lanes)
        factors = {"normal_force": factor}
        return build(self, [dataclasses.replace(lane, chain=_scaled(lane.chain, factors)) for lane in lanes])

    monkeypatch.setattr(Variant, "build", harder)


def deviating(judged: list[Finding]) -> list[Finding]:
    """Give the findings that do not agree."""
    return [finding for finding in judged if finding.comparison.verdict is not Verdict.AGREE]


class Late(CompiledSimulation):
    """The reference, with a drive that is a step late."""

    def run(self, state, start, steps):
        late = super().run(state, start - 1, steps)
        return [
            dataclasses.replace(trajectory, time=lane.times(start, steps))
            for trajectory, lane in zip(late, self.lanes, strict=True)
        ]

    def advance(self, state, start, steps):
        return super().advance(state, start - 1, steps)

    def subset(self, lanes):
        return Late([self.lanes[lane] for lane in lanes])


def be_late(monkeypatch) -> None:
    """Make the variant ``mujoco`` the reference with a drive that is a step late."""
    build = Variant.build
    monkeypatch.setattr(
        Variant, "build", lambda self, lanes: Late(lanes) if self.engine == "mujoco" else build(self, lanes)
    )


def _scaled(chain: Chain, factors: Mapping[str, float]) -> Chain:
    return dataclasses.replace(chain, **{name: factor * getattr(chain, name) for name, factor in factors.items()})
