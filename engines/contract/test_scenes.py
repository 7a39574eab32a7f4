"""Scenes, of presets that hold in any model or run nothing else: what is built moves as it can, and alike each time."""

import math

import numpy as np

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import GRAVITY, ContactScene, JointScene, SceneSetting
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.validation import FloatArray

BOX, HINGE = ContactScene(slope=0.2), JointScene(load=1.1)
"""On a slope that holds it; under more than its friction holds, of 1 kg m²."""

STEPS = 20

USUAL_STEP = 1e-3
"""Of engines without a time step of their own [s]."""

TOUCH = 1e-3
"""By how much what is put in touch may settle [m], [rad]."""


def rows_of(scenic: Variant, time_step: float) -> FloatArray:
    """Build the scene of a preset, and follow it; of a box, its place and more."""
    scene = BOX if scenic.formulation == Formulation.CONTACT else HINGE
    world = engine(scenic.engine).scene_world(scene, SceneSetting(scenic.preset, time_step))
    try:
        return world.run(STEPS)
    finally:
        world.close()


def test_scene_repeats_and_moves_no_farther_than_without_friction(scenic: Variant) -> None:
    """In m and rad: no farther than gravity or the load takes what is free."""
    own, of_box = engine(scenic.engine).scene_step, scenic.formulation == Formulation.CONTACT
    time_step = USUAL_STEP if math.isnan(own) else own
    rows, columns = rows_of(scenic, time_step), 10 if of_box else 1
    assert rows.shape == (STEPS, columns), f"rows of shape {rows.shape}; allowed: {(STEPS, columns)}"
    assert np.all(np.isfinite(rows)), "a scene has numbers that are not finite"
    if scenic.capabilities.deterministic:
        assert np.array_equal(rows_of(scenic, time_step), rows), "the same scene moves otherwise"
    begin, pull = (np.array(BOX.places[0]), GRAVITY) if of_box else (np.zeros(1), HINGE.load)
    way = float(np.max(np.linalg.norm(rows[:, : len(begin)] - begin, axis=1)))
    assert way <= pull * time_step**2 * STEPS * (STEPS + 1) / 2 + TOUCH, "a scene moves farther than it can"
