"""For every clause of the contract an engine that breaks it: red there, for the right reason, and a sound one green."""

import re
from dataclasses import dataclass
from xml.etree import ElementTree

import pytest


@dataclass(frozen=True)
class Fault:
    """What is wrong with an engine: the clause that finds it, and how its message begins."""

    engine: str
    file: str
    clause: str
    reason: str
    case: str = "-joint-tuned"
    sound: str = "sound"
    """The engine that passes."""


INTERFACE, MOTION = "test_interface", "test_laws_of_motion"
INVARIANT = "test_invariance"
AGREEMENT, MODULATED = "test_agreement", "test_modulated_normal_force"
ABILITIES, RANGE, LAW = "test_abilities", "test_wide_range", "test_law"
FAULTS = [
    Fault("forgets", INTERFACE, "test_split_run_equals_whole_run", "the second half starts elsewhere"),
    Fault("remembers", INTERFACE, "test_repeated_run_is_bitwise_equal", "a repeated run differs"),
    Fault(
        "crosstalk", INTERFACE, "test_batch_equals_its_lanes_alone_and_subset_keeps_them", "differs from the lane alone"
    ),
    Fault("short", INTERFACE, "test_advance_ends_where_run_ends", "advance ends at other positions"),
    Fault("nan", INTERFACE, "test_trajectory_has_one_finite_row_a_step_in_si_units", "numbers that are not finite"),
    Fault("unsteady", INTERFACE, "test_many_runs_from_one_state_end_alike", "is not finite"),
    Fault(
        "presses", MOTION, "test_normal_force_is_the_one_that_is_given", "the normal force is not the one that is given"
    ),
    Fault("rubs", MOTION, "test_cells_without_friction_feel_none", "a cell without friction reports some"),
    Fault(
        "floor",
        MOTION,
        "test_faint_friction_moves_the_chain_by_no_more_than_its_impulse",
        "faint friction does more than its impulse",
        "-joint-tuned-0.001",
    ),
    Fault("bound", MOTION, "test_friction_stays_within_its_bound", "friction passes its bound"),
    Fault("sign", MOTION, "test_friction_acts_on_the_inner_mass_against_its_slip", "friction drives the slip"),
    Fault("momentum", MOTION, "test_momentum_changes_by_the_impulse_of_the_reported_forces", "the forces do not"),
    Fault("energy", MOTION, "test_energy_of_a_free_motion_is_never_created", "energy is created"),
    Fault("spring", MOTION, "test_frictionless_limit_is_the_linear_response", "transmittance is off"),
    Fault("creep", MOTION, "test_stuck_limit_is_the_chain_of_locked_masses", "transmittance is off"),
    Fault("drift", MOTION, "test_two_motions_under_one_drive_never_drift_apart", "two motions drift apart"),
    Fault(
        "alike",
        AGREEMENT,
        "test_cells_that_differ_are_each_built_as_given",
        "not the one that was given",
        "-joint-tuned-slipping",
    ),
    Fault("drive", AGREEMENT, "test_pulse_of_the_base_moves_the_chain_as_it_moves_the_reference", "another drive"),
    Fault(
        "coefficient", AGREEMENT, "test_transmittance_at_six_points_agrees_with_the_reference", "transmittance off at"
    ),
    Fault(
        "order",
        AGREEMENT,
        "test_variant_that_shares_the_scheme_equals_the_reference_to_round_off_over_forty_periods",
        "the motion leaves the scheme's",
    ),
    Fault(
        "default",
        AGREEMENT,
        "test_default_stays_finite_and_near_the_reference_for_a_period",
        "this is another chain",
        "-joint-default",
    ),
    Fault(
        "silent", INTERFACE, "test_capabilities_name_the_engine_and_every_option_has_a_reason", "is empty|no reason", ""
    ),
    Fault("takes", INTERFACE, "test_unknown_formulation_and_preset_are_refused", "DID NOT RAISE", ""),
    Fault(
        "shapes",
        INTERFACE,
        "test_chains_of_different_lengths_and_states_of_another_shape_are_refused",
        "DID NOT RAISE",
        "",
    ),
    Fault("late", MODULATED, "test_modulated_normal_force_is_followed", "the motion leaves the scheme's"),
    Fault("rigid", MODULATED, "test_friction_stays_within_a_bound_that_changes", "friction passes its bound"),
    Fault(
        "grounded",
        MODULATED,
        "test_contact_that_is_pulled_open_flies_lands_and_carries_the_impact",
        "time in the air off by",
    ),
    Fault("lands", MODULATED, "test_run_that_is_split_in_a_flight_equals_the_whole_one", "starts elsewhere"),
    Fault("takes", MODULATED, "test_normal_force_that_cannot_be_represented_is_refused", "DID NOT RAISE", ""),
    Fault("units", INVARIANT, "test_units_do_not_matter", "units matter", "-joint-tuned-nanometres"),
    Fault(
        "slippery",
        INVARIANT,
        "test_only_the_bound_enters_whatever_the_coefficient",
        "the coefficient matters",
        "-joint-tuned-tiny",
    ),
    Fault("cuts", INVARIANT, "test_motion_far_above_the_displacement_scale_is_not_cut_off", "is cut off"),
    Fault("pushes", INVARIANT, "test_chain_at_rest_without_a_drive_stays_there", "a chain at rest has moved"),
    Fault("creep", INVARIANT, "test_stuck_contact_does_not_creep", "a stuck contact creeps"),
    Fault("rounds", INVARIANT, "test_state_is_rounded_once_and_not_with_every_run", "another motion after 40 runs"),
    Fault("alike", LAW, "test_random_chain_moves_by_the_reference_s_scheme", "another motion than the scheme's"),
    Fault(
        "lawless",
        LAW,
        "test_random_chain_moves_by_the_law_and_by_no_other",
        "another motion than the law's",
        "-joint-default",
        "lawful",
    ),
    Fault(
        "rubber",
        RANGE,
        "test_chain_anywhere_in_the_ranges_moves_by_the_reference_s_scheme",
        "another motion than the scheme's",
        "-joint-tuned-friction coefficient 1.3",
    ),
    Fault("counts", RANGE, "test_motion_does_not_depend_on_when_it_begins", "another motion after"),
    Fault("wears", RANGE, "test_long_use_leaves_nothing_behind", "another motion after"),
    Fault("turned", ABILITIES, "test_row_along_the_other_tangent_moves_alike", "moves otherwise", sound="able"),
    Fault("aside", ABILITIES, "test_friction_of_a_turned_row_is_read_along_it", "friction is missing", sound="able"),
    Fault("kinetic", ABILITIES, "test_contact_at_rest_holds_more_than_it_slides_with", "slips under", sound="able"),
    Fault("static", ABILITIES, "test_contact_that_lets_go_jumps_under_kinetic_friction", "friction", sound="able"),
    Fault("takes", ABILITIES, "test_what_a_preset_does_not_state_is_refused", "DID NOT RAISE", "-turns"),
]


