"""Changes of single operators in the product's code."""

import ast
import dataclasses
from pathlib import Path

import pytest

from tests.mutations import code, lines
from tests.mutations.code import (
    KILLED,
    SURVIVED,
    UNDECIDED,
    Change,
    changes_of,
    executing,
    not_killed,
    outcome,
    product_files,
)
from tests.scenarios.runs.builders import ended

SMALL = "def least(a, b):\n    return a if a < b and not b + a == 1 else b\n"


@pytest.fixture
def project(monkeypatch, tmp_path: Path) -> Path:
    """Make a project of one function, with a test that sees half of it."""
    monkeypatch.setattr(code, "PROJECT", tmp_path)
    for file, text in {
        "reports/__init__.py": "",
        "reports/small.py": SMALL,
        "tests/reports/test_small.py": "from reports.small import least\ndef test_it():\n    assert least(2, 3) == 2\n",
        "tests/golden/test_golden.py": "def test_golden():\n    pass\n",
        "tests/__init__.py": "",
        "tests/mutations/lines.py": Path(lines.__file__).read_text(),
        "pytest.ini": "[pytest]\npythonpath = .\naddopts = --import-mode=importlib -n 2 --dist loadscope\n",
    }.items():
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text(text)
    return tmp_path


def test_every_change_is_one_operator_at_its_place(project: Path) -> None:
    changed = {str(change): change.source().decode() for change in changes_of(Path("reports/small.py"))}
    assert changed == {
        "reports/small.py:2: < → <=": SMALL.replace("a < b", "a <= b"),
        "reports/small.py:2: and → or": SMALL.replace("and", "or"),
        "reports/small.py:2: not → nothing": SMALL.replace("not ", ""),
        "reports/small.py:2: == → !=": SMALL.replace("==", "!="),
        "reports/small.py:2: + → -": SMALL.replace("b + a", "b - a"),
    }


@pytest.mark.slow
def test_a_change_is_killed_by_a_test_that_sees_it_and_survives_others(project: Path) -> None:
    of = {change.operator: change for change in changes_of(Path("reports/small.py"))}
    assert outcome(of[ast.Not], project) == KILLED
    assert outcome(of[ast.Lt], project) == SURVIVED
    assert (project / "reports/small.py").read_text() == SMALL


def test_a_test_that_fails_without_the_change_kills_nothing(project: Path) -> None:
    less = next(change for change in changes_of(Path("reports/small.py")) if change.operator is ast.Lt)
    (project / "tests/golden/test_golden.py").write_text("def test_golden():\n    assert False\n")
    assert outcome(less, project) == UNDECIDED


@pytest.mark.slow  # waits for processes
def test_a_change_that_never_ends_is_not_decided_and_leaves_no_process(project: Path) -> None:
    less = next(change for change in changes_of(Path("reports/small.py")) if change.operator is ast.Lt)
    (project / "tests/golden/test_golden.py").write_text(
        "import subprocess, sys\n"
        "def test_golden():\n"
        "    run = subprocess.Popen([sys.executable, '-c', 'input()'], stdin=-1)\n"
        "    open('pid', 'w').write(str(run.pid))\n"
        "    run.wait()\n"
    )
    assert outcome(less, project, seconds=5) == UNDECIDED
    assert ended([int((project / "pid").read_text())], within=5)
    assert outcome(less, project, ["tests/reports/test_small.py"], seconds=5) == SURVIVED


@pytest.mark.slow
def test_a_change_meets_the_passing_tests_that_execute_its_line(project: Path, tmp_path_factory) -> None:
    wrong = "def test_wrong():\n    assert least(1, 1) == 0\ndef test_idle():\n    pass\n"
    (project / "tests/reports/test_wrong.py").write_text(f"from reports.small import least\n{wrong}")
    found = lines.lines_of(project, tmp_path_factory.mktemp("lines"))
    first, *_ = changes_of(Path("reports/small.py"))
    assert executing(first, found) == ["tests/reports/test_small.py::test_it"]
    assert executing(dataclasses.replace(first, line=100, statement=100), found) == []
    lines_of_it = dataclasses.replace(first, line=first.line + 2)
    assert executing(lines_of_it, found) == ["tests/reports/test_small.py::test_it"], "a later line of the statement"


def test_all_examples_of_the_tests_of_a_file_are_met_and_one_of_others(project: Path) -> None:
    """The fastest example may be the one that does not notice."""
    change, *_ = changes_of(Path("reports/small.py"))
    near, far = "tests/reports/test_small.py::test_it", "tests/far/test_far.py::test_it"
    found = {
        (str(change.file), change.line): [
            (0.1, far + "[a]"),
            (0.2, near + "[a]"),
            (0.3, near + "[b]"),
            (0.4, far + "[b]"),
        ]
    }
    assert executing(change, found) == [near + "[a]", near + "[b]", far + "[a]"]


def test_a_line_that_no_test_was_seen_to_execute_is_not_taken_for_the_one_above(project: Path) -> None:
    """What is above belongs to other statements, whose tests do not notice a change of this one."""
    (project / "reports/small.py").write_text("def f(a):\n    b = a\n    return (b\n        + 1)\n")
    (change,) = changes_of(Path("reports/small.py"))
    assert (change.line, change.statement) == (3, 3)


def test_every_change_of_the_product_can_be_compiled() -> None:
    for file in product_files()[::20]:
        for change in changes_of(file):
            assert isinstance(change, Change)
            compile(change.source(), str(file), "exec")


def test_tests_of_an_adapter_are_those_of_its_engine() -> None:
    own, contract, *_ = code.tests_of(Path("engines/mujoco/joint.py"))
    assert (own, contract) == ("tests/engines/adapters/test_mujoco.py", "engines/contract")
    assert code.engines_of(Path("engines/exudyn/joint.py")) == ["exudyn-bristle", "exudyn-regularised"]
    assert code.engines_of(Path("engines/shared/law_distance.py")) == []


def test_an_adapter_meets_the_contract_with_its_engine_alone(monkeypatch, tmp_path: Path) -> None:
    change, asked = next(changes_of(Path("engines/mujoco/joint.py"))), list[list[str]]()
    (tmp_path / change.file).parent.mkdir(parents=True)
    (tmp_path / change.file).write_bytes((code.PROJECT / change.file).read_bytes())
    monkeypatch.setattr(code, "first_failure", lambda tests, *_: asked.append(list(tests)) or tests[1])
    assert outcome(change, tmp_path) == UNDECIDED, "it fails without the change too"
    first, again = asked
    assert first == [*code.tests_of(change.file), "--xval-engine=mujoco"]
    assert again == ["engines/contract", "--xval-engine=mujoco"]


def test_what_an_earlier_run_has_not_killed_is_met_again() -> None:
    every = list(changes_of(Path("reference_lcp/validation.py")))
    first, other = every[0], next(each for each in every if str(each) != str(every[0]))
    printed = f"{KILLED:9} {other}\n{SURVIVED:9} {first}\n1 of 2 decided changes are killed\n"
    again = not_killed(every, printed)
    assert first in again
    assert {str(each) for each in again} == {str(first)}
    assert other in not_killed(every, f"{UNDECIDED:9} {other}\n")
    assert not_killed(every, f"{KILLED:9} {first}\n") == []
