"""``multibody-xval run NAME``: what was asked, numbers beside what is expected, one sentence, files, exit codes."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.scenario import TRANSMITTANCE, Scenario, steady_steps
from multibody_xval.scenarios.model import Config, Run, failed, unsupported
from multibody_xval.scenarios.store import opened
from tests.scenarios.stores import CASE, OTHER, with_bound, write_store

NAME = "two-points"

SCENARIO = Scenario(
    name=NAME, question="Does it move as it should?", expects="the exact motion", source="Of a test",
    cases={"soft": CASE, "loud": OTHER}, quantities=(TRANSMITTANCE,), steps=steady_steps,
)  # fmt: skip

SOUND = {CASE: with_bound(1.0), OTHER: with_bound(1.0, OTHER)}
WRONG = SOUND | {OTHER: with_bound(1.01, OTHER)}

STORE = ("--no-run", "--store=s.sqlite")


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A catalogue with one more scenario, an empty folder, and a terminal of 80 columns."""
    monkeypatch.setitem(SCENARIOS, NAME, SCENARIO)  # type: ignore[arg-type]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")


def shown(capsys, *words: str) -> tuple[int, str]:
    """Run a command, and give its exit code and what it printed, in one line."""
    code = run_command(app, ["run", NAME, *words])
    printed = capsys.readouterr()
    return code, " ".join((printed.err + printed.out).split())


def stored(capsys, results: dict, *words: str) -> tuple[int, str]:
    """Show results of an engine from a store."""
    write_store(Path("s.sqlite"), results)
    return shown(capsys, *STORE, *words)


def test_every_scenario_is_listed_with_its_question_and_tables_fit_80_columns(capsys) -> None:
    write_store(Path("s.sqlite"), WRONG)
    for words in (["run"], ["engines"], ["run", NAME, "--details", *STORE]):
        assert run_command(app, words) in (0, 1)
        printed = capsys.readouterr().out
        assert max(len(line) for line in printed.splitlines() if set(line.strip()) == {"─"}) <= 80
        assert words != ["run"] or all(own.name in printed for own in SCENARIOS.values())
    assert "Does it move as it should?" in " ".join(printed.split())


def test_a_sound_engine_agrees_in_one_sentence_at_the_end(capsys) -> None:
    code, printed = stored(capsys, SOUND, "--out=sound.md")
    assert code == 0
    asked = "two-points: Does it move as it should? 2 cases: soft; loud. 400 time steps per period."
    assert printed.startswith(f"{asked} Expected: the exact motion. mujoco:joint:tuned")
    assert "Source: Of a test" in shown(capsys, *STORE, "--details")[1]
    assert printed.endswith("mujoco:joint:tuned agrees with what is expected in all 2 numbers.")
    assert Path("sound.md").read_text(encoding="utf-8").startswith("## Scenarios: pass\n")


def test_many_configurations_fit_one_screen_and_the_worst_distance_of_each_is_seen(capsys) -> None:
    """With a table for each of nine they would take 70 lines; the last line is the finding."""
    write_store(Path("s.sqlite"), SOUND)
    with opened(Path("s.sqlite")) as store:
        for size in range(1, 9):
            own = Config.parse(f"mujoco:joint:tuned:iterations={size}")
            store.add({Run(own, case, 400): WRONG[case] for case in WRONG})
    assert run_command(app, ["run", NAME, *STORE]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= 40
    assert max(map(len, lines)) <= 80
    far = SOUND[OTHER].transmittance - WRONG[OTHER].transmittance
    assert sum(f"{abs(far):.2g}" in line and "1/2" in line for line in lines) == 8
    assert ("It fails" in "".join(lines[-6:]), lines[-1][-12:]) == (True, " and 5 more.")


def test_friction_that_is_a_hundredth_too_strong_fails_in_every_format(capsys) -> None:
    code, printed = stored(capsys, WRONG, "--out=a.csv", "--out=a.json", "--out=a.md")
    assert code == 1
    assert "loud 1 of 2 cases" in printed, "its worst case is shown"
    assert "It fails: mujoco:joint:tuned: 1 of 2 numbers deviate, by up to" in printed
    (soft, loud) = csv.DictReader(Path("a.csv").read_text().splitlines())
    assert float(soft["value"]) == pytest.approx(abs(SOUND[CASE].transmittance))
    assert float(soft["value_phase_deg"]) == pytest.approx(SOUND[CASE].phase_deg)
    assert [soft["verdict"], loud["verdict"]] == ["agrees", "deviates"]
    assert json.loads(Path("a.json").read_text())["passes"] is False
    assert Path("a.md").read_text().startswith("## Scenarios: fail\n\nIt fails: mujoco:joint:tuned: 1 of 2")


def test_transitions_of_what_was_asked_are_a_row_each(capsys) -> None:
    moving = SOUND | {CASE: replace(SOUND[CASE], transitions=((0, 0.25, "stick"), (2, 0.5, "forward slip")))}
    assert stored(capsys, moving, "--transitions=t.csv")[0] == 0
    rows = [row for row in csv.DictReader(Path("t.csv").read_text().splitlines()) if row["case"] == "soft"]
    told = [(row["configuration"], row["cell"], row["time"], row["mode"]) for row in rows]
    assert told == [("mujoco:joint:tuned", "0", "0.25", "stick"), ("mujoco:joint:tuned", "2", "0.5", "forward slip")]


def test_what_an_engine_cannot_represent_is_said_and_does_not_fail_and_what_is_missing_does(capsys) -> None:
    code, printed = stored(capsys, dict.fromkeys(SOUND, unsupported("it takes no such force")))
    assert (code, "mujoco:joint:tuned: unsupported in 2 cases: it takes no such force" in printed) == (0, True)
    Path("s.sqlite").unlink()
    code, printed = stored(capsys, {CASE: SOUND[CASE]})
    assert (code, "It fails: mujoco:joint:tuned: 1 of 2 numbers are missing." in printed) == (1, True)


def test_a_measured_preset_fails_where_it_was_named_and_often_crashes_and_is_never_judged(capsys) -> None:
    def add(results: dict) -> None:
        with opened(Path("s.sqlite")) as store:
            default = Config("mujoco", preset_name="default")
            store.add({Run(default, case, 400): result for case, result in results.items()})

    add(dict.fromkeys(SOUND, failed("it crashed")))
    code, printed = stored(capsys, SOUND)
    assert (code, "mujoco:joint:default: failed in 2 cases: it crashed" in printed) == (0, True)
    named = (*STORE, "--engine=mujoco:joint:default", "--out=measured.md")
    code, printed = shown(capsys, *named)
    assert code == 1
    assert printed.endswith("It fails: mujoco:joint:default: 2 of 2 numbers failed: it crashed.")
    add(WRONG)
    code, printed = shown(capsys, *named)
    assert (code, "Nothing was judged, errors were measured: of 2 numbers" in printed) == (0, True)
    assert Path("measured.md").read_text(encoding="utf-8").startswith("## Scenarios: nothing judged\n")
