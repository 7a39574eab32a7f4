"""Mistakes that people make at the command line: each is refused before any work, with the value and what to do."""

import re
import shlex
import sqlite3
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from reference_lcp.errors import ExitCode

COMMAND_LINES = [
    ("reference --friction-ratio -0.1", r"friction_ratio = -0.1.*>= 0"),
    ("reference --frequency-ratio 0", r"frequency_ratio = 0.*> 0"),
    ("reference --frequency-ratio nan", r"frequency_ratio = nan .*allowed: > 0, 1e-12 to 1e\+12"),
    ("reference --friction-ratio inf", r"friction_ratio = inf .*allowed: >= 0, 1e-12 to 1e\+12"),
    ("reference --cells 0", r"cells = 0.*>= 1"),
    ("reference --cells 2.5", r"'--cells': .*valid integer.* \(given: '2.5'\)"),
    ("reference --mass-ratio 0", r"mass_ratio = 0.*> 0"),
    ("reference --stiffness-ratio -1", r"stiffness_ratio = -1.*> 0"),
    ("reference --damping-ratio -0.01", r"damping_ratio = -0.01.*>= 0"),
    ("reference --base-amplitude 0", r"base_amplitude = 0.*> 0"),
    ("reference --steps-per-period 3", r"steps_per_period = 3 .*>= 16"),
    ("reference --tolerance 0", r"tolerance = 0.*> 0"),
    ("reference --max-periods 0", r"max_periods = 0.*>= 1"),
    ("reference --solver newton", r"solver = 'newton' is unknown; allowed: compiled, lemke, exact"),
    ("reference --friction 0.3", r"No such option.*--friction-ratio"),
    ("reference --friction-ratio lots", r"'--friction-ratio': not a valid number \(given: 'lots'\)"),
    ("reference --proof --digits 0", r"digits = 0.*>= 1"),
    ("reference --proof --time-limit 0", r"time_limit = 0.*> 0"),
    ("reference --proof --cells 101", r"cells = 101.*1 to 100"),
    ("reference --proof --friction-ratio 1e-13", r"friction_ratio = 1e-13.*1e-12 to 1e\+12"),
    ("reference --plot missing/period.png", r"the folder missing does not exist"),
    ("reference --plot period.gif", r"--plot = period.gif has the ending '.gif'; allowed: .pdf, .svg, .png, .eps, "),
    ("reference --cells 100000 --plot period", r"--plot = period has the ending ''; allowed: .pdf"),
    ("reference --cells 100001", r"cells = 100001 is outside its range; allowed: 1 to 100000"),
    ("reference --cells 100000 --error-bar", r"cells = 100000 is more than an error bar takes; allowed: <= 1000"),
    ("reference --cells 100000 --exact-value", r"cells = 100000 is more than an exact value takes; allowed: <= 500"),
    ("reference --cells 100000 --solver lemke", r"cells = 100000 is more than the solver 'lemke' takes; .* <= 100,"),
    ("reference --mass-ratio 1e9", r"needs 1.21e\+06 steps; allowed: <= 1000000, as with a frequency 1.21 times"),
    ("reference --plot ''", r"--plot = '' is empty; allowed: "),
    ("reference 7", r"unexpected extra argument"),
    ("truth show block-stop", r"problem = 'block-stop' is unknown; .*did you mean block-stops\?"),
    ("truth check block-stops missing.csv", r"motion = 'missing.csv' is no file"),
    ("truth check block-stops sweep.toml", r"columns of sweep.toml = .* lack time; allowed: 'time, x0'"),
    ("truth check block-stops . --time-step 0", r"motion = '.' is no file"),
    ("history mujocko", r"engine = 'mujocko' is unknown; allowed: dart, .*did you mean mujoco\?"),
    ("history mujoco --last 0", r"last = 0 is outside its range; allowed: .*>= 1, up to 100"),
    ("history mujoco --last 2 --versions 4.0.0", r"--last = 2 with --versions = 4.0.0; allowed: one of the two"),
    ("run laws --out laws.txt", r"allowed: \.md or \.csv"),
    ("engines --jason", r"No such option.*--json"),
    ("reprot --quick", r"No such command 'reprot'.*Did you mean 'report'"),
    ("run accuracy --engine mujocko", r"engine = 'mujocko' is unknown; allowed: .*mujoco"),
    (
        "run accuracy --engine mujoco:glue",
        r"formulation of mujoco = 'glue' is unknown; .*joint",
    ),
    ("run accuracy --engine mujoco:joint:best", r"preset of mujoco = 'best' is unknown; allowed: .*tuned"),
    ("run accuracy --engine a:b:c:d", r"has 4 parts; allowed: ENGINE"),
    ("run accuracy --engine mujoco --set sweeps=3", r"option 'sweeps' cannot be set in mujoco:joint:tuned; "),
    ("run laws --engine mujoco --set cone=flat", r"cone = 'flat' of .*; allowed: elliptic or pyramidal"),
    ("run static-hold --engine mujoco --set x", r"--set 'x' sets no value; allowed: OPTION=VALUE"),
    ("report --set noslip", r"--set 'noslip' sets no value; allowed: OPTION=VALUE"),
    ("reproduce mujoco static-hold load", r"allowed: '1 g, load 0.1', '1 g, load 0.5', "),
    ("report --engine mujoco --engine dart --set a=3", r"--set a=3 beside 2 --engine; allowed: one"),
    ("report --engine mujoco:all --set cone=elliptic", r"sets cone=elliptic in several variants; allowed: in one"),
    ("run accuracy --out table.doc", r"ending '.doc'; allowed: .md or .csv"),
    ("run accuracy --workers 0", r"workers = 0.*>= 1"),
    ("run accuracy --time-limit 0", r"time_limit = 0.*> 0"),
    ("run record --record missing.csv", r"missing.csv"),
    ("run record --record sweep.toml", r"sweep.toml"),
    ("run unit-cell --engine mujocko", r"engine = 'mujocko' is unknown"),
    ("run all --out verdicts.pdf", r"ending '.pdf'; allowed: .md"),
    ("run figure3 --no-run", r"--store"),
    ("compare a.sqlite b.sqlite", r"a.sqlite"),
    ("compare other.sqlite other.sqlite --db 1e5", r"db = 100000 is outside its range; allowed: > 0, 0.001 to 1000"),
    ("reference --base-amplitude 1e308", r"base_amplitude = 1e\+308.*1e-24 to 1e\+24"),
    ("reference --frequency-ratio 1e-9", r"a period of .* needs .* steps; allowed: .*<= 1000000"),
    (f"reference --cells {'9' * 4301}", r"--cells.*integer"),
    (f"reference --plot {'x' * 400}.png", r"File name too long"),
    ("sweep sweep.toml --time-limit 1e300", r"time_limit = 1e\+300 .*allowed: > 0, 1e-06 to 1e\+06"),
    ("sweep sweep.toml --workers 1000000", r"workers = 1000000.*1 to 1024"),
    (f"sweep sweep.toml --store {'x' * 400}", r"store = .*File name too long"),
    ("sweep /dev/zero", r"more than 10000000 bytes"),
    ("report --engine mujoco@3.3.7 --quick", r"engine = 'mujoco@3.3.7' is unknown; allowed: .*; did you mean mujoco"),
    ("reproduce mujoco free-decay", r"scenario = 'free-decay'.*static-hold"),
    ("reproduce reference static-hold", r"reference has no reproducer; allowed: .*mujoco:joint"),
    ("probe none.xml", r"MODEL = 'none.xml' does not load"),
    ("recipe mujoko", r"engine = 'mujoko'.*mujoco"),
    ("recipe siconos", r"engine = siconos has no recipe: it has no options to recommend; allowed: .*mujoco"),
    ("run proofs --sample 0", r"sample = 0.*>= 1"),
    ("run work-precision --engine mujocko", r"engine = 'mujocko' is unknown; allowed: .*mujoco"),
    ("run work-precision --steps 15", r"steps = 15.*>= 16"),
    ("run work-precision --steps 400 --steps 1000001", r"steps = 1000001.*16 to 1000000"),
    ("run work-precision --steps 2.5", r"'--steps': .*valid integer.* \(given: '2.5'\)"),
    ("run work-precision --out speed.gif", r"ending '.gif'; allowed: .md or .csv or .svg or .pdf or .png"),
    ("run work-precision --out speed.md --out speed.md", r"speed.md"),
    ("run work-precision --workers 0", r"workers = 0.*>= 1"),
    ("run recipes --workers 0", r"workers = 0.*>= 1"),
    *((f"run {name} --workers 0", r"workers = 0.*>= 1") for name in SCENARIOS),
    ("run acuracy", r"No such command 'acuracy'"),
    ("sweep missing.toml", r"missing.toml cannot be read"),
    ("sweep folder", r"folder cannot be read"),
    ("sweep sweep.toml --out sweep.xls", r"ending '.xls'; allowed: .nc or .csv"),
    ("sweep sweep.toml --out ''", r"--out = '' is empty; allowed: "),
    ("sweep sweep.toml --out=", r"--out = '' is empty; allowed: "),
    ("sweep sweep.toml --out ' '", r"--out = ' ' is empty; allowed: "),
    ("sweep sweep.toml --store ''", r"--store = '' is empty; allowed: "),
    ("sweep ''", r"an argument = '' is empty; allowed: "),
    ("report --quick --out ''", r"--out = '' is empty; allowed: "),
    ("run unit-cell --store ''", r"--store = '' is empty; allowed: "),
    ("compare '' other.sqlite", r"an argument = '' is empty; allowed: "),
    ("sweep sweep.toml --store other.sqlite", r"store other.sqlite is no store of this suite; allowed: "),
    ("sweep sweep.toml --store text.sqlite", r"store text.sqlite is damaged or no store"),
    ("sweep sweep.toml --scheduler nowhere", r"scheduler = 'nowhere'"),
    ("sweep", r"Missing argument 'file'"),
    ("report --engine mujocko --quick", r"engine = 'mujocko' is unknown"),
    ("report --quick --out text.sqlite", r"--out = text.sqlite cannot be made"),
    ("report --quick --workers -2", r"workers = -2.*>= 1"),
]

