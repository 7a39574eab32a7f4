"""Mistakes that people make at the command line: each is one line with value and what to do, and nothing is lost."""

import re
import shlex
import shutil
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import pytest

from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.catalogue.chains.records import EXAMPLE
from multibody_xval.scenarios.model import REFERENCE, Run
from multibody_xval.scenarios.store import Store, opened
from tests.scenarios.stores import CASE, STEPS, with_bound, write_store

COMMAND_LINES = [
    ("reprot --quick", r"No such command 'reprot'.*Did you mean 'report'"),
    ("engines --jason", r"No such option.*--json"),
    ("truth show block-stop", r"problem = 'block-stop' is unknown; .*did you mean block-stops\?"),
    ("truth check block-stops sweep.toml", r"columns of sweep.toml = .* lack time; allowed: 'time, x0'"),
    ("history mujocko", r"engine = 'mujocko' is unknown; allowed: dart, .*did you mean mujoco\?"),
    ("recipe siconos", r"engine = siconos has no recipe: it has no options to recommend; allowed: .*mujoco"),
    # the reference
    ("reference --friction-ratio -0.1", r"friction_ratio = -0.1.*>= 0"),
    ("reference --frequency-ratio nan", r"frequency_ratio = nan .*allowed: > 0, 1e-12 to 1e\+12"),
    ("reference --cells 2.5", r"--cells = '2.5' is not a whole number; allowed: a whole number"),
    ("reference --steps-per-period 3", r"steps_per_period = 3 .*>= 16"),
    ("reference --steps-per-period 15 --solver exact", r"steps_per_period = 15 .*>= 16"),
    ("reference --tolerance 0", r"tolerance = 0.*> 0"),
    ("reference --friction 0.3", r"No such option.*--friction-ratio"),
    ("reference coverage", r"coverage"),
    ("reference --proof --cells 101", r"cells = 101.*1 to 100"),
    ("reference --plot missing/period.png", r"the folder missing does not exist"),
    ("reference --cells 100000 --plot period", r"--plot = period has the ending ''; allowed: .pdf"),
    ("reference --cells 100000 --error-bar", r"cells = 100000 is more than an error bar takes; allowed: <= 1000"),
    ("reference --mass-ratio 1e9", r"needs 1.21e\+06 steps; allowed: <= 1000000, as with a frequency 1.21 times"),
    ("reference --frequency-ratio 1e-9", r"a period of .* needs .* steps; allowed: .*<= 1000000"),
    ("reference --base-amplitude 1e308", r"base_amplitude = 1e\+308.*1e-24 to 1e\+24"),
    (f"reference --cells {'9' * 4301}", r"--cells.*integer"),
    (f"reference --plot {'x' * 400}.png", r"File name too long"),
    # engines, presets and options
    ("run accuracy --engine mujoco:glue", r"formulation of mujoco = 'glue' is unknown; .*joint"),
    ("run accuracy --engine mujoco:joint:best", r"preset of mujoco = 'best' is unknown; allowed: .*tuned"),
    ("run accuracy --engine a:b:c:d", r"has 4 parts; allowed: ENGINE"),
    ("run accuracy --engine mujoco --set sweeps=3", r"option 'sweeps' cannot be set in mujoco:joint:tuned; "),
    ("run laws --engine mujoco --set cone=flat", r"cone = 'flat' of .*; allowed: elliptic or pyramidal"),
    ("run static-hold --engine mujoco --set x", r"--set 'x' sets no value; allowed: OPTION=VALUE"),
    ("report --engine mujoco --engine dart --set a=3", r"--set a=3 beside 2 --engine; allowed: one"),
    ("report --engine mujoco:all --set cone=elliptic", r"sets cone=elliptic in several variants; allowed: in one"),
    ("report --engine mujoco@3.3.7 --quick", r"engine = 'mujoco@3.3.7' is unknown; allowed: .*; did you mean mujoco"),
    # run
    ("run unit-sell", r"No such command 'unit-sell'. Did you mean 'unit-cell'"),
    ("run unit-cell accuracy", r"unit-cell with accuracy; allowed: scenarios together, or accuracy alone"),
    ("run unit-cell unit-sell", r"scenario = 'unit-sell' is unknown; allowed: .* did you mean unit-cell\?"),
    ("run unit-cell --out missing/numbers.md", r"the folder missing does not exist"),
    ("run unit-cell --series rows.csv", r"--series = rows.csv without --store; allowed: with a store"),
    ("run unit-cell --store before.sqlite --series rows.md", r"--series = rows.md has the ending '.md'; allowed: .csv"),
    ("run unit-cell --no-run", r"--no-run without --store"),
    ("run unit-cell --no-run --store none.sqlite", r"store none.sqlite is no file"),
    ("run unit-cell --no-run --store before.sqlite", r"store before.sqlite holds no results of unit-cell; allowed: "),
    ("run unit-cell --store ''", r"--store = '' is empty; allowed: "),
    ("run record --record sweep.toml", r"sweep.toml"),
    ("run all --workers 0", r"workers = 0.*>= 1"),
    ("run proofs --sample 0", r"sample = 0.*>= 1"),
    ("run figure3 --out text.sqlite", r"--out = text.sqlite cannot be made: File exists"),
    ("run figure3 --out /proc/figure3", r"--out = /proc/figure3 cannot be made"),
    ("run figure3 --engine mujocko", r"engine = 'mujocko' is unknown; allowed: .*; did you mean mujoco"),
    ("run figure3 --no-run", r"store figure3/results.sqlite is no file"),
    ("run friction-map --engine exudyn-bristle", r"engine = exudyn-bristle has no scenes of boxes"),
    ("run friction-map --engine mujoco:contact:tuned", r"preset = tuned is for the chain; allowed in scenes"),
    ("run friction-map --out map.json", r"--out = map.json has the ending '.json'"),
    ("run work-precision --steps 400 --steps 1000001", r"steps = 1000001.*16 to 1000000"),
    ("run work-precision --workers 2 --scheduler tcp://127.0.0.1:1", r"allowed: one of the two"),
    # compare
    ("compare --engine=mujoco", r"0 stores and 1 --engine; allowed: two stores"),
    ("compare before.sqlite --engine=mujoco --engine=pybullet", r"1 stores and 2 --engine"),
    ("compare before.sqlite now.sqlite --store=kept.csv", r"--store = kept.csv with two stores"),
    ("compare before.sqlite now.sqlite --workers=1", r"--workers = 1 with two stores, of which nothing is computed"),
    ("compare before.sqlite now.sqlite --db=0", r"db = 0 is outside its range; allowed: > 0, 0.001 to 1000"),
    ("compare before.sqlite alone.sqlite", r"alone.sqlite \(of no engine\) have no point in common; allowed: stores"),
    ("compare before.sqlite now.sqlite --out=changes.doc", r"ending '.doc'; allowed: .md or .json or .csv"),
    # reproduce and probe
    ("reproduce mujoco free-decay", r"scenario = 'free-decay'.*static-hold"),
    ("reproduce mujoco static-hold '2 kg'", r"case = '2 kg'.*1 kg, load 0.99"),
    ("reproduce mujoco static-above-kinetic", r"static_ratio = 1\.5: mujoco cannot set static friction of its own"),
    ("reproduce reference static-hold", r"reference has no reproducer; allowed: .*mujoco:joint.*pybullet:contact"),
    ("reproduce mujoco:noslip_iterations=3 static-hold", r"mujoco:noslip_iterations=3 has no reproducer"),
    ("reproduce mujoco:contact:tuned slope-hold", r"preset = tuned is for the chain"),
    ("reproduce mujoco:contact:default slope-hold 'load 2'", r"case = 'load 2' is unknown; allowed: load 0.1"),
    ("probe none.xml", r"MODEL = 'none.xml' does not load"),
    ("probe none.xml --time 0", r"time = 0 is outside its range; allowed: > 0"),
    ("probe grip.xml --ctrl record.csv", r"ctrl = 'record.csv', line 2: 2 columns; allowed: 3, time and 2 controls"),
    ("probe grip.xml --keyframe x", r"keyframe = 'x' is unknown; allowed: grasp, none"),
    # sweep
    ("sweep", r"Missing argument 'file'"),
    ("sweep ''", r"an argument = '' is empty; allowed: "),
    ("sweep /dev/zero", r"more than 10000000 bytes"),
    ("sweep sweep.toml --time-limit 1e300", r"time_limit = 1e\+300 .*allowed: > 0, 1e-06 to 1e\+06"),
    ("sweep sweep.toml --out sweep.xls", r"ending '.xls'; allowed: .nc or .csv"),
    ("sweep sweep.toml --out=", r"--out = '' is empty; allowed: "),
    ("sweep sweep.toml --store foreign.sqlite", r"store foreign.sqlite is no store of this suite; allowed: "),
    ("sweep sweep.toml --scheduler nowhere", r"scheduler = 'nowhere'"),
    ("sweep sweep.toml --no-run --retry-failed", r"--retry-failed"),
    ("sweep large.toml --yes --out large.nc", r"0,000,000 points, .* h of .*allowed: <= 1,000,000 points"),
    # report
    ("report --sweep large.toml", r"0,000,000 points, .* h of .*allowed: <= 1,000,000 points"),
    ("report --quick --out text.sqlite", r"--out = text.sqlite cannot be made"),
    ("report --store before.sqlite --store now.sqlite", r"--store is given 2 times"),
    ("report --sweep sweep.toml --engine mujoco", r"neither --engine nor --quick"),
    ("report --data sweep.toml --quick", r"allowed next to it: --out alone"),
    ("report --data sweep.toml", r"the ending '.toml'"),
    ("report --no-run --quick", r"allowed without it: --quick"),
    ("report --time-limit 0", r"time_limit = 0"),
]

