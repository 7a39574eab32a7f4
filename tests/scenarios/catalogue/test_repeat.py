"""Repetition: engines that remember, that listen to others, or that move in another way in another process."""

import dataclasses

import pytest

from engines.interface.variant import Variant
from scenarios.catalogue.registry import CATALOGUE
from scenarios.runs.repeat import AGAIN, PROCESS, REVERSED, TOGETHER
from scenarios.verdicts.finding import Verdict
from tests.scenarios.in_process import findings

REFERENCE, REPEAT = Variant("reference"), CATALOGUE["repeat"]

LAST_DIGIT = 1 + 2.0**-52


def ways_that_differ(*variants: Variant) -> dict[str, set[str]]:
    """Give, by case, in which ways a motion is another one."""
    found = findings(REPEAT, *variants)
    cases = {finding.case for finding in found}
    differing = [finding for finding in found if finding.comparison.verdict is Verdict.DISAGREE]
    assert all(finding.comparison.verdict in (Verdict.AGREE, Verdict.DISAGREE) for finding in found)
    return {case: {finding.metric.name for finding in differing if finding.case == case} for case in cases}


@pytest.fixture
def last_digit(monkeypatch):
    """Make positions of the reference longer by their last digit in builds of which this is true."""
    build = Variant.build
    built: list[int] = []

    def spoil(when):
        def wrong(self, lanes):
            simulation, sound = build(self, lanes), build(self, lanes).run
            built.append(len(lanes))
            number = len(built)

            def run(state, start, steps):
                return [
                    dataclasses.replace(one, positions=one.positions * (LAST_DIGIT if when(number, lane, lanes) else 1))
                    for lane, one in enumerate(sound(state, start, steps))
                ]

            simulation.run = run
            return simulation

        monkeypatch.setattr(Variant, "build", wrong)

    return spoil


def test_reference_repeats_its_motion_bit_for_bit() -> None:
    assert ways_that_differ(REFERENCE) == {"chain": set()}


@pytest.mark.slow
@pytest.mark.needs("mujoco")
def test_box_that_slides_repeats_its_motion_bit_for_bit() -> None:
    assert ways_that_differ(Variant("mujoco", "contact", "default")) == {"chain": set(), "box that slides": set()}


def test_engine_that_remembers_earlier_motions_is_found(last_digit) -> None:
    last_digit(lambda number, _lane, _lanes: number > 1)
    assert ways_that_differ(REFERENCE) == {"chain": {AGAIN, TOGETHER, REVERSED}}


def test_engine_that_moves_otherwise_in_another_process_is_found(last_digit) -> None:
    last_digit(lambda *_: True)
    assert ways_that_differ(REFERENCE) == {"chain": {PROCESS}}


@pytest.mark.slow
def test_motion_that_depends_on_others_in_its_batch_is_found(last_digit) -> None:
    last_digit(lambda _number, _lane, lanes: len(lanes) > 1)
    assert ways_that_differ(REFERENCE) == {"chain": {TOGETHER, REVERSED}}


@pytest.mark.slow
def test_motion_that_depends_on_its_place_in_the_batch_is_found(last_digit) -> None:
    last_digit(lambda _number, lane, _lanes: lane > 0)
    assert ways_that_differ(REFERENCE) == {"chain": {REVERSED}}
