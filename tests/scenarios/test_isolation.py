"""Engines that crash, hang, are killed or give no numbers: blocked with the reason, and everything else goes on."""

import json

import pytest

SCRIPT = """
import json, sys, time
from pathlib import Path
from engines.variant import Variant
from scenarios.evaluation import Evaluator
from scenarios.questions import ChainRatios, Question
from scenarios.store import ResultStore

def question(name, eta):
    return Question(variant=Variant(name), friction_ratio=0.3, frequency_ratio=eta, ratios=ChainRatios(cells=2))

if __name__ == "__main__":
    names, file = sys.argv[1].split(","), Path(sys.argv[2])
    asked = [question(name, eta) for name in names for eta in json.loads(sys.argv[3])]
    with ResultStore(file) as store, Evaluator(store, 2, time_limit=4.0) as evaluator:
        found = evaluator.evaluate(asked)
    rows = [(q.variant.engine, q.frequency_ratio, a.status, a.reason) for q, a in zip(asked, found)]
    print(json.dumps(rows))
"""


@pytest.fixture
def ask(install, tmp_path):
    """Ask engines of the faulty package, on two workers with a limit of four seconds; gives rows of answers."""

    def asked(*names: str, ratios=(0.4, 0.5, 0.9)) -> dict[tuple[str, float], tuple[str, str]]:
        script = tmp_path / "ask.py"
        script.write_text(SCRIPT)
        printed = install("faulty").run(
            str(script), ",".join(names), str(tmp_path / "store.sqlite"), json.dumps(list(ratios))
        )
        return {(engine, eta): (status, reason) for engine, eta, status, reason in json.loads(printed)}

    return asked


def test_segmentation_fault_a_hang_and_a_killed_process_block_their_own_points_only(ask) -> None:
    rows = ask("reference", "faulty-crash", "faulty-hang", "faulty-killed", "mujoco")
    for (engine, eta), (status, _) in rows.items():
        deadly = eta == 0.5 and engine.startswith("faulty")
        assert status == ("blocked" if deadly else "converged"), (engine, eta)
    assert rows["faulty-crash", 0.5][1].startswith("the worker process crashed: Segmentation fault, in ")
    assert rows["faulty-hang", 0.5][1].startswith("stopped at the time limit of 4 s, in run (deadly.py:")
    assert rows["faulty-killed", 0.5][1] == "the worker process was killed"


def test_numbers_that_are_not_finite_are_blocked(ask) -> None:
    rows = ask("faulty-nan", "faulty-sound", ratios=(0.9,))
    assert rows["faulty-nan", 0.9] == ("blocked", "the engine's numbers are not finite, in period 2 of the search")
    assert rows["faulty-sound", 0.9][0] == "converged"


def test_engine_that_dies_at_point_after_point_is_not_asked_forever(ask) -> None:
    """The same point in ever other digits: each is a question of its own, and each kills."""
    near = [0.5 + k * 1e-12 for k in range(6)]
    rows = ask("faulty-killed", "reference", ratios=near)
    reasons = [rows["faulty-killed", eta][1] for eta in near]
    assert reasons.count("the worker process was killed") >= 3
    assert "not asked: 3 points before, the worker process was killed" in reasons
    assert all(rows["reference", eta][0] == "converged" for eta in near)