ONTO_WHAT_IS_USED = [
    "sweep sweep.toml --store kept.csv --out kept.csv",
    "sweep sweep.toml --store kept.csv --out link.csv",
    "sweep sweep.toml --store link.csv --out kept.csv",
    "sweep sweep.toml --store hard.csv --out kept.csv",
    "sweep sweep.toml --store fresh.csv --out ./fresh.csv",
    "sweep sweep.csv --out sweep.csv",
    "run unit-cell --engine reference --store kept.csv --out kept.csv",
    "run record --engine reference --record record.csv --out record.csv",
    "run accuracy --engine reference --store kept.csv --out kept.csv",
    "compare kept.csv hard.csv --out link.csv",
    "report --quick --store rep/points.csv --out rep",
    "report --quick --store rep/figures/store.sqlite --out rep",
    "report --sweep rep/errors.csv --out rep",
]
"""Outputs that would take the place of what the command reads or keeps."""

LINES = [*COMMAND_LINES, *((line, "allowed: ") for line in ONTO_WHAT_IS_USED)]

SWEEP = """
engines = ["reference:joint"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.9]
"""

LARGE = SWEEP.replace("[0.3]", "{ first = 0.1, last = 1.0, points = 1000 }").replace(
    "[0.9]", "{ first = 0.3, last = 1.6, points = 10000 }"
)

