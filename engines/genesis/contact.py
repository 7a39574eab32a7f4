"""Genesis's contact formulation: in every cell a sphere, the inner mass, on a plate, the outer one.

As in MuJoCo's, a sphere that is held dips into its plate, at a fixed depth: nothing moves across, and the normal force
is what the constraint makes of the depth. One that is free rests on its plate, and a force presses it on, or pulls it
off.
"""

from collections.abc import Sequence
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.genesis.chains import FREE_STRIDE, Chains, chain_model, constraint_parameters
from multibody_xval.engines.genesis.joint import GenesisSimulation
from multibody_xval.engines.interface.presets import OfStep, Preset
from multibody_xval.engines.mujoco.contact import DEPTH, PLATE, RADIUS, TOUCH
from multibody_xval.engines.shared.units import Units, power_of_two
from multibody_xval.engines.shared.worlds_simulation import rub_alike
from reference_lcp.chain.simulation import Lane
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

LEAST_COEFFICIENT = 0.01
"""Smallest μ: Genesis takes smaller ones, and none, for this."""

FINENESS = 2.0**14
"""Displacement scale over the unit of length: accelerations are then near one, far above the solver's tolerance."""

SOFTNESS = 2.0**-60
"""How hard contacts of lanes that share a scene press, over how hard they do with a damping ratio of one.

The same for all lanes, so that none depends on the others; their coefficients make the bounds of friction of it. So
soft that no coefficient comes near `LEAST_COEFFICIENT`: by Signorini's law, nothing but the product matters.
"""


def share_a_scene(lanes: Sequence[Lane], preset: Preset) -> bool:
    """Whether one scene can hold these lanes.

    It has one time step, one time constant of contacts, and a contact in the same cells of all environments, of one
    size. In SI units, the contacts of spheres that are held differ by what presses them.
    """
    in_steps = preset["units"] == "lane" and isinstance(preset["constraint_timeconst"], OfStep)
    sizes = {(lane.time_step, power_of_two(lane.drive.displacement_scale(lane.chain))) for lane in lanes}
    alike = in_steps or (preset.is_free and len(sizes) == 1)
    return len(lanes) == 1 or (alike and rub_alike(lanes))


class ContactSimulation(GenesisSimulation):
    """Lanes with a sphere in a plate in every cell that rubs."""

    def _units_of(self, lane: Lane) -> Units:
        units = Units.in_steps(self._preset["units"], lane)
        return units if self._preset["units"] == "SI" else replace(units, length=units.length / FINENESS)

    def _new_scene(self) -> Chains:
        lane, own = self.lanes[0], self._preset["units"] == "lane"
        self._rubs = lane.chain.friction_bound > 0
        # In units of their own, all lanes have the same sizes.
        scale = FINENESS if own else power_of_two(lane.drive.displacement_scale(lane.chain))
        scene = self._scene_of(_model(self._rubs, scale))
        if self._rubs.any():
            self._press(scene)
        return scene

    def _scene_of(self, model: ElementTree.Element) -> Chains:
        return Chains(model, self._masses(), self.lanes[0].time_step / self._units[0].time, self._preset)

    def _press(self, scene: Chains) -> None:
        """Choose how hard contacts are: in SI units they press with λ_N, in others friction has its bound."""
        scene.set_contact_constraints(self._constraints(np.ones(self._rubs.size)))
        # The edges of a pyramid are the softer, the smaller the coefficient.
        scene.set_coefficients(self._of_chains("friction_coefficient"))
        scene.step()
        pressed, given = np.where(self._rubs, scene.normal_force(), 1.0), self._of_chains("normal_force")
        hardness, coefficients = self._hardness(pressed)
        _check_coefficients(coefficients[:, self._rubs])
        scene.set_contact_constraints(self._constraints(hardness))
        scene.set_coefficients(coefficients)
        # What is pressed in the lane, over what is pressed in the scene.
        self._share = given / (hardness * pressed)

    def _hardness(self, pressed: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give how many times as hard each cell is to press, shape (n,), and the coefficients, shape (lanes, n).

        Hardness is the same in all environments of a scene, and the coefficient of friction is not.
        """
        if self._preset["units"] == "SI":
            wanted = np.where(self._rubs, self._of_chains("normal_force"), 1.0)
            return wanted[0] / pressed[0], self._of_chains("friction_coefficient")
        return np.full(self._rubs.size, SOFTNESS), self._of_chains("friction_bound") / (SOFTNESS * pressed)

    def _constraints(self, hardness: FloatArray) -> FloatArray:
        """Give the parameters of contacts that press so many times as hard as with a damping ratio of one."""
        preset = self._preset
        own, unit = preset["constraint_timeconst"], self._units[0].time
        time_constant = own.at(self.lanes[0].time_step / unit) if isinstance(own, OfStep) else own / unit
        return np.stack(
            [constraint_parameters(time_constant, float(each) ** -0.5, preset["solimp"]) for each in hardness]
        )

    def _contacts(self, forces: FloatArray) -> FloatArray:
        return np.hstack([super()._contacts(forces), self._scene.normal_force()])

    def _contact_forces(self, index: int, read: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
        friction, _ = super()._contact_forces(index, read, given)
        if not self._rubs.any():
            return friction, given
        measured = read[:, self._rubs.size :] * self._share[index] * self._units[index].force
        return friction, np.where(self._rubs, measured, given)


class FreeContactSimulation(ContactSimulation):
    """Lanes with a sphere that rests on its plate in every cell that rubs, pressed by a force; in SI units."""

    _joints, _opens = FREE_STRIDE, True

    def _new_scene(self) -> Chains:
        lane = self.lanes[0]
        self._rubs = lane.chain.friction_bound > 0
        coefficients = self._of_chains("friction_coefficient")
        self._share = np.ones(coefficients.shape)
        _check_coefficients(coefficients if lane.opens else coefficients[:, self._rubs])
        scale = power_of_two(lane.drive.displacement_scale(lane.chain))
        scene = self._scene_of(_model(self._rubs, scale, free=True))
        if self._rubs.any():
            scene.set_contact_constraints(self._constraints(np.ones(self._rubs.size)))
            scene.set_coefficients(np.where(self._rubs, coefficients, 1.0))
        return scene

    def _bounds(self, start: int, steps: int) -> FloatArray:
        """Give what presses spheres in every step; where nothing rubs, nothing carries them."""
        return np.where(self._rubs, self._preloads(start, steps), 0.0)

    def _set_bounds(self, bounds: FloatArray) -> None:
        self._scene.press(bounds)


def _check_coefficients(coefficients: FloatArray) -> None:
    least = np.min(coefficients, initial=np.inf)
    if least < LEAST_COEFFICIENT:
        allowed = f"at least {LEAST_COEFFICIENT:g} in Genesis"
        raise ParameterError(f"friction_coefficient = {least:g}; allowed: {allowed}")


def _model(rubs: NDArray[np.bool_], scale: float, *, free: bool = False) -> ElementTree.Element:
    """Give a chain with a sphere in a plate, or `free` to leave it, in every cell that rubs, side by side."""
    radius, shapes = RADIUS * scale, {}
    height = 2 * radius - (TOUCH if free else DEPTH) * scale
    for cell in np.flatnonzero(rubs).tolist():
        plate = f'<geom type="box" size="{PLATE * scale!r} {radius!r} {radius!r}" friction="1"/>'
        sphere = f'<geom type="sphere" size="{radius!r}" pos="0 0 {height!r}" friction="1"/>'
        shapes[cell] = (plate, sphere, 4 * radius * cell)
    return chain_model(rubs.size, shapes, free=free)