def node(fault: Fault, name: str) -> str:
    return f"multibody_xval/engines/contract/{fault.file}.py::{fault.clause}[{name}{fault.case}]"


@pytest.fixture(scope="module")
def outcomes(install, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str | None]:
    """Message of every clause that failed, ``None`` for the others; each on its faulty engine and on the sound one."""
    names = sorted({f"faulty-{name}" for fault in FAULTS for name in (fault.engine, fault.sound)})
    file = tmp_path_factory.mktemp("outcomes") / "junit.xml"
    nodes = [node(fault, name) for fault in FAULTS for name in (f"faulty-{fault.engine}", f"faulty-{fault.sound}")]
    options = [part for name in names for part in ("--xval-engine", name)]
    usual = ["-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", "-m", "slow or not slow"]
    command = [*usual, f"--junitxml={file}", *options, *nodes]
    install("wrong_engines").run(*command, code=1)
    messages: dict[str, str | None] = {}
    for case in ElementTree.parse(file).getroot().iter("testcase"):
        failure = case.find("failure")
        messages[case.attrib["name"]] = None if failure is None else failure.attrib["message"] + (failure.text or "")
    assert len(messages) == len(set(nodes))
    return messages


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.engine)
def test_clause_is_red_on_the_engine_that_breaks_it_and_green_on_a_sound_one(outcomes, fault: Fault) -> None:
    message = outcomes[f"{fault.clause}[faulty-{fault.engine}{fault.case}]"]
    assert message is not None, "the fault is not found"
    assert re.search(fault.reason, message)
    assert outcomes[f"{fault.clause}[faulty-{fault.sound}{fault.case}]"] is None


