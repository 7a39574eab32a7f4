"""For every clause of the contract an engine that breaks it: red there, for the right reason, and a sound one green."""

import re
from importlib import import_module
from pathlib import Path
from xml.etree import ElementTree

import pytest

from multibody_xval.engines import contract

SOUND = "a+b"
"""The engine that passes: whatever its name means in a regular expression."""

TUNED, DEFAULT, ENGINE = "-joint-tuned", "-joint-default", ""

FAULTS = (
    ("rounds", "split_run_equals_whole_run", "the second half starts elsewhere", TUNED),
    ("remembers", "repeated_run_is_bitwise_equal", "a repeated run differs", TUNED),
    ("crosstalk", "batch_equals_its_lanes_alone_and_subset_keeps_them", "differs from the lane alone", TUNED),
    ("short", "advance_ends_where_run_ends", "advance ends at other positions", TUNED),
    ("nan", "trajectory_has_one_finite_row_a_step_in_si_units", "numbers that are not finite", TUNED),
    ("by-chance", "many_runs_from_one_state_end_alike", "is not finite", TUNED),
    ("unsaid", "capabilities_name_the_engine_and_every_option_has_a_reason", "no reason", ENGINE),
    ("takes", "unknown_formulation_and_preset_are_refused", "DID NOT RAISE", ENGINE),
    ("shapes", "chains_of_different_lengths_and_states_of_another_shape_are_refused", "DID NOT RAISE", ENGINE),
    ("presses", "normal_force_is_the_one_that_is_given", "the normal force is not the one that is given", TUNED),
    ("alike", "cells_without_friction_feel_none", "a cell without friction reports some", TUNED),
    ("noise", "faint_friction_moves_the_chain_by_no_more_than_its_impulse", "more than its impulse", f"{TUNED}-1e-06"),
    ("bound", "friction_stays_within_its_bound", "friction passes its bound", TUNED),
    ("sign", "friction_acts_on_the_inner_mass_against_its_slip", "friction drives the slip", TUNED),
    ("half", "momentum_changes_by_the_impulse_of_the_reported_forces", "the forces do not", TUNED),
    ("energy", "energy_of_a_free_motion_is_never_created", "energy is created", TUNED),
    ("inner-spring", "frictionless_limit_is_the_linear_response", "transmittance is off", TUNED),
    ("slips", "stuck_limit_is_the_chain_of_locked_masses", "transmittance is off", TUNED),
    ("energy", "two_motions_under_one_drive_never_drift_apart", "two motions drift apart", TUNED),
    ("alike", "cells_that_differ_are_each_built_as_given", "the motion of unequal cells differs", f"{TUNED}-slipping"),
    ("sine", "pulse_of_the_base_moves_the_chain_as_it_moves_the_reference", "after a pulse of the base differs", TUNED),
    ("bound", "transmittance_at_six_points_agrees_with_the_reference", "transmittance off at", TUNED),
    ("explicit", "variant_that_shares_the_scheme_equals_the_reference_to_round_off_over_forty_periods",
     "the motion differs from the reference's", TUNED),
    ("kilogram-force", "default_stays_finite_and_near_the_reference_for_a_period", "the motion differs", DEFAULT),
    ("late-bound", "modulated_normal_force_is_followed", "the motion differs", TUNED),
    ("rigid", "friction_stays_within_a_bound_that_changes", "friction passes its bound", TUNED),
    ("grounded", "contact_that_is_pulled_open_flies_lands_and_carries_the_impact", "time in the air off by", TUNED),
    ("lands", "run_that_is_split_in_a_flight_equals_the_whole_one", "starts elsewhere", TUNED),
    ("takes", "normal_force_that_cannot_be_represented_is_refused", "DID NOT RAISE", ENGINE),
    ("quantum", "units_do_not_matter", "the motion in these units differs", f"{TUNED}-nanometres"),
    ("slippery", "only_the_bound_enters_whatever_the_coefficient", "with this coefficient", f"{TUNED}-tiny"),
    ("cuts", "motion_far_above_the_displacement_scale_is_not_cut_off", "a large motion differs", TUNED),
    ("push", "chain_at_rest_without_a_drive_stays_there", "a chain at rest has moved", TUNED),
    ("creep", "stuck_contact_does_not_creep", "a stuck contact creeps", TUNED),
    ("rounds", "state_is_rounded_once_and_not_with_every_run", "another motion after 40 runs", TUNED),
    ("one-mass", "random_chain_moves_by_the_reference_s_scheme", "the motion of a random chain differs", TUNED),
    ("lawless", "random_chain_moves_by_the_law_and_by_no_other", "another motion than the law's", DEFAULT),
    ("no-law", "random_chain_moves_by_the_law_and_by_no_other", "KeyError: 'part'", DEFAULT),
    ("rubber", "chain_anywhere_in_the_ranges_moves_by_the_reference_s_scheme", "the motion differs",
     f"{TUNED}-friction coefficient 1.3"),
    ("counts", "motion_does_not_depend_on_when_it_begins", "another motion after", TUNED),
    ("wears", "long_use_leaves_nothing_behind", "another motion after", TUNED),
    ("holds-no-more", "contact_at_rest_holds_more_than_it_slides_with", "slips under", TUNED),
    ("never-lets-go", "contact_that_lets_go_jumps_under_kinetic_friction", "friction", TUNED),
    ("milliradian", "scene_repeats_and_moves_no_farther_than_without_friction", "farther than it can", "-joint-scenes"),
    ("takes", "static_friction_that_a_preset_does_not_state_is_refused", "DID NOT RAISE", ENGINE),
)  # fmt: skip
"""Fault, the clause that finds it, how its message begins, and the case of the clause."""

