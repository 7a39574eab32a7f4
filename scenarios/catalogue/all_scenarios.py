"""Every scenario by its name, in the order in which they are listed and run."""

from collections.abc import Mapping

from multibody_xval.scenarios.catalogue import blocks, boxes, broadband, chains, free_decay
from multibody_xval.scenarios.catalogue.scenario import Scenario

SCENARIOS: Mapping[str, Scenario] = {
    own.name: own for family in (chains, free_decay, blocks, broadband, boxes) for own in family.SCENARIOS
}
