"""A law of another chain, one that allows everything or claims nothing breaks the contract; none excuses a number."""

import pytest

from multibody_xval.engines.contract.test_stated_law import test_stated_law_is_one_of_the_chain as clause
from multibody_xval.engines.interface.registry import engine_names
from multibody_xval.engines.interface.variant import Variant, variants_of
from multibody_xval.engines.shared.law_limit import law_fault
from multibody_xval.scenarios.catalogue.chains.steady_states import UNIT_CELL
from tests.scenarios.in_this_process import deviating, judged

SOUND = Variant("faulty-lawful")

FAULTS = {
    "faulty-own-law": "with ideal constants and 3200 steps it is",
    "faulty-unbounded": "its bound after a period is 1 U0; allowed: 0.0015",
    "faulty-claims-nothing": "it claims no point of figure 3",
}


@pytest.fixture(scope="module", autouse=True)
def wrong_engines(install):
    with install("mutations").visible():
        yield


@pytest.mark.slow
@pytest.mark.parametrize("name", FAULTS)
def test_law_of_another_chain_breaks_the_contract(name) -> None:
    with pytest.raises(AssertionError, match=FAULTS[name]):
        clause(Variant(name))


def test_sound_law_keeps_the_contract() -> None:
    clause(SOUND)


def test_a_law_excuses_no_number() -> None:
    assert not deviating(judged(UNIT_CELL, SOUND))
    for name in FAULTS:
        assert deviating(judged(UNIT_CELL, Variant(name))), name


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in engine_names() if not name.startswith(("faulty", "mutant"))])
def test_stated_laws_of_the_suite_are_laws_of_the_chain(name) -> None:
    assert {variant: fault for variant in variants_of(name, optional=True) if (fault := law_fault(variant))} == {}
