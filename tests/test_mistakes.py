"""Mistakes that people make at the command line: each is refused before any work, with the value and what to do."""

import re
import shlex
import sqlite3
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode

COMMAND_LINES = [
    ("reference --friction-ratio -0.1", r"friction_ratio = -0.1.*>= 0"),
    ("reference --frequency-ratio nan", r"frequency_ratio = nan .*allowed: > 0, 1e-12 to 1e\+12"),
    ("reference --cells 2.5", r"--cells = '2.5' is not a whole number; allowed: a whole number"),
    ("reference --steps-per-period 3", r"steps_per_period = 3 .*>= 16"),
    ("reference --tolerance 0", r"tolerance = 0.*> 0"),
    ("reference --solver newton", r"solver = 'newton' is unknown; allowed: compiled, lemke, exact"),
    ("reference --friction 0.3", r"No such option.*--friction-ratio"),
    ("reference --friction-ratio lots", r"--friction-ratio = 'lots' is not a number; allowed: a number"),
    ("reference --proof --cells 101", r"cells = 101.*1 to 100"),
    ("reference --plot missing/period.png", r"the folder missing does not exist"),
    ("reference --cells 100000 --plot period", r"--plot = period has the ending ''; allowed: .pdf"),
    ("reference --cells 100001", r"cells = 100001 is outside its range; allowed: 1 to 100000"),
    ("reference --cells 100000 --error-bar", r"cells = 100000 is more than an error bar takes; allowed: <= 1000"),
    ("reference --cells 100000 --exact-value", r"cells = 100000 is more than an exact value takes; allowed: <= 500"),
    ("reference --cells 100000 --solver lemke", r"cells = 100000 is more than the solver 'lemke' takes; .* <= 100,"),
    ("reference --mass-ratio 1e9", r"needs 1.21e\+06 steps; allowed: <= 1000000, as with a frequency 1.21 times"),
    ("reference --frequency-ratio 1e-9", r"a period of .* needs .* steps; allowed: .*<= 1000000"),
    ("reference --base-amplitude 1e308", r"base_amplitude = 1e\+308.*1e-24 to 1e\+24"),
    (f"reference --cells {'9' * 4301}", r"--cells.*integer"),
    (f"reference --plot {'x' * 400}.png", r"File name too long"),
    ("truth show block-stop", r"problem = 'block-stop' is unknown; .*did you mean block-stops\?"),
    ("truth check block-stops sweep.toml", r"columns of sweep.toml = .* lack time; allowed: 'time, x0'"),
    ("history mujocko", r"engine = 'mujocko' is unknown; allowed: dart, .*did you mean mujoco\?"),
    ("engines --jason", r"No such option.*--json"),
    ("reprot --quick", r"No such command 'reprot'.*Did you mean 'report'"),
    ("run accuracy --engine mujoco:glue", r"formulation of mujoco = 'glue' is unknown; .*joint"),
    ("run accuracy --engine mujoco:joint:best", r"preset of mujoco = 'best' is unknown; allowed: .*tuned"),
    ("run accuracy --engine a:b:c:d", r"has 4 parts; allowed: ENGINE"),
    ("run accuracy --engine mujoco --set sweeps=3", r"option 'sweeps' cannot be set in mujoco:joint:tuned; "),
    ("run laws --engine mujoco --set cone=flat", r"cone = 'flat' of .*; allowed: elliptic or pyramidal"),
    ("run static-hold --engine mujoco --set x", r"--set 'x' sets no value; allowed: OPTION=VALUE"),
    ("report --engine mujoco --engine dart --set a=3", r"--set a=3 beside 2 --engine; allowed: one"),
    ("report --engine mujoco:all --set cone=elliptic", r"sets cone=elliptic in several variants; allowed: in one"),
    ("run record --record sweep.toml", r"sweep.toml"),
    ("run all --workers 0", r"workers = 0.*>= 1"),
    ("run unit-cell --store ''", r"--store = '' is empty; allowed: "),
    ("run acuracy", r"No such command 'acuracy'"),
    ("run proofs --sample 0", r"sample = 0.*>= 1"),
    ("run work-precision --steps 400 --steps 1000001", r"steps = 1000001.*16 to 1000000"),
    ("run recipes --workers 0", r"workers = 0.*>= 1"),
    ("compare a.sqlite b.sqlite", r"a.sqlite"),
    ("reproduce mujoco free-decay", r"scenario = 'free-decay'.*static-hold"),
    ("reproduce reference static-hold", r"reference has no reproducer; allowed: .*mujoco:joint"),
    ("probe none.xml", r"MODEL = 'none.xml' does not load"),
    ("recipe siconos", r"engine = siconos has no recipe: it has no options to recommend; allowed: .*mujoco"),
    ("sweep", r"Missing argument 'file'"),
    ("sweep missing.toml", r"missing.toml cannot be read"),
    ("sweep ''", r"an argument = '' is empty; allowed: "),
    ("sweep /dev/zero", r"more than 10000000 bytes"),
    ("sweep sweep.toml --time-limit 1e300", r"time_limit = 1e\+300 .*allowed: > 0, 1e-06 to 1e\+06"),
    ("sweep sweep.toml --out sweep.xls", r"ending '.xls'; allowed: .nc or .csv"),
    ("sweep sweep.toml --out=", r"--out = '' is empty; allowed: "),
    ("sweep sweep.toml --store other.sqlite", r"store other.sqlite is no store of this suite; allowed: "),
    ("sweep sweep.toml --scheduler nowhere", r"scheduler = 'nowhere'"),
    ("report --engine mujoco@3.3.7 --quick", r"engine = 'mujoco@3.3.7' is unknown; allowed: .*; did you mean mujoco"),
    ("report --quick --out text.sqlite", r"--out = text.sqlite cannot be made"),
]

