"""Motions as questions: what they are, how they are answered, kept and refused."""

import dataclasses

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.local_processes import LocalExecutor
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import RESULT_FORMAT, SteadyStateTask
from multibody_xval.scenarios.runs.transient import run_transients
from multibody_xval.scenarios.runs.transient_task import SHAPES, TransientTask, initial_positions
from reference_lcp import (
    FilteredNoise,
    HarmonicBase,
    ParameterError,
    RecordedBase,
    RickerPulse,
    StillBase,
    decibel,
    frictionless_transmittance,
    simulate,
)
from reference_lcp.chain.mass_in_mass import mechanical_energy
from reference_lcp.observables.transmittance import transient_transmissibility
from tests.scenarios.runs.builders import steady

SMALL = ChainRatios(cells=2)
PULSE = RickerPulse(0.01, 31.6, 0.35)


def motion(**more) -> TransientTask:
    usual = {
        "variant": Variant("reference"), "ratios": SMALL, "friction_ratio": 0.1, "base": PULSE,
        "time_step": 1e-3, "steps": 1200, "every": 4,
    }  # fmt: skip
    return TransientTask(**(usual | more))


def test_response_is_the_motion_that_the_reference_simulates() -> None:
    """Rows are those of `simulate`, over the amplitude of the pulse."""
    asked = motion()
    run = simulate(asked.chain, PULSE, time_step=1e-3, steps=1200)
    answer = run_batch([asked])[0]
    assert answer.status == "finished"
    assert answer.series["response"] == pytest.approx(run.outer_positions[3::4, -1] / 0.01, abs=1e-14)
    assert asked.row_times() == pytest.approx(run.time[3::4])


def test_motion_is_the_same_in_stretches_of_any_length() -> None:
    asked = motion(base=StillBase(0.01), shape="stretched", recorded="decay")
    whole = run_transients([asked])[0]
    parts = run_transients([dataclasses.replace(asked, stretch=100)])[0]
    for name, numbers in whole.series.items():
        assert parts.series[name] == pytest.approx(numbers, rel=1e-12, abs=1e-15), name


def test_refined_motion_has_its_rows_at_the_same_times() -> None:
    asked = motion()
    assert asked.refined(4).row_times() == pytest.approx(asked.row_times())
    assert asked.refined(4).steps == 4800


def test_equal_motions_have_one_key_and_every_part_of_the_question_is_in_it() -> None:
    record = RecordedBase((0.0, 0.1, 0.2, 0.3), (0.0, 1e-3, -1e-3, 0.0))
    other = RecordedBase((0.0, 0.1, 0.2, 0.3), (0.0, 1e-3, -1e-3, 1e-9))
    noise = FilteredNoise(0.01, 6.0, 60.0, 10.0, 1.0)
    asked = [
        motion(), motion(base=RickerPulse(0.01, 31.6, 0.36)), motion(base=record), motion(base=other),
        motion(base=noise), motion(base=dataclasses.replace(noise, seed=1)), motion(shape="stretched"), motion(every=2),
        motion(steps=1204), motion(time_step=1.1e-3), motion(friction_ratio=0.2), motion(recorded="decay"),
        motion(variant=Variant("mujoco")), motion(ratios=ChainRatios(cells=3)), motion(stretch=100),
        motion(ratios=ChainRatios(friction_coefficient=0.6)),
    ]  # fmt: skip
    assert len({one.key() for one in asked}) == len(asked)
    assert motion().key() == motion().key()


def test_content_of_a_question_for_a_steady_state_is_what_stores_have() -> None:
    """Their keys are hashes of it: answers that are kept must be found again."""
    asked = SteadyStateTask(variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9)
    content = asked.content()
    assert list(content) == ["format", "task", "version", "options", "sources"]
    plain = dataclasses.asdict(asked)
    del plain["excitation"], plain["modulation"], plain["start"], plain["recorded"]
    for name in ("outer_mass_ratio", "chain_stiffness_ratio", "friction_profile", "friction_coefficient"):
        del plain["ratios"][name]
    assert content["task"] == plain, "what older answers did not know is left out where it is usual"
    assert content["format"] == RESULT_FORMAT


def test_motions_and_steady_states_are_answered_side_by_side_and_kept(tmp_path) -> None:
    asked = [motion(), steady(), motion(steps=400)]
    with ResultStore(tmp_path / "store.sqlite") as store, Evaluator(store, LocalExecutor(1)) as evaluator:
        first = evaluator.evaluate(asked)
        assert [answer.status for answer in first] == ["finished", "converged", "finished"]
        assert [result.to_json() for result in store.results(asked)] == [answer.to_json() for answer in first]
    assert [len(answer.series.get("response", ())) for answer in first] == [300, 0, 100]


