"""Every experiment of the suite, by name; each has a file of its own."""

from scenarios.catalogue.filtered_noise import FilteredNoiseScenario
from scenarios.catalogue.free_decay import FreeDecay
from scenarios.catalogue.record import Record
from scenarios.catalogue.ricker_pulse import RickerPulseScenario
from scenarios.catalogue.swept_sine import SweptSineScenario
from scenarios.scenario import Scenario

CATALOGUE: dict[str, Scenario] = {
    scenario.name: scenario
    for scenario in (FreeDecay(), RickerPulseScenario(), SweptSineScenario(), FilteredNoiseScenario(), Record())
}
