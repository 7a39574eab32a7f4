"""Every command explains itself: what it does, each option, and an example that can be typed."""

import pytest

from multibody_xval.reports.cli import console_script
from tests.test_mistakes import COMMAND_LINES


def commands():
    """Every command of the suite, with its path as it is typed."""
    for name in console_script.COMMANDS:
        yield from below(f"multibody-xval {name}", console_script.loaded(name))


def below(path, command):
    yield path, command
    for name, child in getattr(command, "commands", {}).items():
        yield from below(f"{path} {name}", child)


COMMANDS = dict(commands())


def test_suite_has_its_commands() -> None:
    expected = {
        "reference",
        "reference bench",
        "engines",
        "sweep",
        "run accuracy",
        "report",
    }
    assert {f"multibody-xval {name}" for name in expected} <= set(COMMANDS)


@pytest.mark.parametrize("path", COMMANDS)
def test_help_says_what_the_command_does_with_an_example(path) -> None:
    command = COMMANDS[path]
    assert command.help
    if not hasattr(command, "commands") or command.invoke_without_command:
        assert f"Example: {path}" in " ".join(command.help.split())


@pytest.mark.parametrize("path", COMMANDS)
def test_every_option_has_a_help_that_is_a_sentence(path) -> None:
    for option in COMMANDS[path].params:
        text = getattr(option, "help", None)
        assert text, f"{path} {option.name}"
        assert text[0].isupper() or text.startswith("c_"), text
        assert text.rstrip().endswith((".", ")"))
        assert "[" not in text.replace("[default", ""), "rich would take it for markup"


def commands_without_mistake(lines):
    """Commands that take something and with which no line makes a mistake."""
    tried = {path for line in lines for path in COMMANDS if f"multibody-xval {line} ".startswith(f"{path} ")}
    return {path for path, command in COMMANDS.items() if command.params} - tried


def test_a_mistake_is_tried_with_every_command() -> None:
    lines = [line for line, _ in COMMAND_LINES]
    assert commands_without_mistake(lines) == set()
    fewer = [line for line in lines if not line.startswith("sweep")]
    assert commands_without_mistake(fewer) == {"multibody-xval sweep"}
