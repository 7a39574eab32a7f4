"""The README's Python examples run as they stand, one after the other, and print what they promise."""

import re
from pathlib import Path

import pytest

README = (Path(__file__).parents[1] / "README.md").read_text()
EXAMPLES = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)


def test_examples_run_in_order(capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, object] = {}
    for example in EXAMPLES:
        exec(compile(example, "README.md", "exec"), names)
    printed = capsys.readouterr().out
    assert re.search(r"-9\.56\d ± 0\.00\d dB, residual \d+e-\d+", printed)
    assert re.search(r"open for \d+% of the time", printed)


def test_every_command_is_one_of_the_suite() -> None:
    commands = re.findall(r"python -m (\w+)", README)
    assert set(commands) == {"reference_lcp", "engines", "scenarios", "reports", "pytest"}
