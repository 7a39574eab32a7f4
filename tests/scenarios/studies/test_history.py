"""History of engines: what changed between versions, and bisection, with invented versions and with released ones."""

import json
import math
import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from reference_lcp.errors import ParameterError, RunError
from reference_lcp.process import run_command
from reports.cli import history as command
from reports.cli.console_script import app
from scenarios.studies import history as module
from scenarios.studies.history import (
    ENGINES,
    PROBLEMS,
    SCRIPTS,
    History,
    ReleasedVersion,
    VersionNumbers,
    changes,
    check_room,
    differs,
    first_change,
    history_document,
    metrics_of,
    releases,
)

HELD = "joint block-held velocity"
POINT = "rapier:joint:default figure3 [dB]"
VERSIONS = [ReleasedVersion(f"1.{number}", "2026-01-01", 1000) for number in range(9)]


def measured(version, **numbers):
    return VersionNumbers(version, "2026-01-01", {HELD: 1e-3} | numbers)


def of_value(change_at, before=1e-3, after=2e-3, silent=()):
    """A number that changes at a version, which some versions do not give."""
    asked = []

    def number(release):
        place = VERSIONS.index(release)
        asked.append(place)
        return math.nan if place in silent else (before if place < change_at else after)

    return number, asked


@pytest.mark.parametrize("change_at", range(1, 9))
def test_bisection_finds_every_place_of_a_change_with_few_versions(change_at):
    number, asked = of_value(change_at)
    before, after, old, new = first_change(VERSIONS, number)
    assert (before, after) == (VERSIONS[change_at - 1], VERSIONS[change_at])
    assert (old, new) == (1e-3, 2e-3)
    assert len(asked) <= 2 + math.ceil(math.log2(8))


def test_bisection_steps_over_versions_that_say_nothing():
    number, _ = of_value(6, silent=(3, 4, 5))
    before, after, *_ = first_change(VERSIONS, number)
    assert (before.version, after.version) == ("1.2", "1.6")


def test_bisection_refuses_ends_that_agree_or_say_nothing():
    with pytest.raises(RunError, match=r"1.0 and 1.8 do not differ: 0.001 and 0.001"):
        first_change(VERSIONS, of_value(9)[0])
    with pytest.raises(RunError, match=r"1.8 does not give this number"):
        first_change(VERSIONS, of_value(3, silent=(8,))[0])


@pytest.mark.parametrize(
    ("old", "new", "different"),
    [
        (1e-3, 1e-3 * (1 + 0.9e-8), False),
        (1e-3, 1e-3 * (1 + 1.1e-8), True),
        (0.0, 0.9e-12, False),
        (0.0, 1.1e-12, True),
    ],
)
def test_round_off_is_no_change(old, new, different):
    assert differs(old, new) == differs(new, old) == different


def test_changes_are_between_versions_that_follow_each_other_and_say_something():
    other = "contact block-stops position"
    known = [
        measured("1.0", **{other: 1.0}),
        VersionNumbers("1.1", "", {}, "there is no wheel"),
        VersionNumbers("1.2", "", {HELD: 2e-3, other: 1.0}),
        VersionNumbers("1.3", "", {HELD: 5e-4, other: 1.0}),
    ]
    found = list(changes(known))
    assert [(one.metric, one.before, one.after, one.is_better) for one in found] == [
        (HELD, "1.0", "1.2", False),
        (HELD, "1.2", "1.3", True),
    ]
    assert str(found[0]) == "joint block-held velocity: 0.001 in 1.0, 0.002 in 1.2, worse"
    page = history_document("rapier", known)
    assert "| 1.0 | 1.2 | joint block-held velocity | 0.001 | 0.002 | worse by 0.001 |" in page
    assert "| joint block-held velocity | 0.001 (1.0); 0.002 (1.2); 0.0005 (1.3) |" in page
    assert "| contact block-stops position | 1 |" in page
    assert "| contact block-stops velocity | – |" in page
    assert "1.1: there is no wheel" in page
    assert "**1.2** changed as it comes: 1 of 16 numbers, by 0.5 of the error at most." in page
    assert "**1.3** changed as it comes: 1 of 16 numbers, by 0.8 of the error at most." in page


def test_versions_that_say_nothing_for_one_reason_are_named_together():
    silent = [VersionNumbers(f"0.{place}", "", {}, "no such joint") for place in range(3)]
    page = history_document("rapier", [*silent, measured("1.0"), VersionNumbers("1.1", "", {}, "no such joint")])
    assert page.count("no such joint") == 2
    assert "\n0.0 … 0.2: no such joint\n" in page
    assert "\n1.1: no such joint\n" in page


