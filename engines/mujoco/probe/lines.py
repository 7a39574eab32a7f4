"""Lines of the recipe that a model is run with, one by one and all together."""

import copy
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Formulation, Preset
from multibody_xval.engines.interface.scene import SceneSetting
from multibody_xval.engines.mujoco.probe.stops import damped, stopping_rate
from multibody_xval.engines.mujoco.scene import JOINT_ATTRIBUTES, written

AS_IT_IS, RECIPE = "as it is", "recipe (all lines)"
"""Names of the model without the recipe, and with all lines of it."""

NO_SWEEPS = 'noslip_iterations="0"'
"""Line for a model that has sweeps without softness: they may help beside the recipe, or not."""

WITH_SWEEPS = f"recipe but {NO_SWEEPS}"
"""Name of all other lines with the model's own sweeps."""

ENUMERATIONS = {"cone": "mjtCone.mjCONE_", "solver": "mjtSolver.mjSOL_", "integrator": "mjtIntegrator.mjINT_"}
"""Of options that are words."""

CONTACTS = ("cone", "impratio")
"""Options of contacts alone."""

DAMPED = 'solreffriction="-x -x"'
"""Line for joints with much damping: x is `stops.stopping_rate`."""

TOLERANCE = 1e-14
"""Of the solver, as in the recommended presets: with MuJoCo's own 1e-8 a load that swings makes the recipe drift."""

ITERATIONS = {"iterations": 100, "ls_iterations": 50}
"""MuJoCo's own; impratio needs them."""

HARD = 0.998
"""First number of a contact's solimp from which on the recipe's impratio loses what is shaken."""

Recipe = Mapping[str, tuple[tuple[str, Any], ...]]
"""Options and values by line: none as it is, each alone, all."""


def recommended(presets: Mapping[Formulation, Mapping[str, Preset]]) -> list[Preset]:
    """Give the presets that a recipe is made of, contacts first."""
    return [presets[formulation]["recommended"] for formulation in (Formulation.CONTACT, Formulation.JOINT)]


def recipe_lines(presets: Sequence[Preset], model: Any) -> Recipe:
    """Give the lines of a recipe for a model, named as they are written in MJCF."""
    lines: dict[str, tuple[tuple[str, Any], ...]] = {}
    for preset in presets:
        setting = SceneSetting(preset, model.opt.timestep)
        for name in preset.options:
            value = setting.changed(name)
            if value is not None and name != "tolerance":  # a model's own may be finer
                lines[f'{JOINT_ATTRIBUTES.get(name, name)}="{written(setting, name)}"'] = ((name, value),)
    if damped(model):
        lines[DAMPED] = ((DAMPED, None),)
    lines.update(_of_solver(model.opt))
    every = tuple(each for line in lines.values() for each in line)
    but_sweeps = tuple(each for name, line in lines.items() for each in line if name != NO_SWEEPS)
    kept = {WITH_SWEEPS: but_sweeps} if NO_SWEEPS in lines else {}
    return {AS_IT_IS: (), **lines, **kept, RECIPE: every}


def acts(option: str) -> frozenset[str]:
    """Give the kinds of friction that an option is about, as `Motion.row` names them; none of the solver's options."""
    if option in CONTACTS:
        return frozenset({"contact"})
    return frozenset({"dof", "tendon"}) if option in JOINT_ATTRIBUTES else frozenset()


def _of_solver(option: Any) -> dict[str, tuple[tuple[str, Any], ...]]:
    """Give the lines with which a model's solver converges, and has no sweep without softness after it."""
    lines: dict[str, tuple[tuple[str, Any], ...]] = {}
    if option.tolerance > TOLERANCE:
        lines[f'tolerance="{TOLERANCE:g}"'] = (("tolerance", TOLERANCE),)
    few = {name: count for name, count in ITERATIONS.items() if getattr(option, name) < count}
    if few:
        lines[" ".join(f'{name}="{count}"' for name, count in few.items())] = tuple(few.items())
    if option.noslip_iterations > 0:
        lines[NO_SWEEPS] = (("noslip_iterations", 0),)
    return lines


def with_options(model: Any, options: Sequence[tuple[str, Any]]) -> Any:
    """Give a copy of a model with options as the recipe says it in Python."""
    import mujoco

    changed = copy.copy(model)
    for name, value in options:
        if name == "solref_friction":
            changed.dof_solref[:], changed.tendon_solref_fri[:] = value, value
        elif name == DAMPED:
            dofs = damped(model)
            changed.dof_solref[dofs] = -stopping_rate(model)[dofs, None]
        elif name == "solimp_friction":
            changed.dof_solimp[:, :2], changed.tendon_solimp_fri[:, :2] = value, value
        elif name in ENUMERATIONS:
            kind, _, prefix = ENUMERATIONS[name].partition(".")
            setattr(changed.opt, name, getattr(getattr(mujoco, kind), f"{prefix}{value.upper()}"))
        else:
            setattr(changed.opt, name, value)
    return changed


def warnings(model: Any) -> Iterator[str]:
    """Say where contacts are too hard for the recipe's impratio, and what to write."""
    rough = (model.geom_contype | model.geom_conaffinity != 0) & (model.geom_condim > 1)
    hardest = np.concatenate([model.geom_solimp[rough, 0], model.pair_solimp[:, 0]]).max(initial=0.0)
    if hardest >= HARD:
        yield f'Contacts have a solimp of {hardest:g}: from {HARD} on they need impratio="100", or lose what is shaken.'
