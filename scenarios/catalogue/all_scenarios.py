"""Every scenario by its name, in the order in which they are listed and run."""

from collections.abc import Mapping

from multibody_xval.scenarios.catalogue import (
    blocks,
    boxes,
    breakaway,
    broadband,
    chains,
    direction,
    free_decay,
    long_run,
    published,
    records,
    static_friction,
)
from multibody_xval.scenarios.catalogue.scenario import Scenario

FAMILIES = (
    chains, free_decay, blocks, breakaway, static_friction, direction, published, broadband, records, long_run, boxes,
)  # fmt: skip

SCENARIOS: Mapping[str, Scenario] = {own.name: own for family in FAMILIES for own in family.SCENARIOS}