def test_what_changes_with_an_option_only_is_said_of_it() -> None:
    both = {HELD: 1e-3, f"{HELD}, exact": 1e-3}
    known = [VersionNumbers("1.0", "", both), VersionNumbers("1.1", "", both | {HELD: 2e-3})]
    page = history_document("mujoco", known)
    assert (
        "changed as it comes: 1 of 16 numbers, by 0.5 of the error at most; solver without tolerance: nothing." in page
    )
    assert "| joint block-held velocity | 0.001 (1.0); 0.002 (1.1) | 0.001 |" in page


def test_a_page_without_a_change_says_so():
    assert "Nothing has changed by more than 1e-08 of an error." in history_document("rapier", [measured("1.0")])


def test_a_killed_history_goes_on_where_it_was(tmp_path, monkeypatch):
    file, asked = tmp_path / "rapier.json", []

    def ask(engine, release, scripts):
        asked.append(release.version)
        if release.version == "1.2" and asked.count("1.2") == 1:
            raise KeyboardInterrupt
        return measured(release.version)

    monkeypatch.setattr(module, "measured", ask)
    with pytest.raises(KeyboardInterrupt):
        [History("rapier", file).of(release) for release in VERSIONS[:4]]
    again = History("rapier", file)
    assert [again.of(release).numbers[HELD] for release in VERSIONS[:4]] == [1e-3] * 4
    assert asked == ["1.0", "1.1", "1.2", "1.2", "1.3"]
    assert [one["version"] for one in json.loads(file.read_text())["versions"]] == ["1.0", "1.1", "1.2", "1.3"]


@pytest.mark.parametrize(
    "text", ["", "[]", '{"engine": "rapier"}', '{"engine": "rapier", "versions": [{"version": "1"}]}']
)
def test_a_file_that_is_no_history_is_refused(text, tmp_path):
    (tmp_path / "other.json").write_text(text)
    with pytest.raises(ParameterError, match=r"other.json is no history of an engine"):
        History("rapier", tmp_path / "other.json")


def test_a_history_of_another_engine_is_refused(tmp_path):
    (tmp_path / "other.json").write_text('{"engine": "mujoco", "versions": []}')
    with pytest.raises(ParameterError, match=r"is of 'mujoco'; allowed: rapier"):
        History("rapier", tmp_path / "other.json")


def test_a_disk_without_room_is_refused(tmp_path):
    with pytest.raises(ParameterError, match=r"MB left; allowed: >= .* MB"):
        check_room([ReleasedVersion("1.0", "", 10**18)], tmp_path)
    assert check_room([ReleasedVersion("1.0", "", 0)], tmp_path) == 500e6


WHEELS = [
    ("2.0", "2025-03-01", 30, "3.13"),
    ("1.10", "2025-02-01", 20, "3.11 3.13"),
    ("1.9", "2025-01-01", 10, "3.11"),
    ("1.8", "2024-01-01", 10, "3.9"),
]
"""Version, date, size, and the Pythons that have a wheel."""

INSTALLED = [
    {"implementation": name, "version_parts": {"major": 3, "minor": minor}}
    for name, minor in (("cpython", 9), ("cpython", 11), ("pypy", 10), ("cpython", 13))
]


def index_of(*arguments, given=""):
    """Answer as uv does of an index with these wheels."""
    if arguments[:2] == ("python", "list"):
        return json.dumps(INSTALLED)
    allowed, python = Requirement(given).specifier, arguments[arguments.index("--python-version") + 1]
    for version, date, size, wheels in WHEELS:
        if version in allowed and python in wheels.split():
            wheel = f"{{ upload-time = {date}T00:00:00Z, size = {size} }}"
            return f'[[packages]]\nname = "engine"\nversion = "{version}"\nwheels = [{wheel}]\n'
    raise ParameterError("there is no such version")


@pytest.fixture
def index(monkeypatch):
    monkeypatch.setattr(module, "run_uv", index_of)
    monkeypatch.setattr(module.sys, "version_info", (3, 11, 7))


@pytest.mark.usefixtures("index")
def test_versions_are_those_of_the_index_the_oldest_first():
    engine = ENGINES["rapier"]
    assert releases(engine) == [
        ReleasedVersion("1.8", "2024-01-01", 10, "3.9"),
        ReleasedVersion("1.9", "2025-01-01", 10, "3.11"),
        ReleasedVersion("1.10", "2025-02-01", 20, "3.11"),
        ReleasedVersion("2.0", "2025-03-01", 30, "3.13"),
    ]
    assert [one.version for one in releases(engine, "1.10")] == ["1.10", "2.0"]
    assert [one.version for one in releases(engine, None, "1.10")] == ["1.8", "1.9", "1.10"]
    with pytest.raises(
        ParameterError, match=r"of rapier3d from 3 to the last: none has a wheel here \(there is no such"
    ):
        releases(engine, "3")
    with pytest.raises(ParameterError, match=r"--from = 'new' is no version"):
        releases(engine, "new")