def test_every_clause_of_the_contract_has_its_fault() -> None:
    from importlib import import_module

    clauses = {
        name
        for file in (INTERFACE, MOTION, AGREEMENT, MODULATED, INVARIANT, ABILITIES, RANGE, LAW)
        for name in vars(import_module(f"multibody_xval.engines.contract.{file}"))
        if name.startswith("test_")
    }
    assert clauses == {fault.clause for fault in FAULTS}


def test_a_sound_engine_passes_whatever_its_name(install) -> None:
    command = "-m pytest -q -n 0 -p no:cacheprovider --xval-engine mine+fast"
    install("wrong_engines").run(
        *command.split(),
        f"multibody_xval/engines/contract/{INTERFACE}.py",
        f"multibody_xval/engines/contract/{MODULATED}.py",
    )


def ran(install, engine: str, *options: str, code: int = 0) -> str:
    """Give what the contract prints of an engine's clauses of the interface."""
    command = f"-m pytest -q -n 0 -p no:cacheprovider --xval-engine {engine}".split()
    return install("wrong_engines").run(*command, *options, code=code)


def test_a_failure_is_one_line_with_what_was_asked_what_came_and_what_is_allowed(install) -> None:
    printed = ran(install, "faulty-forgets", f"multibody_xval/engines/contract/{INTERFACE}.py", code=1)
    number = r"\d\S*"
    assert re.search(
        "^faulty-forgets-joint-tuned: split run equals whole run: the second half starts elsewhere "
        rf"\[m\]: {number}; allowed: at most 0$",
        printed,
        re.MULTILINE,
    )
    assert "Traceback" not in printed
    assert "assert " not in printed


def test_a_law_that_cannot_be_made_fails_its_own_clause_alone(install) -> None:
    printed = ran(install, "faulty-lawless", f"multibody_xval/engines/contract/{LAW}.py", "--tb=line", code=1)
    assert "2 failed, 1 passed" in printed
    assert "ZeroDivisionError: 1 / 0" in printed


def test_what_a_maintainer_knows_of_fails_no_run_and_is_missed_when_it_is_mended(install, tmp_path) -> None:
    known = tmp_path / "known.txt"
    clauses = f"multibody_xval/engines/contract/{INTERFACE}.py"
    known.write_text(
        "# of version 1\n"
        "test_interface.py::test_split_run_equals_whole_run[faulty-forgets-joint-tuned]  # known\n"
        "test_interface.py::test_split_run_equals_whole_run[faulty-forgets-joint-default]  # the same\n"
    )
    assert "2 xfailed" in ran(install, "faulty-forgets", f"--xfails-file={known}", clauses)
    mended = known.read_text().replace("faulty-forgets", "faulty-sound")
    known.write_text(mended)
    assert "2 failed" in ran(install, "faulty-sound", f"--xfails-file={known}", clauses, code=1)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("test_split_run_equals_whole_run[faulty-sound-joint-tuned]", "line 1: .* has no reason"),
        ("test_x  # a\ntest_x  # b", "line 2: test_x is there twice"),
        ("test_split[faulty-sound]  # it is new", r"names test_split\[faulty-sound\]; allowed: tests that are run"),
    ],
)
def test_a_mistake_in_the_file_of_known_failures_is_one_line(install, tmp_path, line: str, said: str) -> None:
    known = tmp_path / "known.txt"
    known.write_text(line)
    clauses = f"multibody_xval/engines/contract/{INTERFACE}.py"
    assert re.search(said, ran(install, "faulty-sound", f"--xfails-file={known}", clauses, code=4))
