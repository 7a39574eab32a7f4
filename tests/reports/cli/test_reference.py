"""``multibody-xval reference`` as its users run it."""

import json
import re

import pytest

from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.reference import app
from reference_lcp.errors import ExitCode
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
    answer = answered(capsys, "--friction-ratio", "0.3", "--frequency-ratio", "0.9")
    assert answer["transmittance_db"] == pytest.approx(-9.561, abs=0.02)
    assert answer["residual"] <= 1e-8
    assert len(answer["stuck_fraction"]) == 7
    assert {"cell", "time_s", "kind"} == set(answer["transitions"][0])
    assert {change["kind"] for change in answer["transitions"]} == {"stick", "forward slip", "backward slip"}


def test_every_parameter_of_the_chain_is_understood(capsys) -> None:
    answer = answered(
        capsys, "--mass-ratio", "0.3", "--stiffness-ratio", "0.075", "--damping-ratio", "0.02",
        "--inner-damping-ratio", "0.01", "--cells", "2", "--steps-per-period", "800", "--solver", "compiled",
        "--base-amplitude", "0.02", "--tolerance", "1e-7", "--max-periods", "300",
    )  # fmt: skip
    assert len(answer["stuck_fraction"]) == 2
    assert answer["status"] == "converged"


def test_units_of_the_base_motion_do_not_change_the_transmittance(capsys) -> None:
    amplitudes = ("1e-6", "0.01", "100")
    answers = [answered(capsys, "--base-amplitude", amplitude)["transmittance_db"] for amplitude in amplitudes]
    assert answers == pytest.approx([answers[0]] * 3, abs=1e-6)


def test_text_shows_every_cell(capsys) -> None:
    code, out, _ = run(capsys)
    assert code == 0
    assert re.search(r"transmittance\s+-9\.5602 dB", out)
    assert all(re.search(rf"^ {cell}  ", out, re.MULTILINE) for cell in range(1, 8))


def test_lemke_prints_the_same_transmittance_to_1e_9_db(capsys) -> None:
    arguments = ("--cells", "1", "--friction-ratio", "0.3", "--frequency-ratio", "0.8", "--solver")
    lemke, compiled = (answered(capsys, *arguments, solver)["transmittance_db"] for solver in ("lemke", "compiled"))
    assert lemke == pytest.approx(compiled, abs=1e-9)


def test_more_steps_than_requested_come_with_the_reason(capsys) -> None:
    """ω_max of the canonical chain is 2.25 ω_r: a period at 0.9 ω_r needs 2π (2.25 / 0.9) / 0.4 = 39.3 steps."""
    answer = answered(capsys, "--steps-per-period", "16")
    assert (answer["steps_per_period_requested"], answer["steps_per_period"]) == (16, 40)
    assert "dt ω_max <= 0.4" in answer["why_more_steps"]
    _, text, _ = run(capsys, "--steps-per-period", "16")
    assert re.search(r"steps per period\s+40 .*\n\s+16 requested; more keep dt ω_max <= 0.4", text)


def test_as_many_steps_as_requested_need_no_reason(capsys) -> None:
    answer = answered(capsys, "--steps-per-period", "500")
    assert (answer["steps_per_period_requested"], answer["steps_per_period"]) == (500, 500)
    assert answer["why_more_steps"] is None
    assert "asked" not in run(capsys, "--steps-per-period", "500")[1]


def test_plot_is_drawn(capsys, tmp_path) -> None:
    file = tmp_path / "period.png"
    code, _, _ = run(capsys, "--cells", "3", "--plot", str(file))
    assert code == 0
    assert file.read_bytes().startswith(b"\x89PNG")
    assert file.stat().st_size > 20_000


