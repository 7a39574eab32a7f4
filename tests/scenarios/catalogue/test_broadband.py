"""Broadband and transient base motions: friction's effect on them, engines that are right and wrong."""

import dataclasses
import math

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.transient.base import (
    BAND_METRICS,
    BANDS,
    BROADBAND_STEPS,
    DIFFERENCE,
    PEAK,
    RATIOS,
    ROWS_PER_PERIOD,
    linear_limits,
)
from multibody_xval.scenarios.catalogue.transient.filtered_noise import FilteredNoiseScenario
from multibody_xval.scenarios.catalogue.transient.record import FILE, Record
from multibody_xval.scenarios.catalogue.transient.ricker_pulse import RickerPulseScenario
from multibody_xval.scenarios.catalogue.transient.swept_sine import SweptSineScenario
from multibody_xval.scenarios.edges.finding import brackets
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.runs.transient import run_transients
from multibody_xval.scenarios.verdicts.finding import Verdict
from reference_lcp import HarmonicBase, ParameterError, RecordedBase, decibel, frictionless_transmittance
from tests.scenarios.catalogue.example_record import PEAK as EXAMPLE_PEAK
from tests.scenarios.catalogue.example_record import example_samples, write_example
from tests.scenarios.in_process import deviating, evaluator, findings, rub_harder

REFERENCE, MUJOCO = Variant("reference"), Variant("mujoco")
BELOW, WITHIN, ABOVE = (BAND_METRICS[name] for name in ("0.65–0.82", "0.9–1.35", "1.5–2"))


class ShortPulse(RickerPulseScenario):
    """The pulse, not followed to its end."""

    friction_ratios = (0.03,)

    def case(self, friction_ratio):
        return dataclasses.replace(super().case(friction_ratio), periods=60)


def numbers(scenario, friction_ratio):
    """What the scenario reads from the reference."""
    case = dataclasses.replace(scenario.case(friction_ratio), steps_per_period=100)
    return scenario.numbers(case, run_transients([case.task(REFERENCE)])[0].series)


@pytest.mark.parametrize("name", ["ricker-pulse", "record"])
def test_friction_attenuates_more_below_the_band_only_within_a_range_of_amplitude(name) -> None:
    """The same chain, hit ever more softly: little friction widens the attenuation, much of it locks the cells."""
    scenario = CATALOGUE[name]
    none, some, much = (numbers(scenario, ratio) for ratio in (0.0, 0.03, 0.3))
    assert some[BELOW] < none[BELOW] - 1
    assert much[BELOW] > none[BELOW] + 1
    # locked cells have no resonators: no gap, and one pass band that ends earlier
    assert none[WITHIN] < -30
    assert much[WITHIN] > -15
    assert much[ABOVE] < none[ABOVE] - 20


@pytest.mark.parametrize("scenario", [RickerPulseScenario(), FilteredNoiseScenario()], ids=lambda each: each.name)
def test_linear_limits_are_the_motions_without_friction_and_with_far_too_much(scenario) -> None:
    """To a twentieth of the peak: the noise is cut off at its end, and an effect needs no more."""
    case = scenario.case(0.0)
    for ratio, limit in zip((0.0, 1000.0), linear_limits(case), strict=True):
        simulated, known = numbers(scenario, ratio), scenario.numbers(case, {"response": limit})
        assert np.max(np.abs(np.subtract(simulated[DIFFERENCE], known[DIFFERENCE]))) < 0.05 * known[PEAK]
        assert known[BELOW] == pytest.approx(simulated[BELOW], abs=0.05)


def test_slow_sweep_meets_the_attenuation_of_figure_3() -> None:
    """While it passes a band the base is harmonic: wider up to some friction ratio, and gone when cells lock."""
    scenario = SweptSineScenario()
    none, some, more, locked = (numbers(scenario, ratio)[BELOW] for ratio in (0.0, 0.1, 0.3, 3.0))
    assert some < none - 4
    assert more < none - 2
    assert locked > none + 4


def test_noise_of_little_amplitude_finds_the_cells_locked() -> None:
    """Scaling motion and friction alike scales the response: amplitude is one over the friction ratio."""
    scenario = FilteredNoiseScenario()
    none, locked = (numbers(scenario, ratio) for ratio in (0.0, 20.0))
    assert none[WITHIN] < -30
    assert locked[WITHIN] > -15


