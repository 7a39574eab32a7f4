"""``multibody-xval reference`` as its users run it, with ``--proof`` too."""

import json
import re
from decimal import Decimal

import pytest

from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.reference import app
from reference_lcp.exact.proof import prove
from tests.reference_lcp.cases import EXACT_DB


def run(capsys, line: str):
    code = run_command(app, line.split())
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def answered(capsys, line: str):
    """Give what a command prints as JSON."""
    code, out, _ = run(capsys, f"{line} --json")
    assert code == 0
    return json.loads(out)


def test_json_has_the_promised_keys_and_the_steady_state(capsys) -> None:
    answer = answered(capsys, "--friction-ratio 0.3 --frequency-ratio 0.9 --base-amplitude 0.02")
    assert answer["transmittance_db"] == pytest.approx(-9.561, abs=0.02)
    assert answer["residual"] <= 1e-8
    assert len(answer["stuck_fraction"]) == 7
    assert {"cell", "time_s", "kind"} == set(answer["transitions"][0])
    assert {change["kind"] for change in answer["transitions"]} == {"stick", "forward slip", "backward slip"}
    assert re.search(r"transmittance\s+-9\.5602 dB", run(capsys, "")[1])


def test_every_solver_prints_the_same_keys_and_its_transmittance(capsys) -> None:
    (friction, frequency), level = next(iter(EXACT_DB.items()))
    place = f"--friction-ratio {friction} --frequency-ratio {frequency}"
    exact, compiled = (answered(capsys, f"{place} --solver {solver}") for solver in ("exact", "compiled"))
    assert exact.keys() == compiled.keys()
    assert exact["transmittance_db"] == pytest.approx(level, abs=1e-3)
    cell = "--cells 1 --friction-ratio 0.3 --frequency-ratio 0.8 --solver"
    lemke, compiled = (answered(capsys, f"{cell} {solver}")["transmittance_db"] for solver in ("lemke", "compiled"))
    assert lemke == pytest.approx(compiled, abs=1e-9)


def test_no_steady_state_within_the_periods_is_exit_code_1_and_a_period_is_drawn(capsys, tmp_path) -> None:
    code, out, _ = run(capsys, "--max-periods 5 --json")
    assert (code, json.loads(out)["status"]) == (1, "period limit")
    assert run(capsys, f"--cells 3 --plot {tmp_path / 'period.png'}")[0] == 0
    assert (tmp_path / "period.png").read_bytes().startswith(b"\x89PNG")


def test_error_bar_and_exact_value_are_printed_and_what_cannot_be_resolved_is_said_to_be(capsys) -> None:
    answer = answered(capsys, "--error-bar --exact-value")
    error = abs(answer["transmittance_db"] - answer["exact_db"])
    assert error <= answer["error_bar_db"] <= 10 * error
    assert answer["order"] == pytest.approx(1.0, abs=0.3)
    deep = "--cells 10 --mass-ratio 3 --stiffness-ratio 3 --frequency-ratio 2.5 --tolerance 1e-10 --error-bar"
    answer = answered(capsys, f"{deep} --exact-value")
    assert answer["error_bar_db"] is None
    assert answer["exact_db"] < answer["floor_db"] < -140
    assert re.search(r"error bar\s+below what can be resolved: at most -1\d\d\.\d dB", run(capsys, deep)[1])


POINT = "--cells 2 --frequency-ratio 0.6 --proof"


def test_missing_package_is_named_in_one_line_before_any_work(capsys, monkeypatch) -> None:
    monkeypatch.setattr(prove, "find_spec", lambda _: None)
    said = "a proof needs python-flint, which is not installed; pip install 'multibody-xval[proof]'\n"
    code, out, err = run(capsys, POINT)
    assert (code, out, err.count("\n"), err.endswith(said)) == (2, "", 1, True)


def test_proof_is_in_the_json_as_decimal_strings(capsys) -> None:
    pytest.importorskip("flint", reason="python-flint is not installed")
    answer = answered(capsys, f"{POINT} --friction-ratio 0.3")["proof"]
    assert (answer["status"], answer["reason"], answer["unique_by"]) == ("proven", None, "damping")
    for name in ("transmittance_db", "phase"):
        assert Decimal(answer[name]["radius"]) < Decimal("1e-20")
    # The exact solver gives 1.69877440905827...
    assert answer["transmittance_db"]["value"].startswith("1.69877440905827")
    assert {"cell", "kind", "time_over_period"} == set(answer["transitions"][0])
    assert len(answer["transitions"]) == 4


def test_ratios_are_the_decimals_that_were_typed(capsys) -> None:
    """Both decimals are the same double; the level differs where the ratios do."""
    pytest.importorskip("flint", reason="python-flint is not installed")
    typed = ("0.3", "0.300000000000000000001")
    proofs = [answered(capsys, f"{POINT} --friction-ratio {own} --digits 30")["proof"] for own in typed]
    levels = [Decimal(own["transmittance_db"]["value"]) for own in proofs]
    assert float(typed[1]) == 0.3
    assert Decimal("1e-22") < abs(levels[1] - levels[0]) < Decimal("1e-19")
