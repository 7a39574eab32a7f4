"""Problems with exact motions, as they are recorded and proven, and motions that any program wrote beside them."""

import json
import re
from decimal import Decimal
from functools import cache

import jsonschema
import numpy as np
import pandas as pd
import pytest

from multibody_xval.scenarios.catalogue.proofs import exact_chain
from multibody_xval.scenarios.model import Case
from multibody_xval.scenarios.ruler.proven import proven_levels
from multibody_xval.scenarios.truth import judged, problem_named, problems, read_motion
from multibody_xval.scenarios.truth.problem import Problem, problem_of, text_of
from multibody_xval.scenarios.truth.record import FOLDER, recorded
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.exact.proof.prove import prove
from reference_lcp.lcp.systems import simulate_system

FILES = sorted((FOLDER / "problems").glob("*.json"))
CHAINS = [name for name in problems() if name.startswith("chain")]
OPERATING_POINTS = [
    Case(friction_ratio=friction, frequency_ratio=frequency)
    for friction, frequency in ((0.1, 0.6), (0.3, 0.9), (0.6, 0.7), (1.0, 1.2))
]


def test_files_are_as_their_schema_says_and_one_with_another_word_or_of_another_format_is_refused():
    schema = json.loads((FOLDER / "problem.schema.json").read_text())
    assert schema == Problem.model_json_schema()
    for file in FILES:
        jsonschema.validate(json.loads(file.read_text()), schema)
    data = json.loads(FILES[0].read_text()) | {"mases": [1.0]}
    with pytest.raises(jsonschema.ValidationError, match="mases"):
        jsonschema.validate(data, schema)
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
    chain = Chain.from_ratios(friction_ratio=problem.contact_normal_force[0] * problem.contact_kinetic[0] / 10)
    lane = Lane(chain, HarmonicBase(problem.base_amplitude, problem.angular_frequency), problem.time_step)
    start = State(np.array([problem.start_position]), np.array([problem.start_velocity]))
    rows = np.rint(np.array(problem.times) / problem.time_step).astype(int) - 1
    motion = EventDrivenSimulation([lane]).run(start, 0, int(rows[-1]) + 1)[0]
    assert np.max(np.abs(motion.positions[rows] - problem.positions)) <= problem.position_uncertainty
    assert np.max(np.abs(motion.velocities[rows] - problem.velocities)) <= problem.velocity_uncertainty


@pytest.mark.parametrize("case", OPERATING_POINTS, ids=lambda case: case.title)
def test_transmittance_phase_and_transitions_are_those_that_are_proven(case):
    problem = problem_named(f"chain-steady-{case.friction_ratio:g}-{case.frequency_ratio:g}")
    found, level = problem.observables, proven_levels()[case]
    for name, value in (("transmittance", level.transmittance_db), ("phase", level.phase)):
        assert abs(Decimal(found[name].value) - value) <= Decimal(found[name].radius) + Decimal("1e-20")
    assert len(problem.transitions) == level.events
    if case == OPERATING_POINTS[-1]:
        proven = prove(exact_chain(case)).transitions
        assert [(own.contact, own.kind) for own in problem.transitions] == [
            (own.cell - 1, str(own.kind)) for own in proven
        ]
        for own, other in zip(problem.transitions, proven, strict=True):
            apart = abs(Decimal(own.time.value) - Decimal(str(other.time_over_period.value)))
            assert apart <= Decimal(own.time.radius) + Decimal(str(other.time_over_period.radius))


@cache
def moved(name, refined, friction):
    """Simulate a problem with the symplectic Euler scheme, in `refined` times as many steps."""
    problem = problem_named(name)
    pressed = [force * friction for force in problem.contact_normal_force]
    step = problem.time_step / refined
    return simulate_system(
        problem.model_copy(update={"contact_normal_force": pressed}).system,
        position=problem.start_position,
        velocity=problem.start_velocity,
        time_step=step,
        steps=round(problem.times[-1] / step),
    )


