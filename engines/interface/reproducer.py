"""What an adapter contributes to a script that shows a number in the engine's own API, without the suite."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from multibody_xval.engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def no_numbers(_lane: Lane, _preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give nothing: the chain and the names of the options are all that a template needs."""
    return {}


class Reproducer(NamedTuple):
    """How one formulation of an engine is written as a script."""

    template: str
    """File beside the adapter: the blocks ``imports`` and ``simulation`` of jinja2. The second gives ``position``
    and ``velocity`` at the ends of the steps, shape (STEPS, 2 n) each, outer masses first. It reads the lists of the
    script (OUTER_MASS and so on, one number a cell), TIME_STEP, STEPS, POSITION, VELOCITY and the function ``load``,
    all in SI units."""
    numbers: Callable[[Lane, Preset, State], Mapping[str, Any]] = no_numbers
    """Gives what the template prints of a lane's options, and of the internal state at first, in SI units, by name.
    Its filter ``listed`` writes an array as a list."""
    own_units: bool = False
    """The engine is given numbers in the units of the preset, as `units.py.jinja` writes them, and not in SI units."""
    without: tuple[str, ...] = ()
    """Presets that the template does not write."""
