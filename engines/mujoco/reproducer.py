"""Options of MuJoCo's presets as the attributes of a model in XML, in SI units."""

from collections.abc import Mapping
from typing import Any

from multibody_xval.engines.interface.presets import OfStep, Preset
from multibody_xval.engines.interface.reproducer import Reproducer
from multibody_xval.engines.mujoco.contact import DEPTH, PLATE, RADIUS, TOUCH
from multibody_xval.engines.mujoco.joint import solref_of
from multibody_xval.engines.shared.script_units import SI, script_units
from multibody_xval.engines.shared.units import Units, power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State

OPTION_ATTRIBUTES = (
    "solver", "iterations", "tolerance", "noslip_iterations", "cone", "impratio", "jacobian", "integrator",
)  # fmt: skip
"""Options of the whole model."""


def joint_numbers(lane: Lane, preset: Preset, _start: State, units: Units = SI) -> Mapping[str, Any]:
    """Give the attributes that differ from MuJoCo's own: of the model, and of the joint that rubs."""
    changed = preset["solref_friction"] != preset.options["solref_friction"].default
    solref = _solref(preset, "solref_friction", lane, units)
    return {**script_units(units), **_model(preset), "joint": f'solreffriction="{solref}"' if changed else ""}


def contact_numbers(
    lane: Lane, preset: Preset, _start: State, units: Units = SI, touch: float = TOUCH
) -> Mapping[str, Any]:
    """Give the attributes that differ from MuJoCo's own: of the model, and of the pair that rubs; and its geometry."""
    lane = preset.pressed(lane)
    lifting = lane.preload is not None
    options = preset.modulated() if lifting else preset
    pair = _pair(options, lane, units)
    scale = power_of_two(lane.drive.displacement_scale(lane.chain)) / units.length
    return {
        **script_units(units),
        **_model(options),
        "lifting": lifting,
        **_bound(preset),
        "joints": 4 if lifting else 3,
        "radius": RADIUS * scale,
        "plate": PLATE * scale,
        "height": 2 * RADIUS * scale - (touch if lifting else DEPTH) * scale,
        "pair": [" ".join(pair[start : start + 2]) for start in range(0, len(pair), 2)],  # lines of two
    }


def _model(preset: Preset) -> dict[str, str]:
    there = [name for name in OPTION_ATTRIBUTES if name in preset.options]
    changed = {name: preset[name] for name in there if preset[name] != preset.options[name].default}
    flags = " ".join(f'{name}="disable"' for name in preset["disable"])
    return {
        "option": " ".join(f'{name}="{value}"' for name, value in changed.items()),
        "flags": f"<flag {flags}/>" if flags else "",
    }


def _bound(preset: Preset) -> dict[str, str]:
    """Give coefficient and normal forces: a preset with a coefficient of its own presses harder, for the same bound."""
    if "coefficient" not in preset.options:
        return {"friction": "{FRICTION[i]} {FRICTION[i]}", "pressing": "NORMAL_FORCE"}
    own = preset["coefficient"]
    return {"friction": f"{own} {own}", "pressing": f"np.array(FRICTION) * NORMAL_FORCE / {own}"}


def _pair(preset: Preset, lane: Lane, units: Units) -> list[str]:
    """Give the attributes of the pair; see `multibody_xval.engines.mujoco.contact`."""
    changed = "solimp" in preset.options and preset["solimp"] != preset.options["solimp"].default
    attributes = [f'solimp="{preset["solimp"][0]} {preset["solimp"][1]}"'] if changed else []
    if lane.preload is None:
        attributes.append(f'solref="-1 {-2 * units.time / preset["normal time constant"]!r}"')
    own = ("solreffriction",) if lane.preload is None else ("solref", "solreffriction")
    changed_solrefs = [name for name in own if preset[name] != preset.options[name].default]
    return attributes + [f'{name}="{_solref(preset, name, lane, units)}"' for name in changed_solrefs]


def _solref(preset: Preset, name: str, lane: Lane, units: Units) -> str:
    """Write a solref: numbers, or formulas of the time step that the script works out."""
    value = preset[name]
    if not isinstance(value, OfStep):
        return " ".join(map(repr, solref_of(preset, name, lane.time_step, units)))
    step = " / TIME_STEP" if units == SI else " * TIME / TIME_STEP"
    return " ".join(
        "{" + part.replace("(", " * (").replace("/h", step).replace("²", " ** 2") + "}" for part in value.text.split()
    )


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers)
