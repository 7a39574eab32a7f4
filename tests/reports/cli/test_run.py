"""``multibody-xval run NAME``: what was asked, numbers beside what is expected, one sentence, files, exit codes."""

import csv
import json
import sqlite3
from dataclasses import replace
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.run import STUDIES
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.scenario import TRANSMITTANCE, Scenario, steady_steps
from multibody_xval.scenarios.model import Config, Result, Run, Status, failed, unsupported
from multibody_xval.scenarios.running.evaluate import stored_results
from multibody_xval.scenarios.store import opened
from tests.scenarios.stores import CASE, OTHER, with_bound, write_store

NAME = "two-points"

SCENARIO = Scenario(
    name=NAME, question="Does it move as it should?", expects="the exact motion", source="Of a test",
    cases={"soft": CASE, "loud": OTHER}, quantities=(TRANSMITTANCE,), steps=steady_steps,
)  # fmt: skip

SOUND = {CASE: with_bound(1.0), OTHER: with_bound(1.0, OTHER)}
WRONG = SOUND | {OTHER: with_bound(1.01, OTHER)}


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A catalogue with one more scenario, an empty folder, and a terminal of 80 columns."""
    monkeypatch.setitem(SCENARIOS, NAME, SCENARIO)  # type: ignore[arg-type]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")


def shown(capsys, *words: str, of: str = NAME) -> tuple[int, str]:
    """Run a command, and give its exit code and what it printed, in one line."""
    code = run_command(app, ["run", of, *words])
    printed = capsys.readouterr()
    return code, " ".join((printed.err + printed.out).split())


def stored(capsys, results: dict, *words: str) -> tuple[int, str]:
    """Show results of an engine from a store."""
    write_store(Path("s.sqlite"), results)
    return shown(capsys, "--no-run", "--store=s.sqlite", *words)


def test_every_scenario_is_listed_with_its_question(capsys) -> None:
    assert run_command(app, ["run"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert all(own.name in printed for own in SCENARIOS.values())
    assert "Does it move as it should?" in printed


@pytest.mark.parametrize("line", ["run", "run --help"])
def test_a_measurement_is_listed_once_with_one_question(capsys, monkeypatch, line) -> None:
    """Of Figure 3 a scenario has a few points, under the same name."""
    monkeypatch.setenv("COLUMNS", "300")
    assert run_command(app, line.split()) == 0
    rows = [row.strip("│ ").split("  ", 1) for row in capsys.readouterr().out.splitlines()]
    for name, (_, question) in STUDIES.items():
        assert [row[1].strip() for row in rows if row[0] == name] == [question]


def test_a_sound_engine_agrees_in_one_sentence_at_the_end(capsys) -> None:
    code, printed = stored(capsys, SOUND)
    assert code == 0
    asked = "two-points: Does it move as it should? Source: Of a test Expected: the exact motion. 2 cases: soft; loud."
    assert printed.startswith(f"{asked} 400 time steps per period.")
    assert printed.endswith("mujoco:joint:tuned agrees with what is expected in all 2 numbers.")


def test_friction_that_is_a_hundredth_too_strong_fails_and_its_worst_case_is_shown(capsys) -> None:
    code, printed = stored(capsys, WRONG)
    assert code == 1
    assert "loud 1 of 2 cases" in printed
    assert " soft " not in printed.partition("transmittance")[2]
    assert "It fails: mujoco:joint:tuned: 1 of 2 numbers deviate, by up to" in printed
    assert "soft 1 of" not in printed


def test_every_number_is_shown_on_demand(capsys) -> None:
    _, printed = stored(capsys, WRONG, "--details")
    table = printed.partition("number, case")[2]
    assert table.index("agrees soft") < table.index("deviates loud")


def test_what_a_preset_that_shares_the_scheme_is_off_the_exact_value_is_said(capsys) -> None:
    _, printed = stored(capsys, SOUND)
    assert "Expected is the reference at equal time steps; those alone are off the exact values by: trans" in printed


def test_files_hold_amplitude_and_phase_of_every_number(capsys) -> None:
    code, _ = stored(capsys, WRONG, "--out=a.csv", "--out=a.json", "--out=a.md")
    (soft, loud) = csv.DictReader(Path("a.csv").read_text().splitlines())
    assert float(soft["value"]) == pytest.approx(abs(SOUND[CASE].transmittance))
    assert float(soft["value_phase_deg"]) == pytest.approx(SOUND[CASE].phase_deg)
    assert [soft["verdict"], loud["verdict"]] == ["agrees", "deviates"]
    content = json.loads(Path("a.json").read_text())
    assert (content["passes"], code) == (False, 1)
    assert [own["verdict"] for own in content["numbers"]] == ["agrees", "deviates"]
    assert Path("a.md").read_text().startswith("## Scenarios: fail\n\nIt fails: mujoco:joint:tuned: 1 of 2")


def test_transitions_of_what_was_asked_are_a_row_each(capsys) -> None:
    moving = SOUND | {CASE: replace(SOUND[CASE], transitions=((0, 0.25, "stick"), (2, 0.5, "forward slip")))}
    assert stored(capsys, moving, "--transitions=t.csv", "--series=s.csv")[0] == 0
    with Path("t.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["case"] == "soft"]
    assert [(row["cell"], row["time"], row["mode"]) for row in rows] == [
        ("0", "0.25", "stick"), ("2", "0.5", "forward slip"),
    ]  # fmt: skip
    assert {row["configuration"] for row in rows} == {"mujoco:joint:tuned"}
    assert Path("s.csv").read_text(encoding="utf-8").count("\n") == 1, "steady states have no rows"


def test_a_table_without_rows_says_why(capsys) -> None:
    _, printed = stored(capsys, SOUND, "--series=s.csv")
    assert "s.csv: no rows, since there are no series among these runs" in printed


def test_a_comment_on_measured_presets_does_not_say_that_they_pass(capsys) -> None:
    default = Run(Config("mujoco", preset_name="default"), CASE, 400)
    with opened(Path("s.sqlite")) as store:
        store.add({default: with_bound(1.1)})
    assert stored(capsys, {}, "--engine=mujoco:joint:default", "--out=measured.md")[0] == 0
    assert stored(capsys, SOUND, "--engine=mujoco", "--out=sound.md")[0] == 0
    first = [Path(name).read_text(encoding="utf-8").splitlines()[0] for name in ("measured.md", "sound.md")]
    assert first == ["## Scenarios: nothing judged", "## Scenarios: pass"]


def test_long_names_of_cases_are_whole_in_a_comment(capsys, monkeypatch) -> None:
    name = "1 t under 10 t, with a load of 0.99, shaken"
    monkeypatch.setitem(SCENARIOS, NAME, replace(SCENARIO, cases={name: CASE}))  # type: ignore[arg-type]
    stored(capsys, {CASE: SOUND[CASE]}, "--out=long.md")
    assert f"; {name} |" in Path("long.md").read_text(encoding="utf-8")


def test_what_an_engine_cannot_represent_is_said_and_does_not_fail(capsys) -> None:
    lacks = unsupported("its joints take no normal force that changes")
    code, printed = stored(capsys, dict.fromkeys(SOUND, lacks))
    assert code == 0
    assert "mujoco:joint:tuned: unsupported in 2 cases: its joints take no normal force that changes" in printed
    assert printed.endswith("none of these configurations supports what was asked.")


def add(config: Config, results: dict) -> None:
    with opened(Path("s.sqlite")) as store:
        store.add({Run(config, case, 400): result for case, result in results.items()})


DEFAULT = Config("mujoco", preset_name="default")


def test_a_measured_preset_fails_where_it_was_named_and_often_crashes(capsys) -> None:
    add(DEFAULT, dict.fromkeys(SOUND, failed("it crashed")))
    code, printed = stored(capsys, SOUND)
    assert (code, "mujoco:joint:default: failed in 2 cases: it crashed" in printed) == (0, True)
    code, printed = shown(capsys, "--no-run", "--store=s.sqlite", "--engine=mujoco:joint:default")
    assert code == 1
    assert printed.endswith("It fails: mujoco:joint:default: 2 of 2 numbers failed: it crashed.")


def test_measured_presets_alone_are_not_judged(capsys) -> None:
    add(DEFAULT, WRONG)
    code, printed = shown(capsys, "--no-run", "--store=s.sqlite")
    assert code == 0
    assert "Nothing was judged, errors were measured: of 2 numbers" in printed


def test_a_steady_state_that_is_not_found_is_missing(capsys) -> None:
    code, printed = stored(capsys, SOUND | {CASE: Result(status=Status.NOT_PERIODIC, reason="it hops")})
    assert code == 1
    assert "not periodic" in printed
    assert "1 of 2 numbers are missing" in printed


def test_what_a_store_lacks_is_not_run_and_missing(capsys) -> None:
    code, printed = stored(capsys, {CASE: SOUND[CASE]})
    assert code == 1
    assert "not run" in printed
    assert "It fails: mujoco:joint:tuned: 1 of 2 numbers are missing." in printed


def test_many_configurations_and_several_scenarios_have_a_row_each(capsys) -> None:
    write_store(Path("s.sqlite"), SOUND)
    for preset in ("default", "recommended"):
        add(Config("mujoco", preset_name=preset), WRONG)
    add(Config("pybullet"), SOUND)
    _, printed = shown(capsys, "--no-run", "--store=s.sqlite")
    assert "mujoco:joint:recommended 1 agree, 1 deviate (not judged)" in printed
    assert "worst case" not in printed
    _, printed = shown(capsys, "unit-cell", "--no-run", "--store=s.sqlite", "--engine=mujoco")
    assert "scenario, configuration" not in printed  # of one scenario alone are there results
    assert "2 agree" in printed


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("unit-sell", "No such command 'unit-sell'. Did you mean 'unit-cell'"),
        ("two-points accuracy", "two-points with accuracy; allowed: scenarios together, or accuracy alone"),
        ("two-points two-points laws --out a.md", "two-points with laws; allowed: scenarios together, or laws alone"),
        ("accuracy two-points", "accuracy with two-points; allowed: scenarios together, or accuracy alone"),
        ("figure3 proofs", "figure3 with proofs; allowed: scenarios together, or figure3 alone"),
        ("two-points unit-sell", "scenario = 'unit-sell' is unknown; allowed: .* did you mean unit-cell?"),
        ("two-points --engine mujocko", "engine = 'mujocko' is unknown"),
        ("two-points --out numbers.txt", "allowed: .md or .json or .csv"),
        ("two-points --out missing/numbers.md", "the folder missing does not exist"),
        ("two-points --series rows.csv", "--series = rows.csv without --store; allowed: with a store"),
        ("two-points --store s.sqlite --series rows.md", "--series = rows.md has the ending '.md'; allowed: .csv"),
        ("two-points --store s.sqlite --series a.csv --transitions a.csv", "a.csv"),
        ("two-points --workers 0", "workers = 0"),
        ("two-points --no-run", "--no-run without --store"),
        ("two-points --no-run --retry-failed", "--retry-failed with --no-run"),
        ("two-points --no-run --store none.sqlite", "store none.sqlite is no file"),
        ("two-points --no-run --store old.sqlite", "store old.sqlite has other tables than a store"),
        ("two-points --store old.sqlite", "store old.sqlite has other tables than a store"),
        ("unit-cell --no-run --store s.sqlite", "store s.sqlite holds no results of unit-cell; allowed: "),
        ("all --time-limit -1", "time_limit = -1"),
    ],
)
def test_wrong_input_is_one_line_before_any_work(capsys, monkeypatch, words, message) -> None:
    monkeypatch.setattr(
        "multibody_xval.scenarios.running.evaluate.run_missing", lambda *_, **__: pytest.fail("computed")
    )
    write_store(Path("s.sqlite"), SOUND)
    Path("old.sqlite").write_bytes(Path("s.sqlite").read_bytes())
    with sqlite3.connect("old.sqlite") as old:
        old.execute("ALTER TABLE results RENAME TO answers")
    assert run_command(app, ["run", *words.split()]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    first, _, last = message.partition(".* ")
    assert first in error
    assert last in error


@pytest.mark.parametrize(
    ("options", "kept"), [((), "nothing is kept without --store"), (("--store=k.sqlite",), "results are kept in ")]
)
def test_an_interrupted_run_says_what_is_kept(capsys, monkeypatch, options, kept) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("multibody_xval.scenarios.running.evaluate.run_missing", interrupted)
    code, printed = shown(capsys, "--engine=mujoco", *options)
    assert code == 130
    assert f"interrupted: {kept}" in printed


def test_a_scenario_may_follow_the_record_of_a_user(capsys, monkeypatch) -> None:
    own = replace(SCENARIO, name="follows", of_record=lambda file: replace(SCENARIO, question=f"Along {file}?"))
    monkeypatch.setitem(SCENARIOS, "follows", own)  # type: ignore[arg-type]
    write_store(Path("s.sqlite"), SOUND)
    _, printed = shown(capsys, "--no-run", "--store=s.sqlite", "--record=quake.csv", of="follows")
    assert "two-points: Along quake.csv?" in printed
    code, printed = shown(capsys, NAME, "--no-run", "--store=s.sqlite", "--record=quake.csv", of="follows")
    assert (code, "agrees with what is expected in all 4 numbers" in printed) == (0, True)


def test_what_was_run_is_kept_and_not_run_again(capsys, monkeypatch) -> None:
    code, printed = shown(capsys, "--engine=mujoco", "--workers=1", "--store=k.sqlite")
    assert code == 0
    assert printed.endswith("mujoco:joint:tuned agrees with what is expected in all 2 numbers.")
    assert {row.run.config.engine for row in stored_results(Path("k.sqlite"))} == {"mujoco", "reference"}
    monkeypatch.setattr("multibody_xval.scenarios.running.pool.run_batch", lambda _: pytest.fail("a known run is run"))
    assert shown(capsys, "--engine=mujoco", "--workers=1", "--store=k.sqlite")[0] == 0