SWEEP_TEXTS = [
    ("engines = [", r"is no TOML"),
    ("steps_per_period = " + "9" * 4301 + SWEEP, r"is no TOML: .*4300 digits"),
    ("engines = " + "[" * 3000 + "]" * 3000, r"is no TOML: arrays and tables in one another"),
    (SWEEP.replace("[0.9]", "[1e-320]"), r"grid.frequency_ratio = .*e-321.*allowed: > 0, 1e-12 to 1e\+12"),
]
"""What files have beside what `tests/scenarios/sweeps/test_sweep_file.py` gives as tables."""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of sweeps, stores under several names, a record, a model, and what is called a store and is none."""
    folder = tmp_path_factory.mktemp("mistakes")
    for name in ("rep/figures", "folder"):
        (folder / name).mkdir(parents=True)
    for name in ("sweep.toml", "sweep.csv", "rep/errors.csv"):
        (folder / name).write_text(SWEEP)
    (folder / "large.toml").write_text(LARGE)
    (folder / "text.sqlite").write_text("no database, but long enough to be looked at as one " * 40)
    with sqlite3.connect(folder / "foreign.sqlite") as foreign:
        foreign.execute("CREATE TABLE addresses (name TEXT)")
    foreign.close()
    for name in ("before", "now"):
        write_store(folder / f"{name}.sqlite", {CASE: with_bound(1.0)})
    with opened(folder / "alone.sqlite") as store:
        store.add({Run(REFERENCE, CASE, 3 * STEPS): with_bound(1.0)})
    Store(folder / "kept.csv").close()
    (folder / "link.csv").symlink_to("kept.csv")
    (folder / "hard.csv").hardlink_to(folder / "kept.csv")
    shutil.copy(EXAMPLE, folder / "record.csv")
    shutil.copy(Path(__file__).parent / "reports/cli/probe_models/grip.xml", folder)
    return folder


def files_in(folder: Path) -> dict[Path, bytes | None]:
    """Everything below a folder with its content, but for SQLite's header, which counts who has opened a store."""
    skipped = {".sqlite": 100}
    return {
        file: file.read_bytes()[skipped.get(file.suffix, 0) :] if file.is_file() else None for file in folder.rglob("*")
    }