SWEEP = """
engines = ["reference:joint"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.9]
"""

SWEEP_FILES = [
    ("engines = [", r"is no TOML"),
    (SWEEP.replace("reference:joint", "referenz"), r"engine = 'referenz' is unknown"),
    (SWEEP.replace("[0.9]", "[0.9, 0.9]"), r"grid.frequency_ratio.*twice"),
    (SWEEP + "[chain]\nfriction_profile = [1.0, -0.5]\n", r"chain.friction_profile = .*-0.5.*>= 0"),
    (
        SWEEP.replace("[0.9]", "{ first = 0.3, last = 1.6, accuracy_db = 1 }") + "[chain]\ncells = 3000\n",
        r"cells = 3000 with an accuracy of frequency_ratio, .*; allowed: <= 1000, or values of frequency_ratio",
    ),
    ("steps_per_period = " + "9" * 4301 + SWEEP, r"is no TOML: .*4300 digits"),
    ("engines = " + "[" * 3000 + "]" * 3000, r"is no TOML: arrays and tables in one another"),
    (SWEEP.replace("[0.9]", "[1e-320]"), r"grid.frequency_ratio = .*e-321.*allowed: > 0, 1e-12 to 1e\+12"),
    (SWEEP.replace("[0.9]", "{ first = 1, last = 2, points = 1" + "0" * 30 + " }"), r"points = 10*; .*1e\+06"),
    (SWEEP + "[chain]\ncells = 1" + "0" * 30 + "\n", r"chain.cells = 10{9}.*100000"),
]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a sweep, a database of another program and a text file that is called a store."""
    (tmp_path / "sweep.toml").write_text(SWEEP)
    (tmp_path / "folder").mkdir()
    (tmp_path / "text.sqlite").write_text("no database, but long enough to be looked at as one " * 40)
    connection = sqlite3.connect(tmp_path / "other.sqlite")
    connection.execute("CREATE TABLE addresses (name TEXT)")
    connection.close()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def files_in(folder: Path) -> dict[Path, bytes | None]:
    """Everything below a folder with its content; folders have none."""
    return {file: file.read_bytes() if file.is_file() else None for file in folder.rglob("*")}


@pytest.mark.parametrize(("line", "message"), COMMAND_LINES, ids=[line[:60] for line, _ in COMMAND_LINES])
def test_wrong_command_line_is_refused_with_its_value(folder, capsys, line, message) -> None:
    before = files_in(folder)
    name, *arguments = shlex.split(line)
    assert run_command(app, [name, *arguments]) == ExitCode.WRONG_INPUT
    printed = capsys.readouterr()
    assert printed.err.startswith("error: ")
    assert len(printed.err.splitlines()) == 1
    assert re.search(message, printed.err), printed.err
    assert not printed.out
    assert files_in(folder) == before


@pytest.mark.parametrize(("content", "message"), SWEEP_FILES, ids=[message for _, message in SWEEP_FILES])
def test_wrong_sweep_file_is_refused_with_file_key_and_value(folder, capsys, content, message) -> None:
    (folder / "mine.toml").write_text(content)
    before = files_in(folder)
    assert run_command(app, ["sweep", "mine.toml"]) == ExitCode.WRONG_INPUT
    printed = capsys.readouterr().err
    assert printed.startswith("error: mine.toml")
    assert re.search(message, printed), printed
    assert files_in(folder) == before


ENDS = {"[0.3]": "{ first = 0.1, last = 1.0, points = 1000 }", "[0.9]": "{ first = 0.3, last = 1.6, points = 10000 }"}


@pytest.mark.parametrize("command", ["sweep large.toml --yes --out large.nc", "report --sweep large.toml"])
def test_sweep_of_ten_million_points_says_its_size_and_asks_for_a_yes(folder, capsys, command) -> None:
    (folder / "large.toml").write_text(re.sub(r"\[0\.\d\]", lambda found: ENDS[found[0]], SWEEP))
    before = files_in(folder)
    assert run_command(app, command.split()) == ExitCode.WRONG_INPUT
    assert re.search(r"0,000,000 points, .* h of .*allowed: <= 1,000,000 points", capsys.readouterr().err)
    assert files_in(folder) == before