def test_motion_whose_numbers_are_not_finite_is_blocked_with_its_time(monkeypatch) -> None:
    build = Variant.build

    def breaking(self, lanes):
        simulation = build(self, lanes)
        run = simulation.run

        def wrong(state, start, steps):
            found = run(state, start, steps)
            for one in found:
                one.velocities[one.time > 0.5] = np.nan
            return found

        simulation.run = wrong
        return simulation

    monkeypatch.setattr(Variant, "build", breaking)
    answer = run_transients([motion()])[0]
    assert (answer.status, answer.series) == ("blocked", {})
    assert answer.reason == "the engine's velocity is not finite at 0.501 s in cell 1: nan"


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"time_step": 0.1}, r"time_step = 0\.1 s is outside its range; allowed: <= 0\.006"),
        ({"time_step": 0.0}, "time_step = 0 is outside its range; allowed: > 0"),
        ({"steps": 0}, "steps = 0 is outside its range; allowed: whole numbers >= 1"),
        ({"every": 7}, "every = 7 does not divide steps = 1200; allowed: divisors"),
        ({"shape": "bent"}, "shape = 'bent' is unknown; allowed: undeformed, stretched, inner masses displaced"),
        ({"recorded": "all"}, "recorded = 'all' is unknown; allowed: response, decay"),
        ({"friction_ratio": -1.0}, "friction_ratio = -1 is outside its range"),
        (
            {"base": RecordedBase((0.0, 5e-4, 1e-3, 0.1), (0.0, 1.0, 0.0, 0.0))},
            r"time_step = 0\.001 s would leave out samples of the record; allowed: <= 0\.0005 s",
        ),
    ],
)
def test_mistakes_in_a_motion_are_refused_before_any_work(wrong, message) -> None:
    with pytest.raises(ParameterError, match=message):
        motion(**wrong)


def test_shapes_stretch_the_springs_that_they_name() -> None:
    chain = ChainRatios(cells=4).chain(0.0)
    force = {shape: chain.stiffness_matrix @ initial_positions(chain, shape, 0.01) for shape in SHAPES}
    assert force["undeformed"] == pytest.approx(np.zeros(8))
    # equal tension in all chain springs pulls at the free end alone
    assert force["stretched"] == pytest.approx([0, 0, 0, 1000 * 0.01 / 4, 0, 0, 0, 0])
    assert force["inner masses displaced"] == pytest.approx([-10.0] * 4 + [10.0] * 4)


def test_initial_energy_goes_to_springs_dashpots_and_contacts_and_nowhere_else() -> None:
    """Initial energy = left + heat, to the first order of the scheme: half the step, half of what is missing."""
    missing = []
    for factor in (1, 2):
        asked = motion(
            base=StillBase(0.01), shape="stretched", recorded="decay", time_step=5e-4, steps=4000, friction_ratio=0.05
        )
        left, dashpots, contacts, growth = run_transients([asked.refined(factor)])[0].series["energy"]
        assert contacts > 0.01
        assert dashpots > 0.1
        assert growth < 2e-3
        missing.append(1 - left - dashpots - contacts)
    assert abs(missing[0]) < 0.01
    assert missing[0] / missing[1] == pytest.approx(2, rel=0.1)


def test_energy_of_a_state_is_kinetic_and_elastic() -> None:
    chain = ChainRatios(cells=1).chain(0.0)
    one = mechanical_energy(chain, np.array([[0.01, 0.03]]), np.array([[2.0, 1.0]]))
    assert one == pytest.approx([0.5 * 4 + 0.5 * 1 + 500 * 0.01**2 + 500 * 0.02**2])


def test_engine_moves_under_a_pulse_as_linear_theory_says() -> None:
    """MuJoCo, frictionless and damped: the ratio of spectra is the transmittance, to the first order of its step."""
    ratios = ChainRatios(cells=2, damping_ratio=0.2, inner_damping_ratio=0.1)
    asked = motion(variant=Variant("mujoco"), ratios=ratios, friction_ratio=0.0, steps=20_000, time_step=5e-4, every=20)
    spectra = []
    for one in (asked, asked.refined(2)):
        response = np.array(run_transients([one])[0].series["response"])
        spectra.append(transient_transmissibility(PULSE.displacement(one.row_times()) / 0.01, response, 0.01))
    for line in range(15, 100, 5):
        exact = frictionless_transmittance(asked.chain, HarmonicBase(0.01, spectra[0].angular_frequency[line]))
        coarse, fine = (decibel(abs(spectrum.ratio[line])) for spectrum in spectra)
        assert abs(fine - decibel(exact)) <= 1.25 * abs(fine - coarse) + 2e-3, f"at line {line}"