SWEEP = """
engines = ["reference:joint"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.9]
"""

SWEEP_FILES = [
    ("engines = [", r"is no TOML"),
    ('engines = ["reference"]', r"grid is missing"),
    (SWEEP.replace('"reference:joint"', ""), r"engines"),
    (SWEEP.replace('"reference:joint"', "1"), r"engines.0 = 1"),
    (SWEEP.replace("reference:joint", "referenz"), r"engine = 'referenz' is unknown"),
    (SWEEP.replace("frequency_ratio", "frequenzy_ratio"), r"frequenzy_ratio"),
    (SWEEP.replace("[0.9]", "[]"), r"grid.frequency_ratio"),
    (SWEEP.replace("[0.9]", "[0.9, 0.9]"), r"grid.frequency_ratio.*twice"),
    (SWEEP.replace("[0.9]", "[-0.9]"), r"grid.frequency_ratio = -0.9.*> 0"),
    (SWEEP.replace("[0.9]", "{ first = 0.3, last = 1.6 }"), r"grid.frequency_ratio.*points is missing"),
    (SWEEP.replace("[0.9]", '["0.9"]'), r"grid.frequency_ratio"),
    (SWEEP + "[chain]\ncells = 0\n", r"chain.cells = 0"),
    (SWEEP + "[chain]\nmass_ratio = -1.0\n", r"chain.mass_ratio = -1 .*> 0"),
    (SWEEP + "[chain]\nfriction_profile = [1.0, -0.5]\n", r"chain.friction_profile = .*-0.5.*>= 0"),
    (
        SWEEP + "[chain]\nouter_mass_ratio = [1.0, 2.0]\n",
        r"chain.outer_mass_ratio has 2 values and the chain 7 cells; allowed: one number, or as many",
    ),
    (
        SWEEP.replace("[0.9]", "{ first = 0.3, last = 1.6, accuracy_db = 1 }") + "[chain]\ncells = 3000\n",
        r"cells = 3000 with an accuracy of frequency_ratio, .*; allowed: <= 1000, or values of frequency_ratio",
    ),
    (SWEEP + "[chain]\nfriction = 1.0\n", r"chain.friction is unknown; allowed: cells, mass_ratio"),
    ("steps_per_period = 3\n" + SWEEP, r"steps_per_period = 3; .*16"),
    ("steps_per_period = " + "9" * 4301 + SWEEP, r"is no TOML: .*4300 digits"),
    ("engines = " + "[" * 3000 + "]" * 3000, r"is no TOML: arrays and tables in one another"),
    (SWEEP.replace("[0.9]", "[nan]"), r"grid.frequency_ratio = nan .*allowed: > 0, 1e-12 to"),
    (SWEEP.replace("[0.9]", "[1e-320]"), r"grid.frequency_ratio = .*e-321.*allowed: > 0, 1e-12 to 1e\+12"),
    (SWEEP.replace("[0.9]", "{ first = 1, last = 2, points = 1" + "0" * 30 + " }"), r"points = 10*; .*1e\+06"),
    (SWEEP + "[drive]\namplitude = 1e308\n", r"drive.amplitude = 1e\+308; .*<= 1e\+24"),
    (SWEEP + "[chain]\ncells = 1" + "0" * 30 + "\n", r"chain.cells = 10{9}.*100000"),
    (SWEEP + "[tolerances]\ntransmittance_db = 1e5\n", r"tolerances.transmittance_db = 100000.0; .*1000"),
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


LARGE = SWEEP.replace("[0.3]", "{ first = 0.1, last = 1.0, points = 1000 }").replace(
    "[0.9]", "{ first = 0.3, last = 1.6, points = 10000 }"
)


@pytest.mark.parametrize(
    "command",
    [
        "sweep large.toml",
        "sweep large.toml --yes --out large.nc",
        "report --sweep large.toml",
    ],
)
def test_sweep_of_ten_million_points_says_its_size_and_asks_for_a_yes(folder, capsys, command) -> None:
    (folder / "large.toml").write_text(LARGE)
    before = files_in(folder)
    name, *arguments = command.split()
    assert run_command(app, [name, *arguments]) == ExitCode.WRONG_INPUT
    assert re.search(r"0,000,000 points, .* h of .*allowed: <= 1,000,000 points", capsys.readouterr().err)
    assert files_in(folder) == before
