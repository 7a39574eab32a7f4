"""Presets from a file: what is derived, and what is refused in one line that names file, preset and key."""

from pathlib import Path

import pytest

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Formulation, NormalForce, Preset
from reference_lcp.errors import ParameterError

SOUND = """
[own]
sweeps = [10, "impulses are spread by sweeps."]
soft = { value = [0.9, 0.95], text = "Needed for this chain.", default = "none at all", fixed = true }

[tuned]
sweeps = [1, "One is exact."]

[joint]
normal_force = "modulated"

[joint.tuned]
about = "Exact."
shares_scheme = true

[joint.default]
about = "As it comes."

[joint.hard]
about = "Harder."
base = "tuned"
without = ["soft"]
accuracy = { drift = 0.5 }
accuracy_reason = "it is soft"
varied = { sweeps = [3, 4] }

[joint.hard.own]
rate = 1.0

[joint.hard.set]
rate = [{ formula = "-0.5(1/h)² 2h" }, "Stops in one step."]

[contact]
normal_force = "modulated until contacts open"

[contact.modulated]
landing = [0.02, "whatever the time step."]

[contact.tuned]
about = "Exact, too."

[contact.tuned.modulated]
landing = [{ formula = "2h" }, "In two steps."]
"""


def read(folder: Path, text: str) -> dict[Formulation, dict[str, Preset]]:
    file = folder / "presets.toml"
    file.write_text(text, encoding="utf-8")
    return presets_of(file, "Tiny")


def test_a_preset_is_what_it_changes_of_the_engines_own_values(tmp_path) -> None:
    joint = read(tmp_path, SOUND)[Formulation.JOINT]
    tuned, default, hard = joint["tuned"], joint["default"], joint["hard"]
    assert (tuned["sweeps"], default["sweeps"], hard["sweeps"]) == (1, 10, 1)
    assert (tuned.options["sweeps"].default, tuned.options["sweeps"].reason) == (10, "One is exact.")
    assert default.options["sweeps"].reason == "Tiny's own: impulses are spread by sweeps."
    soft = default.options["soft"]
    assert (soft.value, soft.default, soft.reason, soft.fixed) == (
        (0.9, 0.95), "none at all", "Needed for this chain.", True,
    )  # fmt: skip
    assert "soft" not in hard.options
    assert [each.optional for each in (tuned, default, hard)] == [False, False, True]
    assert [each.shares_scheme for each in (tuned, default, hard)] == [True, False, False]
    assert {each.normal_force for each in joint.values()} == {NormalForce.MODULATED}
    assert hard.varied == {"sweeps": (3, 4)}
    assert default["units"] == "SI"


def test_a_formula_is_a_number_at_every_time_step(tmp_path) -> None:
    presets = read(tmp_path, SOUND)
    hard, landing = presets[Formulation.JOINT]["hard"], presets[Formulation.CONTACT]["tuned"].modulated()
    assert hard.value("rate", 0.5) == (-2.0, 1.0)
    assert str(hard["rate"]) == "-0.5(1/h)² 2h"
    assert landing.value("landing", 0.01) == 0.02
    assert landing.options["landing"].default == 0.02


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("shares_scheme = true", "shares = true", "key of .*/presets.toml, joint:tuned = 'shares' is unknown"),
        ("[joint.hard.set]", "[joint.hard.set]\nsweep = [3, 'x']", "option of .*joint:hard.set = 'sweep' is unknown"),
        ("-0.5(1/h)²", "__import__('os')", "joint:hard.set: rate = .* is no formula"),
        ("rate = 1.0", "rate = 1.0\nrate = 2.0", "/presets.toml cannot be read: .*line"),
        ('about = "Harder."', "scenes_only = 'yes'", "joint:hard: scenes_only = 'yes'; allowed: true or false"),
        (
            'about = "Harder."',
            "judged = ['scene']",
            "joint:hard: judged = 'scene' is unknown; allowed: chain, blocks, sc",
        ),
        (
            'about = "Harder."',
            "scenes_only = true\njudged = ['chain']",
            "judged = 'chain' is unknown; allowed: scenes$",
        ),
        ('base = "tuned"', 'base = "turned"', "base of .*joint:hard = 'turned' is unknown; allowed: tuned, default"),
    ],
)
def test_a_mistake_is_one_line_with_file_preset_and_key(tmp_path, old, new, said) -> None:
    assert old in SOUND
    with pytest.raises(ParameterError, match=said) as problem:
        read(tmp_path, SOUND.replace(old, new, 1))
    assert "\n" not in str(problem.value)
