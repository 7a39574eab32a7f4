"""Mistakes that people make at the command line: each is one line with value and what to do, and nothing is lost."""

import re
import shlex
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

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
    ("truth check block-stops sweep.toml", r"columns of sweep.toml = .* lack time; allowed: 'time, x0'"),
    ("history mujocko", r"engine = 'mujocko' is unknown; allowed: dart, .*did you mean mujoco\?"),
    ("recipe MuJoCo-Warp --no-run", r"engine = 'MuJoCo-Warp' is unknown; allowed: .*did you mean mujoco-warp\?"),
    ("recipe siconos", r"engine = siconos has no recipe: it has no options to recommend; allowed: .*mujoco"),
    # the reference
    ("reference --frequency-ratio nan", r"frequency_ratio = nan .*allowed: > 0, 1e-12 to 1e\+12"),
    ("reference --proof --cells 101", r"cells = 101.*1 to 100"),
    ("reference --cells 100000 --error-bar", r"cells = 100000 is more than an error bar takes; allowed: <= 1000"),
    (f"reference --cells {'9' * 4301}", r"--cells.*integer"),
    # engines, presets and options
    ("run accuracy --engine mujoco@3.3.7", r"'mujoco@3.3.7' has a version; allowed: mujoco, as it is installed"),
    ("run accuracy --engine mujoco:glue", r"formulation of mujoco = 'glue' is unknown; .*joint"),
    ("run accuracy --engine mujoco --set sweeps=3", r"option 'sweeps' cannot be set in mujoco:joint:tuned; "),
    ("report --engine mujoco --engine dart --set a=3", r"--set a=3 beside 2 --engine; allowed: one"),
    # run
    ("run unit-sell", r"No such command 'unit-sell'. Did you mean 'unit-cell'"),
    ("run unit-cell accuracy", r"unit-cell with accuracy; allowed: scenarios together, or accuracy alone"),
    ("run unit-cell --store before.sqlite --series rows.md", r"--series = rows.md has the ending '.md'; allowed: .csv"),
    ("run unit-cell --no-run", r"--no-run without --store"),
    ("run record --record sweep.toml", r"sweep.toml"),
    ("run record --record /dev/zero", r"more than 100000000 characters; allowed: "),
    ("run all --workers 0", r"workers = 0.*>= 1"),
    ("run proofs --sample 0", r"sample = 0.*>= 1"),
    ("run figure3 --out text.sqlite", r"--out = text.sqlite cannot be made: File exists"),
    ("run figure3 --out /proc/figure3", r"--out = /proc/figure3 cannot be made"),
    ("run figure3 --engine mujocko", r"engine = 'mujocko' is unknown; allowed: .*; did you mean mujoco"),
    ("run figure3 --no-run", r"store figure3/results.sqlite is no file"),
    ("run friction-map --engine exudyn-bristle", r"engine = exudyn-bristle has no scenes of boxes"),
    ("run work-precision --workers 2 --scheduler tcp://127.0.0.1:1", r"allowed: one of the two"),
    # compare
    ("compare before.sqlite now.sqlite --workers=1", r"--workers = 1 with two stores, of which nothing is computed"),
    ("compare before.sqlite now.sqlite --db=0", r"db = 0 is outside its range; allowed: > 0, 0.001 to 1000"),
    ("compare before.sqlite alone.sqlite", r"alone.sqlite \(of no engine\) have no point in common; allowed: stores"),
    # reproduce and probe
    ("reproduce mujoco free-decay", r"scenario = 'free-decay'.*static-hold"),
    ("reproduce mujoco static-above-kinetic", r"static_ratio = 1\.5: mujoco cannot set static friction of its own"),
    ("reproduce reference static-hold", r"reference has no reproducer; allowed: .*mujoco:joint.*pybullet:contact"),
    ("probe grip.xml --ctrl record.csv", r"ctrl = 'record.csv', line 2: 2 columns; allowed: 3, time and 2 controls"),
    ("probe grip.xml --ctrl /dev/zero", r"more than 100000000 characters; allowed: "),
    ("probe grip.xml --keyframe x", r"keyframe = 'x' is unknown; allowed: grasp, none"),
    # sweep
    ("sweep", r"Missing argument 'file'"),
    ("sweep /dev/zero", r"more than 10000000 bytes"),
    ("sweep sweep.toml --time-limit 1e300", r"time_limit = 1e\+300 .*allowed: > 0, 1e-06 to 1e\+06"),
    ("sweep sweep.toml --out=", r"--out = '' is empty; allowed: "),
    ("sweep sweep.toml --store foreign.sqlite", r"store foreign.sqlite is no store of this suite; allowed: "),
    ("sweep large.toml --yes --out large.nc", r"0,000,000 points, .* h of .*allowed: <= 1,000,000 points"),
    # translate
    (
        "translate mujoco:joint:default pybullet",
        r"mujoco:joint:default; allowed: contacts .*mujoco:contact:default or ",
    ),
    ("translate mujoco:contact:default exudyn-bristle", r"exudyn-bristle: .*allowed: one with scenes of contacts"),
    ("translate mujoco:contact:default nobody", r"engine = 'nobody' is unknown; allowed: "),
    ("translate mujoco:contact:tuned pybullet", r"mujoco:contact:tuned; allowed: contacts in any model"),
    ("translate mujoco mujoco", r"engine = mujoco is the wanted one too; allowed: another engine"),
    # report
    ("report --quick --out text.sqlite", r"--out = text.sqlite cannot be made"),
    ("report --sweep sweep.toml --engine mujoco", r"neither --engine nor --quick"),
    ("report --no-run --quick", r"allowed without it: --quick"),
]

ONTO_WHAT_IS_USED = [
    "sweep sweep.toml --store kept.csv --out kept.csv",
    "sweep sweep.toml --store kept.csv --out link.csv",
    "sweep sweep.toml --store fresh.csv --out ./fresh.csv",
    "sweep sweep.csv --out sweep.csv",
    "run unit-cell --engine reference --store kept.csv --out kept.csv",
    "run record --engine reference --record record.csv --out record.csv",
    "compare kept.csv hard.csv --out link.csv",
    "report --quick --store rep/points.csv --out rep",
    "report --quick --store rep/figures/store.sqlite --out rep",
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
    with closing(sqlite3.connect(folder / "foreign.sqlite")) as foreign, foreign:
        foreign.execute("CREATE TABLE addresses (name TEXT)")
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
    read = {file: file.read_bytes() if file.is_file() else None for file in folder.rglob("*")}
    return {file: own[100:] if own and file.suffix == ".sqlite" else own for file, own in read.items()}


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
