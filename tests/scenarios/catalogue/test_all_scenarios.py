"""The list of scenarios: each says what it asks, is found under its name, and has different cases."""

import re

from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS


def test_every_scenario_says_what_it_asks_and_is_found_under_its_name() -> None:
    for name, scenario in SCENARIOS.items():
        assert scenario.name == name
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name)
        assert scenario.question.endswith("?")
        assert scenario.source
        assert scenario.expects
        names = [quantity.name for quantity in scenario.quantities]
        assert len(set(names)) == len(names) > 0
        assert len(set(scenario.cases.values())) == len(scenario.cases) > 0