def test_response_is_in_proportion_to_the_base_where_friction_is_too() -> None:
    """Coulomb friction has no scale of its own: twice the base, twice the bound, twice the motion."""
    case = RickerPulseScenario().case(0.05)
    task = dataclasses.replace(case, periods=30).task(REFERENCE)
    doubled = dataclasses.replace(task, base=dataclasses.replace(task.base, amplitude=0.02), friction_ratio=0.1)
    weak, strong = (np.array(run_transients([task])[0].series["response"]) for task in (task, doubled))
    assert strong == pytest.approx(weak, abs=1e-12)


def test_transients_have_died_out_at_their_end() -> None:
    for name in ("ricker-pulse", "swept-sine", "record"):
        case = CATALOGUE[name].case(0.0)
        response = np.abs(run_transients([case.task(REFERENCE)])[0].series["response"])
        assert np.max(response[-ROWS_PER_PERIOD * 10 :]) < 0.02 * np.max(response), name
        assert np.max(np.abs(case.base_rows()[-ROWS_PER_PERIOD * 90 :])) < 1e-9, name


def test_reference_and_mujoco_agree_with_the_finer_reference() -> None:
    judged = findings(ShortPulse(), REFERENCE, MUJOCO)
    assert [finding.metric for finding in judged] == 2 * list(RickerPulseScenario.metrics)
    assert not deviating(judged)
    series = {finding.variant.engine: finding for finding in judged if finding.metric is DIFFERENCE}
    assert 0 < series["mujoco"].value < 0.002
    assert series["mujoco"].value == pytest.approx(series["reference"].value, rel=1e-6)


def test_friction_that_is_too_large_by_a_twentieth_shows_in_the_series(monkeypatch) -> None:
    rub_harder(monkeypatch, 1.05)
    judged = findings(ShortPulse(), MUJOCO)
    verdicts = {finding.metric: finding.comparison.verdict for finding in judged}
    assert verdicts[DIFFERENCE] is Verdict.DISAGREE
    assert verdicts[PEAK] is Verdict.DISAGREE


class OffBy(InProcessExecutor):
    """An executor in which MuJoCo is the reference with an error that depends on the number of steps."""

    def __init__(self, error):
        self.error = error

    def run(self, batches):
        for batch in batches:
            references = [dataclasses.replace(motion, variant=REFERENCE) for motion in batch]
            yield batch, [self.moved(*pair) for pair in zip(batch, run_transients(references), strict=True)]

    def moved(self, motion, answer):
        if motion.variant == REFERENCE:
            return answer
        refinement = motion.every * ROWS_PER_PERIOD // BROADBAND_STEPS
        response = np.array(answer.series["response"]) + self.error[refinement]
        return dataclasses.replace(answer, series={"response": tuple(response.tolist())})


@pytest.mark.parametrize(
    ("error", "verdict"),
    [
        ({1: 0.02, 2: 0.02, 4: 0.02, 8: 0.01}, Verdict.AGREE),
        ({1: 0.02, 2: 0.02, 4: 0.02, 8: 0.02}, Verdict.DISAGREE),
    ],
    ids=["falls with the step at last", "stays"],
)
def test_error_that_three_steps_do_not_show_is_looked_at_with_finer_ones(error, verdict) -> None:
    with opened_store(None) as store:
        judged = ShortPulse().run([MUJOCO], Evaluator(store, OffBy(error)))
    (series,) = [finding.comparison for finding in judged if finding.metric is DIFFERENCE]
    assert series.verdict is verdict
    assert series.reason.endswith("with 2 times the default steps")


def test_engine_that_fails_is_blocked_with_its_reason(monkeypatch) -> None:
    build = Variant.build

    def failing(self, lanes):
        if self.engine == "mujoco":
            raise RuntimeError("no convergence")
        return build(self, lanes)

    monkeypatch.setattr(Variant, "build", failing)
    judged = findings(ShortPulse(), MUJOCO)
    assert {finding.comparison.verdict for finding in judged} == {Verdict.BLOCKED}
    assert judged[0].comparison.reason == "RuntimeError: no convergence"


