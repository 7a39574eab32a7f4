"""What agreement checks: a few cases of the catalogue, each of which takes a fraction of a second."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import default_engine_names
from multibody_xval.engines.interface.variant import variants_begun
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.scenario import COMMON_STEP, STICK_SLIP, Scenario
from multibody_xval.scenarios.model import EXACT, REFERENCE, Case, Config, Run
from multibody_xval.scenarios.report_plan import HEADLINE, HEADLINE_STEPS, headline_cases

EXAMPLE = Case(friction_ratio=0.3, frequency_ratio=0.9)
"""In the pass band, at the usual steps; the headline's points are deep within the band, at twice as many."""


@dataclass(frozen=True)
class Check:
    """One case of a scenario, by one configuration."""

    config: Config
    scenario: Scenario
    case: str
    """Its name."""

    @property
    def run(self) -> Run:
        """Give the run of the configuration."""
        return self.scenario.own_runs(self.config)[self.case]

    @property
    def runs(self) -> list[Run]:
        """Give that run, and those by which it is judged."""
        case = self.run.case
        names = {name: own for name, own in self.scenario.cases.items() if own is case}
        return replace(self.scenario, cases=names).runs([self.config])

    @property
    def title(self) -> str:
        """Give what is printed of it."""
        name = self.config
        return f"{name.engine} {name.formulation} {name.preset_name.replace(':', ' ')}, {self.case}"

    @property
    def label(self) -> str:
        """Give the part of the test's name that says what is checked."""
        return f"{self.config.engine}-{self.config.formulation}-{self.config.preset_name}-{self.case}"


def _some(scenario: str, cases: Mapping[str, str], *quantities: str) -> Scenario:
    """Give some cases of a scenario under other names, with all its quantities or those that are named."""
    own = SCENARIOS[scenario]
    asked = tuple(each for each in own.quantities if not quantities or each.name in quantities)
    return replace(own, cases={title: own.cases[name] for title, name in cases.items()}, quantities=asked)


STEADY = replace(
    SCENARIOS["figure3"],
    cases={case.title: case for case in (EXAMPLE, *HEADLINE)},
    steps=lambda _config, case: {"": HEADLINE_STEPS if case in HEADLINE else case.steps()},
)

ONE_CELL = _some(
    "unit-cell",
    {
        "one cell, friction 0.6, frequency 0.9": "friction 0.6, η_r 0.9",
        "one cell, friction 0.1, frequency 0.45": "friction 0.1, η_r 0.45",
    },
    *(each.name for each in STICK_SLIP),
)

BLOCKS = (
    _some("static-hold", {"block held at 0.9 of its friction": "1 kg, load 0.9"}, "drift"),
    _some("breakaway", {"block let go by a growing load": "1 kg, 2 ms"}),
)


def _at_one_step(scenario: Scenario) -> Scenario:
    """Let scenes be run at the step that is common to all engines alone."""
    return replace(scenario, steps=lambda _config, case: {"": round(case.time / COMMON_STEP)})


SCENES = {
    Formulation.CONTACT: (
        _at_one_step(_some("slope-hold", {"box on a slope, load 0.9": "load 0.9"}, "drift")),
        _at_one_step(_some("slope-slide", {"box slides down a slope": "μ 0.2, load 1.2"})),
    ),
    Formulation.JOINT: (_at_one_step(_some("joint-hold", {"loaded hinge": "hinge, load 0.9"})),),
}
"""Of presets that hold in any model."""


def named_configs(names: Iterable[str]) -> list[Config]:
    """Give the configurations that names are the beginning of; of the engines of the suite without any.

    Raises
    ------
    ParameterError
        If there is no such engine, formulation, preset or option, or it is not installed.
    """
    asked = list(names) or [name for name in default_engine_names() if name != REFERENCE.engine]
    found = (config for name in asked for config in variants_begun(name))
    return [config for config in dict.fromkeys(found) if config != EXACT]


def checks(config: Config) -> Iterator[Check]:
    """Give what is checked of a configuration, simplest first; of one that hardly ever settles one steady state."""
    for scenario in _asked(config):
        for case in scenario.own_runs(config):
            yield Check(config, scenario, case)


def _asked(config: Config) -> Iterator[Scenario]:
    if config.preset.scenes_only:
        yield from SCENES[Formulation(config.formulation)]
        return
    yield from BLOCKS
    if config.runs_scenes and config != REFERENCE:
        yield from SCENES[Formulation(config.formulation)]
    if config.preset.settles:
        yield from (ONE_CELL, STEADY)
    else:
        yield replace(STEADY, cases={case.title: case for case in headline_cases(config)})
