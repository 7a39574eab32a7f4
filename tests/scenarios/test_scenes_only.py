"""A preset that runs scenes only: it is refused by name where a chain is needed, and left out where none is named."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import pytest

from multibody_xval.engines.interface.presets import Formulation, Preset
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.reports.cli.engines import described
from multibody_xval.scenarios.agreement.checks import checks, named_configs
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.translation import _check
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.compute.scenes import unsupported_reason
from multibody_xval.scenarios.model import Case, Config, Run
from multibody_xval.scenarios.plan import compared_configs
from multibody_xval.scenarios.report_plan import report_configs
from multibody_xval.scenarios.sweeps.file import sweep_of
from reference_lcp.errors import ParameterError

NAME = "mujoco:contact:resting"
ALONE = Config(*NAME.split(":"))
SLOPE, CELL = SCENARIOS["slope-hold"], SCENARIOS["unit-cell"]


@pytest.fixture(autouse=True)
def resting(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give MuJoCo's contacts one more preset: its recipe, for scenes only."""
    own = MuJoCo.capabilities
    contact = own.presets[Formulation.CONTACT]
    preset = replace(contact["recommended"], scenes_only=True, optional=True)
    presets = {**own.presets, Formulation.CONTACT: {**contact, "resting": preset}}
    monkeypatch.setattr(MuJoCo, "capabilities", replace(own, presets=presets))


def swept(names: Sequence[str]) -> object:
    return sweep_of({"engines": list(names), "grid": {"friction_ratio": [0.3], "frequency_ratio": [0.9]}})


CHAINS: dict[str, Callable[[list[str]], object]] = {
    "names": variants_named, "sweep": swept, "report": report_configs, "run": CELL.configs,
    "compare": lambda names: compared_configs(*names),
}  # fmt: skip
"""What needs a chain, of a list of names."""


@pytest.mark.parametrize("command", CHAINS)
@pytest.mark.parametrize("name", [NAME, "mujoco:all:resting", f"{NAME}:impratio=10"])
def test_by_name_it_is_refused_in_one_line_where_a_chain_is_needed(command: str, name: str) -> None:
    said = rf"^engine = {NAME}\S* runs scenes only; allowed: mujoco, .*mujoco:contact:default$"
    with pytest.raises(ParameterError, match=said):
        CHAINS[command]([name])


@pytest.mark.parametrize("command", CHAINS)
@pytest.mark.parametrize("name", ["mujoco", "mujoco:all:all"])
def test_an_engine_or_all_of_it_leaves_it_out_there(command: str, name: str) -> None:
    if name == "mujoco" or command != "compare":
        assert "resting" not in str(CHAINS[command]([name]))


def test_a_chain_is_not_built_of_it() -> None:
    case = Case(friction_ratio=0.3, frequency_ratio=0.9)
    (result,) = run_batch([Run(ALONE, case, case.steps())])
    assert (result.status, result.reason) == (
        "unsupported", f"{NAME} runs scenes only; allowed for chains and blocks: another preset",
    )  # fmt: skip


@pytest.mark.parametrize("names", [["mujoco"], [NAME]])
def test_scenes_are_run_with_it_by_the_name_of_its_engine_too(names: list[str]) -> None:
    assert ALONE in SLOPE.configs(names)
    (result,) = run_batch([SLOPE.own_runs(ALONE)["load 0.5, own step"]])
    assert result.status == "finished"


def test_agreement_and_translation_ask_for_its_scenes() -> None:
    assert ALONE in named_configs(["mujoco"])
    assert {check.scenario.name for check in checks(ALONE)} == {"slope-hold", "slope-slide"}
    _check(ALONE, "mujoco")


def test_it_is_listed_as_such_and_with_what_runs_scenes() -> None:
    assert described("mujoco")["scenes_only"] == {"joint": [], "contact": ["resting"]}
    reason = unsupported_reason(Config("mujoco", "contact", "tuned"), next(iter(SLOPE.cases.values())).scene)
    assert reason == "preset = tuned is for the chain; allowed in scenes: default, recommended, resting"


def test_an_engine_of_such_presets_alone_is_no_engine_of_chains(monkeypatch: pytest.MonkeyPatch) -> None:
    own = replace(engine("mujoco").capabilities, presets={Formulation.CONTACT: {"only": Preset("", scenes_only=True)}})
    monkeypatch.setattr(MuJoCo, "capabilities", own)
    assert report_configs(["all"]) == [each for each in report_configs(["all"]) if each.engine != "mujoco"]
    with pytest.raises(ParameterError, match="engine = mujoco:contact:only runs scenes only; allowed: another engine"):
        variants_named(["mujoco:contact:only"])