def test_everything_that_is_asked_is_known_beforehand() -> None:
    """Progress bars count it; nothing is asked twice."""
    scenario, told = ShortPulse(), []
    with opened_store(None) as store, evaluator(store) as counting:
        counting.progress.advance = lambda tasks: told.append(len(tasks))
        scenario.run([REFERENCE], counting)
    assert sum(told) == len(set(scenario.tasks([REFERENCE]))) == 6


def test_example_record_is_its_formula_and_small(tmp_path) -> None:
    write_example(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == FILE.read_text()
    assert FILE.stat().st_size < 20_000
    record = RecordedBase.from_csv(FILE)
    times, displacements = example_samples()
    assert record == RecordedBase(tuple(times.tolist()), tuple(displacements.tolist()))
    assert record.amplitude == EXAMPLE_PEAK
    assert abs(displacements[-1]) < 1e-9


def test_own_record_is_scaled_to_the_amplitude_of_the_friction_ratio(tmp_path) -> None:
    file = tmp_path / "own.csv"
    times = 0.02 * np.arange(101)
    own = 3.0 * np.sin(2 * math.pi * 5 * times) * np.sin(math.pi * times / 2) ** 2
    file.write_text("\n".join(f"{a},{b}" for a, b in zip(times, own, strict=True)))
    case = Record(file).case(0.1)
    assert case.base.displacement_scale(RATIOS.chain(0.1)) == pytest.approx(0.01)
    assert case.periods == math.ceil(2.0 / (2 * math.pi / math.sqrt(1000))) + 200


def written(tmp_path, spacing):
    file = tmp_path / "own.csv"
    file.write_text("\n".join(f"{spacing * k:.4f},{0.01 * math.sin(k)}" for k in range(50)))
    return file


def test_own_record_too_coarse_for_the_bands_is_refused(tmp_path) -> None:
    with pytest.raises(ParameterError, match=r"too coarse: samples are up to 0\.06 s apart; allowed: <= 0\.0496"):
        Record(written(tmp_path, 0.06)).tasks([REFERENCE])


@pytest.mark.parametrize(("spacing", "steps"), [(0.02, 50), (0.003, 70), (0.001, 200)])
def test_steps_are_as_short_as_the_samples_of_a_record_are_near(tmp_path, spacing, steps) -> None:
    """A period 2π / ω_r takes 0.1987 s; ten rows of it are kept."""
    case = Record(written(tmp_path, spacing)).case(0.1)
    assert case.steps_per_period == steps
    assert case.task(REFERENCE).time_step <= spacing


def test_missing_record_is_named_before_any_work() -> None:
    from pathlib import Path

    with pytest.raises(ParameterError, match=r"record nowhere\.csv cannot be read"):
        Record(Path("nowhere.csv")).tasks([REFERENCE])


def frictionless_db(ratios: ChainRatios, eta: np.ndarray) -> np.ndarray:
    """Transmittance [dB] of the closed form at each η_r."""
    chain = ratios.chain(0.0)
    return np.array([decibel(frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, e))) for e in eta])


def frictionless_band(ratios: ChainRatios) -> tuple[float, float]:
    """Edges in η_r of the attenuation band: −10 dB deep, to 0 dB at its edges."""
    eta = np.linspace(0.3, 2.0, 1701)
    found = brackets(frictionless_db(ratios, eta))
    return float(eta[found["lower"]]), float(eta[found["upper"] + 1])


def bands_lie_where_their_reasons_say(lower: float, upper: float) -> bool:
    """The first two bands below the attenuation, the third within it, the last above it."""
    (_, first), (second, below), (begin, end), (above, _) = BANDS.values()
    return first < second < below < lower < begin < end < upper < above


def test_bands_lie_where_their_reasons_say() -> None:
    lower, upper = frictionless_band(ChainRatios())
    assert (lower, upper) == pytest.approx((0.853, 1.414), abs=0.002)
    assert bands_lie_where_their_reasons_say(lower, upper)
    assert np.max(frictionless_db(RATIOS, np.linspace(*BANDS["0.9–1.35"], 101))) < -35


@pytest.mark.parametrize("ratio", [0.5, 2.0])
def test_bands_do_not_fit_another_chain(ratio) -> None:
    assert not bands_lie_where_their_reasons_say(*frictionless_band(ChainRatios(stiffness_ratio=ratio)))
