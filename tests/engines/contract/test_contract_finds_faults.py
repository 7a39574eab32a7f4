"""For every clause of the contract an engine that breaks it: red there, for the right reason, and a sound one green."""

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


INTERFACE, MOTION = "test_interface", "test_laws_of_motion"
INVARIANT = "test_invariance"
AGREEMENT, MODULATED = "test_agreement", "test_modulated_normal_force"
FAULTS = [
    Fault("forgets", INTERFACE, "test_split_run_equals_whole_run", "the second half starts elsewhere"),
    Fault("remembers", INTERFACE, "test_repeated_run_is_bitwise_equal", "a repeated run differs"),
    Fault(
        "crosstalk", INTERFACE, "test_batch_equals_its_lanes_alone_and_subset_keeps_them", "differs from the lane alone"
    ),
    Fault("short", INTERFACE, "test_advance_ends_where_run_ends", "advance ends at other positions"),
    Fault("nan", INTERFACE, "test_trajectory_has_one_finite_row_a_step_in_si_units", "numbers that are not finite"),
    Fault("unsteady", INTERFACE, "test_many_runs_from_one_state_end_alike", "is not finite"),
    Fault("presses", MOTION, "test_normal_force_is_the_one_that_is_given", "Mismatched elements"),
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
    Fault("spring", MOTION, "test_frictionless_limit_is_the_linear_response", "± 0.1", "-joint-tuned"),
    Fault("creep", MOTION, "test_stuck_limit_is_the_chain_of_locked_masses", "± 0.1", "-joint-tuned"),
    Fault("drift", MOTION, "test_two_motions_under_one_drive_never_drift_apart", "two motions drift apart"),
    Fault(
        "alike",
        AGREEMENT,
        "test_cells_that_differ_are_each_built_as_given",
        "not the one that was given",
        "-joint-tuned-slipping",
    ),
    Fault("drive", AGREEMENT, "test_pulse_of_the_base_moves_the_chain_as_it_moves_the_reference", "another drive"),
    Fault("coefficient", AGREEMENT, "test_transmittance_at_six_points_agrees_with_the_reference", "off by "),
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
    Fault("silent", INTERFACE, "test_capabilities_name_the_engine_and_every_option_has_a_reason", "all(", ""),
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
    Fault("rounds", INVARIANT, "test_state_is_rounded_once_and_not_with_every_run", "U0 after 40 runs"),
]


def node(fault: Fault, name: str) -> str:
    return f"multibody_xval/engines/contract/{fault.file}.py::{fault.clause}[{name}{fault.case}]"


@pytest.fixture(scope="module")
def outcomes(install, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str | None]:
    """Message of every clause that failed, ``None`` for the others; each on its faulty engine and on the sound one."""
    names = sorted({f"faulty-{fault.engine}" for fault in FAULTS} | {"faulty-sound"})
    file = tmp_path_factory.mktemp("outcomes") / "junit.xml"
    nodes = [node(fault, name) for fault in FAULTS for name in (f"faulty-{fault.engine}", "faulty-sound")]
    options = [part for name in names for part in ("--xval-engine", name)]
    usual = ["-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", "-m", "slow or not slow"]
    command = [*usual, f"--junitxml={file}", *options, *nodes]
    install("wrong_engines").run(*command, code=1)
    messages: dict[str, str | None] = {}
    for case in ElementTree.parse(file).getroot().iter("testcase"):
        failure = case.find("failure")
        messages[case.attrib["name"]] = None if failure is None else failure.attrib["message"] + (failure.text or "")
    assert len(messages) == len(nodes)
    return messages


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.engine)
def test_clause_is_red_on_the_engine_that_breaks_it_and_green_on_a_sound_one(outcomes, fault: Fault) -> None:
    message = outcomes[f"{fault.clause}[faulty-{fault.engine}{fault.case}]"]
    assert message is not None, "the fault is not found"
    assert fault.reason in message
    assert outcomes[f"{fault.clause}[faulty-sound{fault.case}]"] is None


def test_every_clause_of_the_contract_has_its_fault() -> None:
    from importlib import import_module

    clauses = {
        name
        for file in (INTERFACE, MOTION, AGREEMENT, MODULATED, INVARIANT)
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
