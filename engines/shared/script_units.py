"""What templates of scripts are given: options by name, sizes of contacts, and units behind numbers in SI units."""

from collections.abc import Callable, Mapping
from typing import Any

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.interface.reproducer import Reproducer, no_numbers
from multibody_xval.engines.shared.box_geometry import PressedBoxes
from multibody_xval.engines.shared.units import Units, power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State

DIVISORS = {
    "mass": " / MASS", "length": " / LENGTH", "time": " / TIME", "velocity": " / SPEED", "force": " / FORCE",
    "stiffness": " * TIME**2 / MASS", "damping": " * TIME / MASS",
}  # fmt: skip
"""Behind a number in SI units, in a script that has the units of `units.py.jinja`."""

SI = Units(1.0, 1.0, 1.0)


def script_units(units: Units) -> Mapping[str, Any]:
    """Give ``units``, and as ``per`` and ``times`` what is written behind numbers: nothing where they are SI units."""
    own = units != SI
    return {
        "units": units if own else None,
        "per": DIVISORS if own else dict.fromkeys(DIVISORS, ""),
        "times": {"length": " * LENGTH", "velocity": " * SPEED"} if own else {"length": "", "velocity": ""},
    }


def script_in_units(template: str, units: Callable[[str, Lane], Units] = Units.named, **constants: Any) -> Reproducer:
    """Give the reproducer of a template that has numbers in the units of the preset.

    It is given `script_units`, ``lane`` and ``preset``, whether some options are ``changed``, the ``displacement``
    scale [m], as ``scale`` the power of two below it in its units, and sizes of ``boxes``.
    """

    def numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
        own = units(preset["units"], lane)
        return {**script_units(own), **_shared(lane, preset, own), **constants}

    return Reproducer(template, numbers, own_units=True)


def script_in_si(
    template: str, numbers: Callable[[Lane, Preset, State], Mapping[str, Any]] = no_numbers, **constants: Any
) -> Reproducer:
    """Give the reproducer of a template in SI units, with what `script_in_units` gives but units, and `numbers`."""

    def given(lane: Lane, preset: Preset, start: State) -> Mapping[str, Any]:
        options = preset if lane.preload is None else preset.modulated()
        return {**_shared(lane, options, SI), **constants, **numbers(lane, options, start)}

    return Reproducer(template, given)


def _shared(lane: Lane, preset: Preset, units: Units) -> Mapping[str, Any]:
    options, displacement = preset.options, lane.drive.displacement_scale(lane.chain)

    def changed(*names: str) -> bool:
        return any(options[name].value != options[name].default for name in names)

    return {
        "lane": lane,
        "preset": preset,
        "changed": changed,
        "displacement": displacement,
        "scale": power_of_two(displacement) / units.length,
        "boxes": PressedBoxes.of(lane, units),
    }
