"""Options of MuJoCo's presets as the attributes of a model in XML, in SI units."""

from collections.abc import Mapping, Sequence
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from engines.mujoco.contact import DEPTH, PLATE, RADIUS, TOUCH
from engines.mujoco.step_model import LARGEST_IMPEDANCE
from engines.shared.script_units import SI, script_units
from engines.shared.units import Units, power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State

OPTION_ATTRIBUTES = ("solver", "iterations", "noslip_iterations", "cone", "jacobian", "integrator")
"""Options of the whole model."""


def joint_numbers(_lane: Lane, preset: Preset, _start: State, units: Units = SI) -> Mapping[str, Any]:
    """Give the attributes that differ from MuJoCo's own: of the model, and of the joint that rubs."""
    solref = preset["solref_friction"]
    rates = _rates(solref, (1, 1), LARGEST_IMPEDANCE, units)
    return {**script_units(units), **_model(preset), "joint": "" if solref[0] > 0 else f'solreffriction="{rates}"'}


def contact_numbers(lane: Lane, preset: Preset, _start: State, units: Units = SI) -> Mapping[str, Any]:
    """Give the attributes that differ from MuJoCo's own: of the model, and of the pair that rubs; and its geometry."""
    lifting = lane.preload is not None
    options = preset.modulated() if lifting else preset
    pair = _pair(options, lifting, units)
    scale = power_of_two(lane.drive.displacement_scale(lane.chain)) / units.length
    return {
        **script_units(units),
        **_model(options),
        "lifting": lifting,
        **_bound(preset),
        "joints": 4 if lifting else 3,
        "radius": RADIUS * scale,
        "plate": PLATE * scale,
        "height": 2 * RADIUS * scale - (TOUCH if lifting else DEPTH) * scale,
        "pair": [" ".join(pair[start : start + 2]) for start in range(0, len(pair), 2)],  # lines of two
    }


def _model(preset: Preset) -> dict[str, str]:
    changed = {name: preset[name] for name in OPTION_ATTRIBUTES if preset[name] != preset.options[name].default}
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


def _pair(preset: Preset, lifting: bool, units: Units) -> list[str]:
    """Give the attributes of the pair; see `engines.mujoco.contact`."""
    changed = "solimp" in preset.options and preset["solimp"] != preset.options["solimp"].default
    width = preset["solimp"][1] if changed else LARGEST_IMPEDANCE
    attributes = [f'solimp="{preset["solimp"][0]} {preset["solimp"][1]}"'] if changed else []
    if not lifting:
        attributes.append(f'solref="-1 {-2 * units.time / preset["normal time constant"]!r}"')
    elif preset["solref"][0] < 0:
        attributes.append(f'solref="{_rates(preset["solref"], (2, 1), width, units)}"')
    if any(preset["solreffriction"]):
        attributes.append(f'solreffriction="{_rates(preset["solreffriction"], (1, 1), width, units)}"')
    return attributes


def _rates(factors: Sequence[float], powers: Sequence[int], width: float, units: Units) -> str:
    """Write stiffness and damping in the direct form, which MuJoCo divides by powers of `width`, its d_width."""
    rate = f"{width} / TIME_STEP" if units == SI else f"{width} * TIME / TIME_STEP"
    rates = [rate if power == 1 else f"({rate}) ** {power}" for power in powers]
    return " ".join(
        f"{{-{rate}}}" if factor == -1 else f"{{{factor} * {rate}}}"
        for factor, rate in zip(factors, rates, strict=True)
    )


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers, without=("yield",))
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers)
