"""No encoding of a terminal, no setting of matplotlib and no text of others ends a command or is obeyed."""

import io
import sys

import pytest

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode

LINES = ["reference --help", "reference --cells 2", "engines", "run", "example", "run all --help"]


@pytest.mark.parametrize("line", LINES)
def test_an_output_without_greek_letters_ends_no_command(monkeypatch, line) -> None:
    for stream in ("stdout", "stderr"):
        monkeypatch.setattr(sys, stream, io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    assert run_command(app, line.split()) == 0
    sys.stdout.flush()
    assert sys.stdout.buffer.getvalue()


@pytest.mark.parametrize("text", ["\x1b[2J", "\x9b2J", "\r", "\n", "\x00", "\u202e", "\u2028", "\udcff"])
def test_a_character_that_controls_a_terminal_becomes_letters_and_letters_of_all_languages_stay(text) -> None:
    assert visible(f"摩擦{text}μ") == "摩擦" + text.encode("unicode_escape").decode() + "μ"


def test_a_message_about_a_strangers_file_is_one_line_that_no_terminal_obeys(tmp_path, capsys) -> None:
    file = tmp_path / "hostile.toml"
    file.write_text(
        'engines = ["\\u001b]0;owned\\u0007\\nerror: fine"]\n[grid]\nfriction_ratio = [0]\nfrequency_ratio = [1]'
    )
    assert run_command(app, ["sweep", str(file)]) == ExitCode.WRONG_INPUT
    printed = capsys.readouterr().err
    assert "\x1b" not in printed
    assert len(printed.splitlines()) == 1
