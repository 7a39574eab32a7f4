"""``multibody-xval reference`` as its users run it, with ``--proof`` too."""

import json
import re
from decimal import Decimal

import pytest

from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.reports.cli.reference import app
from reference_lcp.exact.proof import prove
from tests.reference_lcp.cases import EXACT_DB


def run(capsys, *arguments):
    code = run_command(app, list(arguments))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def answered(capsys, *arguments):
    """Give what a command prints as JSON."""
    code, out, _ = run(capsys, *arguments, "--json")
    assert code == 0
    return json.loads(out)


def test_json_has_the_promised_keys_and_the_steady_state(capsys) -> None:
    answer = answered(capsys, "--friction-ratio", "0.3", "--frequency-ratio", "0.9", "--base-amplitude", "0.02")
    assert answer["transmittance_db"] == pytest.approx(-9.561, abs=0.02)
    assert answer["residual"] <= 1e-8
    assert len(answer["stuck_fraction"]) == 7
    assert {"cell", "time_s", "kind"} == set(answer["transitions"][0])
    assert {change["kind"] for change in answer["transitions"]} == {"stick", "forward slip", "backward slip"}
    assert re.search(r"transmittance\s+-9\.5602 dB", run(capsys)[1])


def test_lemke_prints_the_same_transmittance_to_1e_9_db(capsys) -> None:
    arguments = ("--cells", "1", "--friction-ratio", "0.3", "--frequency-ratio", "0.8", "--solver")
    lemke, compiled = (answered(capsys, *arguments, solver)["transmittance_db"] for solver in ("lemke", "compiled"))
    assert lemke == pytest.approx(compiled, abs=1e-9)


def test_no_steady_state_within_the_periods_is_exit_code_1_and_a_period_is_drawn(capsys, tmp_path) -> None:
    code, out, _ = run(capsys, "--max-periods", "5", "--json")
    assert (code, json.loads(out)["status"]) == (1, "period limit")
    assert run(capsys, "--cells", "3", "--plot", str(tmp_path / "period.png"))[0] == 0
    assert (tmp_path / "period.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--steps-per-period", "15", "--solver", "exact"], ["steps_per_period = 15 ", ">= 16"]),
        (["--plot", "/nowhere/at/all.png"], ["/nowhere/at does not exist"]),
        (["--frequency"], ["--frequency"]),
        (["coverage"], ["coverage"]),
    ],
)
def test_wrong_input_is_one_clear_line_and_exit_code_2(capsys, arguments, words) -> None:
    """Those that `test_mistakes.py` has not."""
    code, out, err = run(capsys, *arguments)
    assert (code, out) == (ExitCode.WRONG_INPUT, "")
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert all(word in err for word in words)


def test_error_bar_and_exact_value_are_printed(capsys) -> None:
    answer = answered(capsys, "--error-bar", "--exact-value")
    error = abs(answer["transmittance_db"] - answer["exact_db"])
    assert error <= answer["error_bar_db"] <= 10 * error
    assert answer["order"] == pytest.approx(1.0, abs=0.3)


def test_what_cannot_be_resolved_is_said_to_be(capsys) -> None:
    deep = ["--cells", "10", "--mass-ratio", "3", "--stiffness-ratio", "3", "--frequency-ratio", "2.5", "--error-bar"]
    answer = answered(capsys, *deep, "--exact-value")
    assert answer["error_bar_db"] is None
    assert answer["exact_db"] < answer["floor_db"] < -140
    text = run(capsys, *deep)[1]
    assert re.search(rf"error bar\s+below what can be resolved: at most {answer['floor_db']:.1f} dB", text)


def test_exact_solver_prints_the_same_keys(capsys) -> None:
    place, level = next(iter(EXACT_DB.items()))
    arguments = ("--friction-ratio", str(place[0]), "--frequency-ratio", str(place[1]))
    exact = answered(capsys, *arguments, "--solver", "exact")
    assert exact.keys() == answered(capsys, *arguments).keys()
    assert exact["transmittance_db"] == pytest.approx(level, abs=1e-3)


POINT = ("--cells", "2", "--frequency-ratio", "0.6", "--proof")


def test_missing_package_is_named_in_one_line_before_any_work(capsys, monkeypatch) -> None:
    monkeypatch.setattr(prove, "find_spec", lambda _: None)
    code, out, err = run(capsys, *POINT)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.endswith("a proof needs python-flint, which is not installed; pip install 'multibody-xval[proof]'\n")


def test_proof_is_in_the_json_as_decimal_strings(capsys) -> None:
    pytest.importorskip("flint", reason="python-flint is not installed")
    code, out, _ = run(capsys, *POINT, "--friction-ratio", "0.3", "--json")
    answer = json.loads(out)["proof"]
    assert (code, answer["status"], answer["reason"], answer["unique_by"]) == (0, "proven", None, "damping")
    for name in ("transmittance_db", "phase"):
        assert Decimal(answer[name]["radius"]) < Decimal("1e-20")
    # The exact solver gives 1.69877440905827...
    assert answer["transmittance_db"]["value"].startswith("1.69877440905827")
    assert {"cell", "kind", "time_over_period"} == set(answer["transitions"][0])
    assert len(answer["transitions"]) == 4


def test_ratios_are_the_decimals_that_were_typed(capsys) -> None:
    """Both decimals are the same double; the level differs where the ratios do."""
    pytest.importorskip("flint", reason="python-flint is not installed")
    levels = []
    for friction in ("0.3", "0.300000000000000000001"):
        _, out, _ = run(capsys, *POINT, "--friction-ratio", friction, "--digits", "30", "--json")
        levels.append(Decimal(json.loads(out)["proof"]["transmittance_db"]["value"]))
    assert float(friction) == 0.3
    assert Decimal("1e-22") < abs(levels[1] - levels[0]) < Decimal("1e-19")


def test_time_that_does_not_suffice_ends_as_not_proven(capsys) -> None:
    pytest.importorskip("flint", reason="python-flint is not installed")
    code, out, _ = run(capsys, *POINT, "--friction-ratio", "0.3", "--time-limit", "1e-3", "--json")
    answer = json.loads(out)["proof"]
    assert (code, answer["status"]) == (1, "not proven")
    assert answer["reason"] == "the time limit of 0.001 s is over"
    assert answer["transmittance_db"] is answer["phase"] is answer["transitions"] is None
