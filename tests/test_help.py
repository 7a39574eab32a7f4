"""Every command explains itself: what it does, with an example that can be typed."""

import pytest

from multibody_xval.reports.cli import console_script


def commands():
    """Every command of the suite, with its path as it is typed."""
    for name in console_script.COMMANDS:
        yield from below(f"multibody-xval {name}", console_script.loaded(name))


def below(path, command):
    yield path, command
    if hasattr(command, "list_commands"):
        for name in command.list_commands(None):
            yield from below(f"{path} {name}", command.get_command(None, name))


COMMANDS = dict(commands())


@pytest.mark.parametrize("path", COMMANDS)
def test_help_says_what_the_command_does_with_an_example(path) -> None:
    command = COMMANDS[path]
    assert command.help
    if not hasattr(command, "commands") or command.invoke_without_command:
        assert f"Example: {path}" in " ".join(command.help.split())
