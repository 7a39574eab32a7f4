"""Every scenario by its name, in the order in which they are listed and run."""

from collections.abc import Mapping

from multibody_xval.scenarios.catalogue import (
    blocks,
    boxes,
    broadband,
    chains,
    free_decay,
    loaded_joints,
    shaken_boxes,
    sliding_boxes,
    spinning_box,
)
from multibody_xval.scenarios.catalogue.scenario import Scenario

FAMILIES = (
    chains, free_decay, blocks, broadband, boxes, shaken_boxes, sliding_boxes, spinning_box, loaded_joints,
)  # fmt: skip

SCENARIOS: Mapping[str, Scenario] = {own.name: own for family in FAMILIES for own in family.SCENARIOS}
