"""Every scenario by its name, in the order in which they are listed and run."""

from collections.abc import Mapping

from multibody_xval.scenarios.catalogue.blocks import breakaway, held, published, static_friction, thrown
from multibody_xval.scenarios.catalogue.chains import (
    broadband,
    closed_forms,
    free_decay,
    long_run,
    normal_forces,
    records,
    steady_states,
)
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.catalogue.scenes import (
    held_boxes,
    loaded_joints,
    pushed_box,
    shaken_boxes,
    sliding_boxes,
    spinning_box,
    stopping_joints,
)

FAMILIES = (
    steady_states, closed_forms, normal_forces, free_decay, held, thrown, breakaway, static_friction, published,
    broadband, records, long_run, held_boxes, shaken_boxes, sliding_boxes, pushed_box, spinning_box, loaded_joints,
    stopping_joints,
)  # fmt: skip

SCENARIOS: Mapping[str, Scenario] = {own.name: own for family in FAMILIES for own in family.SCENARIOS}