CLAUSES = {
    clause.removeprefix("test_"): file
    for file in sorted(Path(contract.__file__).parent.glob("test_*.py"))
    for clause in vars(import_module(f"{contract.__name__}.{file.stem}"))
    if clause.startswith("test_")
}
"""Every clause of the contract, and its file."""


def case_of(fault: str, clause: str, case: str) -> str:
    return f"test_{clause}[faulty-{fault}{case}]"


def ran(install, engines: set[str], *options: str, code: int) -> str:
    """Run clauses of the contract for engines of the family; gives what is printed."""
    named = [part for name in sorted(engines) for part in ("--xval-engine", f"faulty-{name}")]
    usual = ["-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", "-m", "slow or not slow"]
    return install("faulty").run(*usual, *named, *options, code=code)


@pytest.fixture(scope="module")
def outcomes(install, tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, str | None], str]:
    """What every clause says that failed, ``None`` for the others, each on its faulty engine and on the sound one; and
    what is printed."""
    file = tmp_path_factory.mktemp("outcomes") / "junit.xml"
    nodes = {f"{CLAUSES[clause]}::{case_of(name, clause, case)}"
             for fault, clause, _, case in FAULTS for name in (fault, SOUND)}  # fmt: skip
    printed = ran(install, {SOUND, *(fault for fault, *_ in FAULTS)}, f"--junitxml={file}", *sorted(nodes), code=1)
    failures = {
        case.attrib["name"]: case.find("failure") for case in ElementTree.parse(file).getroot().iter("testcase")
    }
    assert len(failures) == len(nodes)
    return {
        name: None if own is None else f"{own.attrib['message']}{own.text}" for name, own in failures.items()
    }, printed


@pytest.mark.parametrize(("fault", "clause", "reason", "case"), FAULTS)
def test_clause_is_red_on_the_engine_that_breaks_it_and_green_on_a_sound_one(
    outcomes, fault: str, clause: str, reason: str, case: str
) -> None:
    messages, _ = outcomes
    assert reason in str(messages[case_of(fault, clause, case)])
    assert messages[case_of(SOUND, clause, case)] is None


def test_every_clause_of_the_contract_has_its_fault() -> None:
    assert set(CLAUSES) == {clause for _, clause, *_ in FAULTS}


def test_a_failure_is_one_line_with_what_was_asked_what_came_and_what_is_allowed(outcomes) -> None:
    line = r"^faulty-rounds-joint-tuned: split run equals whole run: .* \[m\]: \d\S*; allowed: at most 0$"
    assert re.search(line, outcomes[1], re.MULTILINE)
    assert "Traceback" not in outcomes[1]


def test_a_preset_that_runs_scenes_only_is_held_to_the_clauses_of_scenes_and_to_no_other(install) -> None:
    printed = ran(install, {SOUND}, "--collect-only", "--pyargs", contract.__name__, code=0)
    asked = {
        name: set(re.findall(rf"::test_(\w+)\[faulty-a\+b-joint-{name}[\]-]", printed)) for name in ("scenes", "tuned")
    }
    assert asked["scenes"] == {"scene_repeats_and_moves_no_farther_than_without_friction"}
    assert len(asked["tuned"]) > 20


def test_what_fails_first_is_the_cause(install) -> None:
    """A bound that is 1 % too large changes every motion; the first line is that of the bound, with both numbers."""
    where = str(Path(contract.__file__).parent)
    printed = ran(install, {"bound"}, "-x", "-k", "joint-tuned and not many_runs", where, code=1)
    line = "^faulty-bound-joint-tuned: friction stays within its bound: .* part of it: 0.01; allowed: at most 1e-06$"
    assert re.search(line, printed, re.MULTILINE), printed


INTERFACE = str(CLAUSES["advance_ends_where_run_ends"])


def test_what_a_maintainer_knows_of_fails_no_run_and_is_missed_when_it_is_mended(install, tmp_path) -> None:
    known = tmp_path / "known.txt"
    case = "test_interface.py::test_split_run_equals_whole_run[faulty-{}-joint-{}]  # known\n"
    for name, code, said in (("rounds", 0, "2 xfailed"), ("a+b", 1, "2 failed")):
        known.write_text("".join(case.format(name, preset) for preset in ("tuned", "other")))
        assert said in ran(install, {name}, f"--xfails-file={known}", INTERFACE, code=code)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("test_split_run_equals_whole_run[faulty-sound-joint-tuned]", "line 1: .* has no reason"),
        ("test_split[faulty-sound]  # it is new", r"names test_split\[faulty-sound\]; allowed: tests that are run"),
    ],
)
def test_a_mistake_in_the_file_of_known_failures_is_one_line(install, tmp_path, line: str, said: str) -> None:
    known = tmp_path / "known.txt"
    known.write_text(line)
    assert re.search(said, ran(install, {"sound"}, f"--xfails-file={known}", INTERFACE, code=4))