@pytest.fixture
def folder(made: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Go into the folder, where nothing is computed and nothing changes."""
    missing = "multibody_xval.scenarios.running.evaluate.run_missing"
    monkeypatch.setattr(missing, lambda *_, **__: pytest.fail("computed"))
    monkeypatch.chdir(made)
    before = files_in(made)
    yield made
    assert files_in(made) == before


def refusal(line: str, capsys: pytest.CaptureFixture[str]) -> str:
    """Give the one line with which a command line is refused."""
    name, *arguments = shlex.split(line)
    assert run_command(app, [name, *arguments]) == ExitCode.WRONG_INPUT
    printed = capsys.readouterr()
    assert printed.err.startswith("error: ")
    assert (printed.out, len(printed.err.splitlines())) == ("", 1)
    return printed.err


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(("line", "message"), LINES, ids=[line[:60] for line, _ in LINES])
def test_wrong_command_line_is_refused_with_its_value(capsys, line: str, message: str) -> None:
    printed = refusal(line, capsys)
    assert re.search(message, printed), printed


@pytest.mark.parametrize(("content", "message"), SWEEP_TEXTS, ids=[message for _, message in SWEEP_TEXTS])
def test_wrong_sweep_file_is_refused_with_file_key_and_value(tmp_path, capsys, content: str, message: str) -> None:
    (tmp_path / "mine.toml").write_text(content)
    printed = refusal(f"sweep {tmp_path / 'mine.toml'}", capsys)
    assert re.search(rf"mine\.toml.*{message}", printed), printed
    assert [own.name for own in tmp_path.iterdir()] == ["mine.toml"]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    "line",
    [
        "report --engine mujoco:joint:default", "reproduce mujoco:joint:default static-hold",
        "run all --engine reference --engine mujoco", "run accuracy --engine mujoco", "sweep named.toml",
    ],
)  # fmt: skip
def test_an_engine_that_is_named_and_missing_is_wrong_input_before_any_work(
    tmp_path, monkeypatch, capsys, line
) -> None:
    (tmp_path / "named.toml").write_text(SWEEP.replace("reference", "mujoco"))
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _: "no wheel")
    printed = refusal(line.replace("named.toml", str(tmp_path / "named.toml")), capsys)
    assert "engine = mujoco is not installed: no wheel" in printed
