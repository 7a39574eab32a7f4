"""Every scenario by its name, in the order in which they are listed and run."""

from collections.abc import Mapping

from multibody_xval.scenarios.catalogue import blocks, boxes, broadband, chains, closed_forms, free_decay, normal_forces
from multibody_xval.scenarios.catalogue.scenario import Scenario

SCENARIOS: Mapping[str, Scenario] = {
    own.name: own
    for family in (chains, closed_forms, normal_forces, free_decay, blocks, broadband, boxes)
    for own in family.SCENARIOS
}
