"""``multibody-xval reference --proof`` as its users run it."""

import json
from decimal import Decimal

import pytest

from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.reference import app
from reference_lcp.exact.proof import prove

POINT = ("--cells", "2", "--frequency-ratio", "0.6", "--proof")


def run(capsys, *arguments):
    code = run_command(app, [*POINT, *arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_missing_package_is_named_in_one_line_before_any_work(capsys, monkeypatch) -> None:
    monkeypatch.setattr(prove, "find_spec", lambda _: None)
    code, out, err = run(capsys)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.endswith("a proof needs python-flint, which is not installed; pip install 'multibody-xval[proof]'\n")


def test_proof_is_in_the_json_as_decimal_strings(capsys) -> None:
    pytest.importorskip("flint", reason="python-flint is not installed")
    code, out, _ = run(capsys, "--friction-ratio", "0.3", "--json")
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
        _, out, _ = run(capsys, "--friction-ratio", friction, "--digits", "30", "--json")
        levels.append(Decimal(json.loads(out)["proof"]["transmittance_db"]["value"]))
    assert float(friction) == 0.3
    assert Decimal("1e-22") < abs(levels[1] - levels[0]) < Decimal("1e-19")


def test_time_that_does_not_suffice_ends_as_not_proven(capsys) -> None:
    pytest.importorskip("flint", reason="python-flint is not installed")
    code, out, _ = run(capsys, "--friction-ratio", "0.3", "--time-limit", "1e-3", "--json")
    answer = json.loads(out)["proof"]
    assert (code, answer["status"]) == (1, "not proven")
    assert answer["reason"] == "the time limit of 0.001 s is over"
    assert answer["transmittance_db"] is answer["phase"] is answer["transitions"] is None