@pytest.mark.parametrize(("name", "dated"), [("rapier", False), ("mjx", True)])
def test_a_version_gets_the_python_of_its_wheel_and_packages_of_its_time_where_they_matter(name, dated, monkeypatch):
    asked = []

    def uv(*arguments, given=""):
        asked.append(arguments)
        if "install" in arguments:
            raise ParameterError("there is no network")

    monkeypatch.setattr(module, "run_uv", uv)
    found = module.measured(ENGINES[name], ReleasedVersion("3.2.3", "2024-09-16", 10, "3.9"))
    assert (found.python, found.reason, found.numbers) == ("3.9", "there is no network", {})
    (made, installed) = asked
    assert made[made.index("--python") + 1] == "3.9"
    assert installed[-2:] == ("--exclude-newer", "2024-09-23") if dated else "--exclude-newer" not in installed


def test_a_page_says_which_python_ran_which_versions():
    known = [VersionNumbers(f"1.{place}", "", {HELD: 1e-3}, "", python) for place, python in enumerate(["3.11"] * 2)]
    assert "Wheels" not in history_document("rapier", known)
    page = history_document("rapier", [*known, VersionNumbers("1.2", "", {HELD: 1e-3}, "", "3.13")])
    assert "Wheels: 1.0 … 1.1 with Python 3.11, 1.2 with Python 3.13." in page


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("print('an engine says hello')\nprint('creep: -15.25 µm/s (exact: -15)')", ({POINT: 0.25}, "")),
        ("print('transmittance: 2 (exact: 2.00000000001)')", ({POINT: 0.0}, "")),
        ("print('creep: nan µm/s (exact: 0)')", ({}, f"{POINT}: nan")),
        ("print('creep: 1 µm/s')", ({}, f"{POINT}: it prints no number")),
        ("raise AttributeError('no such joint')", ({}, f"{POINT}: AttributeError: no such joint")),
    ],
)
def test_a_script_that_reproduce_prints_gives_its_error_or_why_there_is_none(text, found):
    assert module._printed(ENGINES["rapier"], Path(sys.executable), POINT, text) == found


def test_a_page_has_the_scripts_beside_the_blocks_and_bisection_takes_their_names():
    known = [measured("1.0", **{POINT: 0.01}), measured("1.1", **{POINT: 0.02})]
    page = history_document("rapier", known)
    assert f"| {POINT} | 0.01 (1.0); 0.02 (1.1) |" in page
    assert "**1.1** changed as it comes: 1 of 17 numbers, by 0.5 of the error at most." in page
    history = History("rapier")
    with pytest.raises(ParameterError, match="metric = "):
        module.numbers_of(history, POINT)
    assert callable(module.numbers_of(history, POINT, [POINT]))


@pytest.mark.needs("mujoco")
def test_the_installed_version_writes_the_scripts_that_others_run():
    names = {
        "mujoco:joint:default figure3 [dB]",
        "mujoco:joint:default joint-hold [µrad/s]",
        "mujoco:contact:default figure3 [dB]",
        "mujoco:contact:default slope-hold [µm/s]",
        "mujoco:contact:default slide-to-stop [%]",
    }
    shown = command._shown(ENGINES["mujoco"])
    assert set(shown) == names
    (written,) = command._scripts({name: own for name, own in shown.items() if "slope-hold" in name}).values()
    assert "import mujoco" in written
    assert command._shown(ENGINES["mjx"]) == {}


def test_every_engine_has_its_script():
    assert {engine.script for engine in ENGINES.values()} | {"blocks.py"} == {
        file.name for file in SCRIPTS.glob("*.py")
    }
    assert len(metrics_of(ENGINES["mujoco"])) == 2 * 2 * 2 * len(PROBLEMS)


@pytest.mark.slow
def test_rapier_has_not_changed_since_its_first_wheels(tmp_path, capsys):
    store, page = tmp_path / "rapier.json", tmp_path / "rapier.md"
    command = ["history", "rapier", "--to", "0.36.1", "--store", str(store), "--out", str(page)]
    assert run_command(app, command) == 0
    assert "Nothing has changed by more than 1e-08 of an error." in page.read_text()
    assert capsys.readouterr().out == page.read_text()
    assert [one["version"] for one in json.loads(store.read_text())["versions"]] == ["0.36.0", "0.36.1"]


@pytest.mark.slow
def test_mujocos_stopping_rule_changed_at_3_11_0_and_its_law_did_not(tmp_path, capsys):
    command = ["bisect", "mujoco", "--from", "3.10.0", "--to", "3.12.0", "--store", str(tmp_path / "mujoco.json")]
    assert run_command(app, [*command, "--metric", "contact block-stops velocity"]) == 0
    before, after = capsys.readouterr().out.splitlines()
    assert "in 3.10.0 (" in before
    assert "in 3.11.0 (" in after
    assert run_command(app, [*command, "--metric", "contact block-stops velocity, exact"]) == 3
    assert "3.10.0 and 3.12.0 do not differ" in capsys.readouterr().err
