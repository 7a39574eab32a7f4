"""The problems' files: exact by other solvers and closed forms, as their schema says, and as they are recorded."""

import json
from decimal import Decimal

import jsonschema
import numpy as np
import pytest

from multibody_xval.scenarios.catalogue.proofs import exact_chain
from multibody_xval.scenarios.model import Case
from multibody_xval.scenarios.ruler.proven import proven_levels
from multibody_xval.scenarios.truth import problem_named, problems
from multibody_xval.scenarios.truth.problem import Problem, problem_of, text_of
from multibody_xval.scenarios.truth.record import FOLDER, recorded
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.exact.proof.prove import prove

FILES = sorted((FOLDER / "problems").glob("*.json"))
CHAINS = [name for name in problems() if name.startswith("chain")]
OPERATING_POINTS = [
    Case(friction_ratio=friction, frequency_ratio=frequency)
    for friction, frequency in ((0.1, 0.6), (0.3, 0.9), (0.6, 0.7), (1.0, 1.2))
]


def test_the_schema_is_that_of_the_reader():
    schema = json.loads((FOLDER / "problem.schema.json").read_text())
    assert schema == Problem.model_json_schema()
    for file in FILES:
        jsonschema.validate(json.loads(file.read_text()), schema)


def test_a_file_with_another_word_or_of_another_format_is_refused():
    data = json.loads(FILES[0].read_text()) | {"mases": [1.0]}
    with pytest.raises(jsonschema.ValidationError, match="mases"):
        jsonschema.validate(data, Problem.model_json_schema())
    refused = {json.dumps(data): r"mases of some.json: .*allowed: what problem.schema.json says", "{": "is no JSON"}
    for text, message in {**refused, '{"format": 2}': "= 2; allowed: 1", "[]": "= None"}.items():
        with pytest.raises(ParameterError, match=message):
            problem_of(text, "some.json")


@pytest.mark.slow
def test_blocks_and_cells_are_recorded_again_to_the_last_digit():
    for name in problems().keys() - set(CHAINS):
        assert text_of(recorded(problem_named(name))) == (FOLDER / "problems" / f"{name}.json").read_text()


@pytest.mark.parametrize("name", CHAINS)
def test_chains_move_as_the_event_driven_chain_does(name):
    problem = problem_named(name)
    n, rubs = 7, problem.contact_normal_force[0]
    chain = Chain.from_ratios(friction_ratio=rubs * problem.contact_kinetic[0] / 10)
    drive = HarmonicBase(problem.base_amplitude, problem.angular_frequency)
    lane = Lane(chain, drive, problem.time_step)
    start = State(np.array([problem.start_position]), np.array([problem.start_velocity]))
    steps = np.rint(np.array(problem.times) / problem.time_step).astype(int)
    motion = EventDrivenSimulation([lane]).run(start, 0, int(steps[-1]))[0]
    assert motion.positions.shape[1] == 2 * n
    assert np.max(np.abs(motion.positions[steps - 1] - problem.positions)) <= problem.position_uncertainty
    assert np.max(np.abs(motion.velocities[steps - 1] - problem.velocities)) <= problem.velocity_uncertainty


@pytest.mark.parametrize("case", OPERATING_POINTS, ids=lambda case: case.title)
def test_transmittance_and_phase_are_those_of_the_table_of_proofs(case):
    problem, level = (
        problem_named(f"chain-steady-{case.friction_ratio:g}-{case.frequency_ratio:g}"),
        proven_levels()[case],
    )
    found = problem.observables
    assert len(problem.transitions) == level.events
    for name, value in (("transmittance", level.transmittance_db), ("phase", level.phase)):
        assert abs(Decimal(found[name].value) - value) <= Decimal(found[name].radius) + Decimal("1e-20")


def test_contacts_stick_and_slip_when_a_proof_says_so():
    found = problem_named("chain-steady-1-1.2").transitions
    proven = prove(exact_chain(OPERATING_POINTS[-1])).transitions
    assert [(own.contact, own.kind) for own in found] == [(own.cell - 1, str(own.kind)) for own in proven]
    for own, other in zip(found, proven, strict=True):
        apart = abs(Decimal(own.time.value) - Decimal(str(other.time_over_period.value)))
        assert apart <= Decimal(own.time.radius) + Decimal(str(other.time_over_period.radius))


def test_a_block_stops_where_its_energy_is_spent():
    problem = problem_named("block-stops")
    times = np.minimum(problem.times, 2 / 3)
    assert np.array(problem.positions)[:, 0] == pytest.approx(times - 0.75 * times**2, abs=1e-11)
    assert float(problem.observables["stopping_distance"].value) == pytest.approx(problem.positions[-1][0], abs=1e-11)
