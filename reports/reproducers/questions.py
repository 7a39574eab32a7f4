"""What a script shows: a number of a scenario, the run that it is read from, and what the suite has of it."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.scenarios.cases.chain_ratios import RATIOS
from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.ruler import DONE
from multibody_xval.scenarios.catalogue.scenario import TRANSMITTANCE, Quantity, Scenario, steps_a_row
from multibody_xval.scenarios.model import AnyCase, Case, Config, Result, Run
from multibody_xval.scenarios.result_tables import full_name
from multibody_xval.scenarios.running.evaluate import Means, computed
from reference_lcp.errors import ParameterError, checked_choice

SHOWN = {
    "static-hold": "1 kg, load 0.99",
    "breakaway": "1 kg, 2 ms",
    "stopping-distance": "1 kg, 4.9 m/s",
    "ratchet": "1 kg, load 0.5, shaken",
    "static-above-kinetic": "1 kg, 1.5",
    "published": "sdnd104-1.5",
    "figure3": "friction 0.6, η_r 0.9",
    "unit-cell": "friction 0.6, η_r 0.9",
    "slope-hold": "load 0.5",
    "stack-hold": "3 boxes, 12°",
    "heavy-on-light": "100 kg on 1 kg, 12°",
    "grip": "1 kg, 15 N",
    "held-while-shaken": "slope, 5 Hz",
    "slope-slide": "μ 0.5, load 1.5",
    "slide-to-stop": "3 m/s",
    "pushed-from-rest": "1.2 μmg, 45°",
    "conveyor": "1 m/s, μ 0.5",
    "spin": "20 rad/s",
    "joint-hold": "hinge, load 0.9",
    "arm-hold": "6 hinges, load 0.9",
    "joint-stop": "damped, 0.22 s",
}
"""Scenarios that can be reproduced, with the case that is shown unless another is named.

The number is the first quantity of the scenario that the case has; a template that has its name reads it.
"""

PERIODS = 30
"""Of a steady state's script, from rest: by then friction and dashpots have taken most of what the start shook."""


def last_period(result: Result, _run: Run) -> float:
    """Give the fundamental of the last outer mass in the last of `PERIODS` periods, over that of the drive [dB]."""
    response = np.array(result.series["response"])
    steps = response.size // PERIODS
    turn = np.exp(-2j * np.pi * np.arange(1, steps + 1) / steps)
    return float(20 * np.log10(2 * abs(np.mean(response[-steps:] * turn))))


FROM_REST = Quantity(
    name=TRANSMITTANCE.name, unit="dB", read=last_period,
    meaning=f"Fundamental of the last outer mass over that of the drive, in the last of {PERIODS} periods from rest.",
)  # fmt: skip


def from_rest(scenario: Scenario) -> Scenario:
    """Give a scenario of steady states as one of motions that begin at rest: scripts search for no steady state."""
    cases = {name: _begun(case) for name, case in scenario.cases.items()}
    return replace(scenario, cases=cases, quantities=(FROM_REST,), steps=steps_a_row())


def _begun(case: AnyCase) -> ChainMotion:
    assert isinstance(case, Case), "a steady state"
    _, drive = case.setting
    ratios = {name: getattr(case, name) for name in RATIOS}
    return ChainMotion(**ratios, drive=drive, time=PERIODS * drive.period, rows=PERIODS * case.steps())


class Number(NamedTuple):
    """What the suite has of a number, NaN where there is none, and the exact value."""

    value: float
    exact: float
    over: float = 1.0
    """What a number is given over that is given over its exact value."""


@dataclass(frozen=True)
class Reproduction:
    """What is shown: the first quantity that a run of a scenario has."""

    scenario: Scenario
    case: str
    """Name of the run within the scenario."""
    run: Run

    @property
    def quantity(self) -> Quantity:
        """The number."""
        return next(own for own in self.scenario.quantities if own.of is None or own.of(self.run.case))

    def number(self, means: Means) -> Number:
        """Give the suite's own number, run where the results file lacks it.

        Raises
        ------
        ParameterError
            If there is none, since the engine fails or cannot represent the case.
        """
        config, steps = self.run.config, self.run.steps
        alone = replace(
            self.scenario, cases={self.case: self.run.case}, quantities=(self.quantity,), steps=lambda *_: {"": steps}
        )
        stored = computed(alone.runs([config]), means, "number of the script")
        (result,) = (own.result for own in stored if own.run == self.run)
        if result.status not in DONE:
            reason = result.reason or result.status
            raise ParameterError(f"{config} has no number of {self.case!r}: {reason}; allowed: a case that it can run")
        rows = numbers(alone, stored).set_index("configuration")
        value, exact = map(float, rows.loc[full_name(config), ["value", "exact"]])
        read = self.quantity.read if self.quantity.over_exact and value else None
        over = 1.0 if read is None else float(read(result, self.run)) / value  # type: ignore[arg-type]
        return Number(value, exact, over)


def reproduction(configuration: str, name: str, case: str | None = None) -> Reproduction:
    """Give what is shown of a scenario: the case of that name, or the one of `SHOWN`.

    Of a scene, a bare engine stands for its recipe, or else its default options.
    """
    config = Config.parse(configuration)
    scenario = SCENARIOS[checked_choice("scenario", name, list(SHOWN))]
    if configuration in engine_names() and isinstance(scenario.cases[SHOWN[name]], SceneMotion):
        config = [config, *scenario.configs([configuration])][-1]
    if scenario.quantities[0] is TRANSMITTANCE:
        scenario = from_rest(scenario)
    own, cases = SHOWN[name], {key: of for key, of in scenario.cases.items() if not getattr(of, "sleeping", False)}
    chosen = own if case is None else checked_choice("case", case, list(cases))
    return Reproduction(scenario, chosen, Run(config, cases[chosen], _steps(scenario, config, cases[chosen])))


def _steps(scenario: Scenario, config: Config, case: AnyCase) -> int:
    """Give the steps of a case: of a scene, those of the engine's own time step."""
    return next(iter(scenario.steps(config, case).values()))
