"""An engine in an installable package of its own: found, listed and held to the contract, with nothing edited."""

import json

import pytest

from multibody_xval.engines.contract import cases


def test_installed_engine_is_listed(install) -> None:
    rows = json.loads(install("plugin").run("-m", "multibody_xval", "engines", "--json"))
    assert {row["engine"]: (row["version"], row["missing"]) for row in rows}["tiny"] == ("1.2.3", None)


CONTRACT = "-m pytest -q -n 0 -p no:cacheprovider --pyargs multibody_xval.engines.contract --xval-engine"


@pytest.mark.slow
def test_installed_engine_is_held_to_the_contract(install) -> None:
    printed = install("plugin").run(*CONTRACT.split(), "tiny")
    assert int(printed.rsplit(" passed", 1)[0].split()[-1]) >= 20


def test_contract_refuses_an_engine_that_is_not_there(install) -> None:
    install("plugin").run(*CONTRACT.split(), "tinny", code=4)


def test_installed_engine_is_judged(install) -> None:
    said = install("plugin").run("-m", "multibody_xval", "run", "unit-cell", "--engine", "tiny")
    assert "tiny:joint:tuned agrees with what is expected" in said


def test_a_part_of_an_engine_is_held_to_the_contract() -> None:
    for name, tested in (("mujoco:joint:tuned", {"tuned"}), ("mujoco:joint", {"default", "recommended", "tuned"})):
        own = cases.cases((name,))
        assert {(each.formulation, each.preset_name) for each in own["tested"]} == {("joint", each) for each in tested}
        assert own["installed"] == ["mujoco"]
