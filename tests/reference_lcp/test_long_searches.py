"""Searches that take long say so, and chains that are too long for a solver are refused before any work."""

import re

import pytest

from multibody_xval.reports.cli import reference
from reference_lcp import Chain, HarmonicBase, ParameterError, exact_steady_state, simulate, steady_state
from reference_lcp.chain.simulation import steps_per_period_for
from reference_lcp.one_call import LONGEST_CHAINS
from reference_lcp.watching import tell, watched
from tests.reference_lcp.cases import driven


def setting(cells: int, friction_ratio: float = 0.3) -> tuple[Chain, HarmonicBase]:
    return driven(0.9, cells=cells, friction_ratio=friction_ratio)


TOO_LONG = [
    (lambda own: steady_state(*own, with_error_bar=True), "an error bar"),
    (lambda own: exact_steady_state(*own), "the solver 'exact'"),
    (lambda own: steady_state(*own, solver="lemke"), "the solver 'lemke'"),
    (lambda own: simulate(*own, time_step=0.01, steps=1, solver="lemke"), "the solver 'lemke'"),
]


@pytest.mark.parametrize(("call", "name"), TOO_LONG)
def test_a_chain_that_is_too_long_is_refused_with_the_range(call, name: str) -> None:
    longest = LONGEST_CHAINS[name]
    message = f"cells = {longest + 1} is more than {name} takes; allowed: <= {longest}, or without it"
    with pytest.raises(ParameterError, match=f"^{re.escape(message)}$"):
        call(setting(longest + 1))


def test_without_friction_a_long_chain_has_its_exact_value() -> None:
    assert exact_steady_state(*setting(LONGEST_CHAINS["the solver 'exact'"] + 1, friction_ratio=0.0)).orbit.converged


def test_too_many_steps_name_the_frequency_that_needs_fewer() -> None:
    """A chain whose highest frequency is far above the drive's."""
    chain = Chain.from_ratios(cells=1, friction_ratio=0.3, mass_ratio=1e10)
    with pytest.raises(ParameterError, match=r"allowed: <= 1000000, as with a frequency (\S+) times as high") as told:
        steps_per_period_for(chain, HarmonicBase.from_ratio(chain, 0.9))
    factor = float(re.search(r"frequency (\S+) times", str(told.value))[1])
    assert steps_per_period_for(chain, HarmonicBase.from_ratio(chain, 0.9 * 1.01 * factor)) <= 1_000_000


def test_a_search_tells_every_period_and_what_follows_it() -> None:
    heard: list[tuple[str, int, int]] = []
    with watched(lambda *own: heard.append(own)):
        state = steady_state(*setting(1), with_error_bar=False)
        exact = exact_steady_state(*setting(2))
    own = [number for what, number, most in heard if (what, most) == ("search for the steady state", 400)]
    assert own[: state.orbit.periods - 1] == list(range(1, state.orbit.periods))
    assert exact.orbit.converged
    assert ("exact motion, by Newton's method", 1, 16) in heard
    heard.clear()
    steady_state(*setting(1), with_error_bar=False)
    assert not heard, "nobody watches any more"
    with watched(lambda *own: heard.append(own)):
        steady_state(*setting(2), with_error_bar=False, max_periods=2, tolerance=1e-15)
    assert any(what.startswith("no steady state so far") for what, *_ in heard)


def test_a_line_about_a_long_search_comes_now_and_then(monkeypatch, capsys) -> None:
    monkeypatch.setattr(reference, "LINE_SECONDS", 0.0)
    with watched(reference.search_lines()):
        tell("search", 3, 400)
    assert capsys.readouterr().err == "search: 3 of at most 400 periods; Ctrl-C ends it\n"