def written(folder, problem, *, refined=1, scale=1.0, velocities=True, friction=1.0):
    """Write the motion that `moved` gives, in units of `scale`."""
    motion, file = moved(problem.name, refined, friction), folder / "motion.csv"
    bodies = range(len(problem.masses))
    columns = {"time": motion.time, **{f"x{body}": scale * motion.positions[:, body] for body in bodies}}
    columns |= {f"v{body}": scale * motion.velocities[:, body] for body in bodies if velocities}
    pd.DataFrame(columns).to_csv(file, index=False)
    return file


def passes(problem, file, time_step=None):
    return (judged(problem, read_motion(file, problem), time_step).verdict == "agrees").all()


def test_a_scheme_of_first_order_agrees_with_its_own_step_and_not_with_a_finer_one(tmp_path):
    problem = problem_named("cell-let-go")
    file = written(tmp_path, problem)
    assert passes(problem, file)
    assert not passes(problem, file, problem.time_step / 10)
    found = judged(problem, read_motion(file, problem))
    file = written(tmp_path, problem, refined=4, velocities=False)
    alone = judged(problem, read_motion(file, problem), problem.time_step / 4)
    assert alone.verdict.tolist() == ["agrees", "agrees"]
    assert (alone.position_allowed < found.position_allowed).all()
    assert alone.velocity_off.isna().all()


def test_a_held_block_that_creeps_deviates_and_has_slid(tmp_path):
    problem = problem_named("block-held")
    file = tmp_path / "motion.csv"
    file.write_text("\n".join(["time,x0", *(f"{time},{1e-9 * time}" for time in problem.times)]))
    row = judged(problem, read_motion(file, problem)).iloc[0]
    assert (row.verdict, row.exact, row.motion) == ("deviates", "held", "slid")
    assert (row.position_off, row.position_time) == (1e-9, 1.0)


@pytest.mark.parametrize("velocities", [True, False])
@pytest.mark.parametrize(
    ("name", "friction", "states"),
    [
        ("block-held", 1.0, ["held"]),
        ("block-breaks-away", 1.0, ["slid"]),
        ("block-stops", 1.0, ["stuck"]),
        ("block-stops", 0.9, ["stuck"]),
        ("pushed-up-a-slope", 0.9, None),
        ("slope-grid", 1.0, ["held", "held", "slid", "slid"] * 3),
        ("slope-grid", 1.1, ["held", "held", "held", "slid"] * 3),
        ("cell-let-go", 1.0, ["–", "stuck"]),
        ("chain-steady-0.6-0.7", 0.9, None),
    ],
)
def test_what_a_body_does_is_held_slid_or_stuck_and_a_tenth_of_friction_is_found(
    name, friction, states, velocities, tmp_path
):
    problem = problem_named(name)
    found = judged(problem, read_motion(written(tmp_path, problem, velocities=velocities, friction=friction), problem))
    assert states is None or found.motion.tolist() == states
    assert (found.verdict == "agrees").all() == (friction == 1)
    assert (found.verdict[found.motion != found.exact] == "deviates").all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"columns of .*motion.csv = '' lack time; allowed: 'time, x0'"),
        ("time,x0\n0.1,nan", r"line 2 of motion.csv = '0.1,nan'; allowed: a finite number a column"),
        ("time,x0\n0.2,0\n0.1,0", r"2 that do not rise; allowed: two or more"),
        ("time,x0\n0.1,0\n0.2,0", r"no row at 0.3 s, but 2 from 0.1 to 0.2 s; allowed: one at each of the problem's"),
    ],
)
def test_a_file_that_says_something_else_is_refused(text, message, tmp_path):
    file = tmp_path / "motion.csv"
    file.write_text(text)
    problem = problem_named("block-held")
    with pytest.raises(ParameterError, match=message):
        judged(problem, read_motion(file, problem))


def test_other_units_are_named(tmp_path):
    for name, scale, unit in (("block-stops", 1e3, "mm"), ("cell-let-go", 1e-3, "km")):
        problem = problem_named(name)
        motion = read_motion(written(tmp_path, problem, scale=scale), problem)
        with pytest.raises(
            ParameterError, match=re.escape(f"{scale:g} times the exact ones, as if in {unit}; allowed")
        ):
            judged(problem, motion)
    with pytest.raises(ParameterError, match=r"time_step = .*> 0"):
        judged(problem, motion, 0.0)
