"""The command `history`, with uv and the package index replaced: no network, and errors that are known."""

import sys
from pathlib import Path
from subprocess import CompletedProcess

import pandas as pd
import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.truth import history as study
from multibody_xval.scenarios.truth.problem import problem_of

LISTED = "mujoco (4.0.0)\nAvailable versions: 4.0.0, 3.10.0, 3.3.7, 3.3.6, 3.2.0\n  INSTALLED: 3.3.6\n"
LOCK = "sdist = { upload-time = 2025-10-14T17:34:40Z }\nwheels = [{ upload-time = 2025-10-13T17:34:00Z }]\n"


class FakeUv:
    """uv with an index of five versions, whose blocks are so far from the exact motion."""

    def __init__(self) -> None:
        self.off: dict[str, float] = {}
        self.wrong: dict[str, tuple[int, str, str]] = {}
        self.uninstallable: set[str] = set()
        self.interrupted: set[str] = set()
        self.ran: list[str] = []

    def __call__(self, *words: str, seconds: float = 60.0, text: str = "") -> CompletedProcess[str]:
        if words[0] in ("tool", "pip"):
            printed = LISTED if words[0] == "tool" else LOCK if text == "mujoco==3.3.7" else ""
            return CompletedProcess(words, 0, printed, "")
        version = words[words.index("--with") + 1].partition("==")[2]
        if words[-2:] == ("-c", ""):
            self.ran.append(version)
            return CompletedProcess(words, int(version in self.uninstallable), "", "no wheel")
        if version in self.interrupted:
            raise KeyboardInterrupt
        return CompletedProcess(words, *self.wrong.get(version, (0, self._motion(words[-1], version), "")))

    def _motion(self, file: str, version: str) -> str:
        problem = problem_of(Path(file).read_text(), file)
        off = self.off.get(version, 0.0)
        rows = zip(problem.times, problem.positions, problem.velocities, strict=True)
        return "\n".join(["time,x0,v0", *(f"{time},{x + off!r},{v!r}" for time, (x,), (v,) in rows)])


@pytest.fixture
def uv(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> FakeUv:
    fake = FakeUv()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(study, "uv_found", lambda: fake)
    return fake


def history(line: str) -> tuple[int, pd.DataFrame]:
    """Run the command; give its exit code and the rows that it has kept."""
    code = run_command(app, ["history", "mujoco", *line.split()])
    return code, study.stored(Path("history/mujoco.csv"))


def test_the_error_of_every_version_is_in_the_file_and_on_the_page(uv, capsys) -> None:
    uv.off = {"3.3.7": 0.25}
    code, table = history("--versions 4.0.0,3.3.7")
    assert code == ExitCode.DONE
    assert table.version.tolist() == ["3.3.7"] * 8 + ["4.0.0"] * 8, "in the order of versions"
    old, new = (own for _, own in table.groupby("version"))
    assert old["off by [m]"].tolist() == pytest.approx([0.25] * 8)
    assert (old["number [m]"] - old["exact [m]"]).tolist() == pytest.approx([0.25] * 8)
    assert (set(old.status), set(old.released)) == ({"deviates"}, {"2025-10-13"})
    assert (set(new.status), set(new["off by [m]"]), set(new.released)) == ({"agrees"}, {0.0}, {""})
    assert "8 of 16 motions agree; history/mujoco.html" in capsys.readouterr().out
    assert Path("history/mujoco.html").read_text().count("<svg") == 1


def test_a_second_command_runs_only_versions_that_are_missing_or_did_not_install(uv) -> None:
    uv.interrupted, uv.uninstallable = {"3.3.7"}, {"3.2.0"}
    code, table = history("--versions 3.2.0,3.3.7")
    assert (code, set(table.version)) == (ExitCode.INTERRUPTED, {"3.2.0"})
    assert table[["problem", "status"]].to_numpy().tolist() == [["all", "does not install: no wheel"]]
    uv.interrupted, uv.uninstallable, uv.ran = set(), set(), []
    assert set(history("--versions 3.2.0,3.3.7")[1].status) == {"agrees"}
    assert uv.ran == ["3.2.0", "3.3.7"]
    history("--last 3")
    assert uv.ran[2:] == ["3.10.0", "4.0.0"], "the last patches of the newest minor versions"


def test_a_version_whose_script_fails_is_a_result_and_kept(uv) -> None:
    uv.wrong = {"3.2.0": (1, "", "ImportError: libGL.so.1"), "3.3.6": (0, "time,x0,v0\n0.1,0,0\n0.5,0,0\n", "")}
    for _ in range(2):
        code, table = history("--versions 3.2.0,3.3.6")
        assert code == ExitCode.DONE
        reasons = ["fails: ImportError: libGL.so.1", "fails: the motion has no row at 0.2 s"]
        assert [own.partition(",")[0] for own in table.status.unique()] == reasons
    assert uv.ran == ["3.2.0", "3.3.6"]


def test_a_version_that_there_is_none_of_is_refused_before_any_run(uv, capsys) -> None:
    assert run_command(app, ["history", "mujoco", "--versions", "3.3.7,new"]) == ExitCode.WRONG_INPUT
    error = capsys.readouterr().err
    assert error.startswith("error: versions = 'new' is unknown; allowed: 3.2.0")
    assert (uv.ran, list(Path().iterdir())) == ([], [])


def test_uv_takes_the_index_of_the_user_is_stopped_at_its_limit_and_complains_in_a_line(tmp_path, monkeypatch) -> None:
    def told(code: str, *words: str, **limits: float | str) -> CompletedProcess[str]:
        (tmp_path / "uv").write_text(f"#!{sys.executable}\nimport os, sys, time\n{code}\n")
        (tmp_path / "uv").chmod(0o755)
        return study.uv_found()(*words, **limits)

    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("UV_DEFAULT_INDEX", raising=False)
    monkeypatch.setenv("PIP_INDEX_URL", "https://a")
    assert told("print(os.environ['UV_DEFAULT_INDEX'])", "run").stdout == "https://a\n"
    assert told("time.sleep(60)", "run", seconds=0.5).stderr == "stopped after 0.5 s"
    done = told("print(sys.stdin.read())\nsys.exit('first\\n  second\\n\\nlast \\x1b[2J')", "run", text="asked")
    assert (done.returncode, done.stdout, done.stderr) == (1, "asked\n", "second; last \\x1b[2J")
