"""Every scenario by its name, in the order in which they are listed and run."""

from collections.abc import Mapping

from multibody_xval.scenarios.catalogue import (
    blocks,
    boxes,
    breakaway,
    broadband,
    chains,
    closed_forms,
    direction,
    free_decay,
    loaded_joints,
    long_run,
    normal_forces,
    published,
    records,
    shaken_boxes,
    sliding_boxes,
    spinning_box,
    static_friction,
)
from multibody_xval.scenarios.catalogue.scenario import Scenario

FAMILIES = (
    chains, closed_forms, normal_forces, free_decay, blocks, breakaway, static_friction, direction, published,
    broadband, records, long_run, boxes, shaken_boxes, sliding_boxes, spinning_box, loaded_joints,
)  # fmt: skip

SCENARIOS: Mapping[str, Scenario] = {own.name: own for family in FAMILIES for own in family.SCENARIOS}