def test_no_steady_state_within_the_periods_is_exit_code_1(capsys) -> None:
    code, out, _ = run(capsys, "--max-periods", "5", "--json")
    assert code == 1
    assert json.loads(out)["status"] == "period limit"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--friction-ratio", "-1"], ["friction_ratio = -1", ">= 0"]),
        (["--friction-ratio", "nan"], ["friction_ratio = nan"]),
        (["--frequency-ratio", "0"], ["frequency_ratio = 0", "> 0"]),
        (["--frequency-ratio", "-0.5"], ["frequency_ratio = -0.5"]),
        (["--mass-ratio", "-2"], ["mass_ratio = -2", "> 0"]),
        (["--stiffness-ratio", "0"], ["stiffness_ratio = 0", "> 0"]),
        (["--damping-ratio", "-0.01"], ["damping_ratio = -0.01", ">= 0"]),
        (["--cells", "0"], ["cells = 0", ">= 1"]),
        (["--cells", "seven"], ["--cells"]),
        (["--steps-per-period", "3"], ["steps_per_period = 3 ", ">= 16"]),
        (["--steps-per-period", "15", "--solver", "exact"], ["steps_per_period = 15 ", ">= 16"]),
        (["--solver", "magic"], ["solver = 'magic'", "compiled, lemke, exact"]),
        (["--tolerance", "0"], ["tolerance = 0"]),
        (["--max-periods", "0"], ["max_periods = 0"]),
        (["--base-amplitude", "0"], ["base_amplitude = 0"]),
        (["--plot", "/nowhere/at/all.png"], ["/nowhere/at does not exist"]),
        (["--plot", "period.xyz"], ["period.xyz", "png"]),
        (["--frequency"], ["--frequency"]),
        (["benchmark"], ["benchmark"]),
        (["coverage"], ["coverage"]),
    ],
)
def test_wrong_input_is_one_clear_line_and_exit_code_2(capsys, arguments, words) -> None:
    code, out, err = run(capsys, *arguments)
    assert code == ExitCode.WRONG_INPUT
    assert out == ""
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    for word in words:
        assert word in err


@pytest.mark.slow
def test_bench_prints_its_numbers(capsys) -> None:
    numbers = answered(capsys, "bench")
    assert numbers["figure3_points"] == 1314
    assert numbers["figure3_worst_residual"] <= 1e-8
    assert numbers["cell_steps_per_second"] > 0
    assert numbers["figure3_seconds"] > 0
    assert numbers["steady_states_per_second"] == pytest.approx(1314 / numbers["figure3_seconds"])


def test_error_bar_and_exact_value_are_printed(capsys) -> None:
    answer = answered(capsys, "--error-bar", "--exact-value")
    error = abs(answer["transmittance_db"] - answer["exact_db"])
    assert error <= answer["error_bar_db"] <= 10 * error
    assert answer["order"] == pytest.approx(1.0, abs=0.3)
    _, text, _ = run(capsys, "--error-bar", "--exact-value")
    assert re.search(r"error bar\s+±0\.00", text)
    assert re.search(r"exact\s+-9\.5612 dB", text)


def test_what_cannot_be_resolved_is_said_to_be(capsys) -> None:
    deep = ["--cells", "10", "--mass-ratio", "3", "--stiffness-ratio", "3", "--frequency-ratio", "2.5", "--error-bar"]
    answer = answered(capsys, *deep, "--exact-value")
    assert answer["error_bar_db"] is None
    assert answer["exact_db"] < answer["floor_db"] < -140
    _, text, _ = run(capsys, *deep)
    assert re.search(rf"error bar\s+below what can be resolved: at most {answer['floor_db']:.1f} dB", text)
    assert "±" in text


@pytest.mark.parametrize("place", EXACT_DB)
def test_exact_solver_prints_the_same_keys(capsys, place) -> None:
    arguments = ("--friction-ratio", str(place[0]), "--frequency-ratio", str(place[1]))
    exact = answered(capsys, *arguments, "--solver", "exact")
    assert exact.keys() == answered(capsys, *arguments).keys()
    assert exact["transmittance_db"] == pytest.approx(EXACT_DB[place], abs=1e-3)
