"""Tasks with a chain whose contacts are inclined to the row."""

from dataclasses import dataclass

from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from scenarios.tasks.parameters import Modulation
from scenarios.tasks.transient import TransientTask


@dataclass(frozen=True, kw_only=True)
class InclinedTask(TransientTask):
    """The motion of a chain, from rest, whose normal forces depend on it.

    Parameters
    ----------
    base
        A harmonic one, whose frequency the modulation refers to.
    inclination
        α of the contact faces to the row [rad].
    modulation
        How the force that presses along the normals changes.
    variant, ratios, friction_ratio, time_step, steps, every
        As for `TransientTask`. What is recorded is the contacts.
    """

    base: HarmonicBase
    inclination: float
    modulation: Modulation
    recorded: str = "contact modes"

    def lane(self) -> Lane:
        """Build the chain under its drive and its preload."""
        preload: Preload = self.modulation.preload(self.base)
        return Lane(self.chain, self.base, self.time_step, preload, inclination=self.inclination)

    def unsupported_reason(self) -> str | None:
        """Give the reason why the variant cannot incline its contacts; ``None`` without one."""
        return self.variant.preset.unsupported_reason(self.lane(), str(self.variant))

    def content(self) -> dict[str, object]:
        """Everything that the result depends on: the options are those under a preload."""
        options = self.variant.preset.modulated().options
        return super().content() | {"options": {name: repr(option.value) for name, option in sorted(options.items())}}
