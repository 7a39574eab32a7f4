"""Contacts whose faces are inclined to the row; refused by presets that cannot incline them."""

import dataclasses
import re

import pytest

from engines.contract.lanes import modulated_lane
from engines.interface.selection import variants_of
from engines.interface.variant import Variant
from reference_lcp.chain.trajectory import State
from reference_lcp.refusal import ParameterError

SHORT_MOTION = 20
"""Steps in which the base pulls the first outer mass one way; a contact may part for one of the first, and land."""


def test_contacts_that_face_one_way_are_loaded_and_those_that_face_the_other_unloaded(inclining: Variant) -> None:
    """The base takes the outer mass from under the inner one: a face moves towards it, or away from it."""
    changes = []
    for inclination in (-0.2, 0.2):
        lane = dataclasses.replace(modulated_lane(0.0), inclination=inclination)
        simulation = inclining.build([lane])
        run = simulation.run(State.at_rest(1, lane.chain.cells), 0, SHORT_MOTION)[0]
        simulation.close()
        changes.append(run.normal_force[1:, 0].mean() / lane.chain.normal_force[0] - 1)
    assert changes[0] > 0 > changes[1], f"the normal force changes by {changes}"


def test_inclination_that_cannot_be_represented_is_refused(installed: str) -> None:
    """By presets that do not incline contacts, with the inclination."""
    lane = dataclasses.replace(modulated_lane(0.0), inclination=0.2)
    for variant in variants_of(installed):
        if not variant.preset.inclines:
            with pytest.raises(
                ParameterError, match=rf"inclination = 0\.2: .*{re.escape(variant.formulation)}.* cannot"
            ):
                variant.build([lane])
