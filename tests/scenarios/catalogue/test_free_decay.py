"""Free decay: the friction oscillator's closed form, the exact motion, engines that are right and wrong."""

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.transient.free_decay import OSCILLATOR_DECAY, FreeDecay, loss_a_cycle
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.verdicts.finding import Verdict
from tests.scenarios.in_process import deviating, findings, rub_harder

MUJOCO = Variant("mujoco")


def exact_series(decay):
    return run_batch(FreeDecay().baseline(decay))[0].series


def test_oscillator_of_the_scenario_decays_by_the_closed_form() -> None:
    """Let go at 1, with F / k = 0.06: turns at 0.88, 0.76, … 0.04, where it stays, after eight half cycles."""
    exact = exact_series(OSCILLATOR_DECAY)
    assert exact["offsets"][0] == pytest.approx(0.04, abs=1e-4)
    assert exact["rest"][0] / OSCILLATOR_DECAY.period == pytest.approx(4, abs=0.03)
    assert loss_a_cycle(np.array(exact["swing"])) == pytest.approx(4 * 0.06, rel=1e-4)
    # springs of the rest state hold (1/25)² of the energy
    assert exact["energy"][0] == pytest.approx(0.04**2, abs=2e-4)


@pytest.mark.parametrize("decay", FreeDecay.cases, ids=str)
def test_contacts_come_to_rest_inside_their_dead_bands_before_the_end(decay) -> None:
    exact = exact_series(decay)
    assert 0 < exact["rest"][0] < 0.9 * decay.periods * decay.period
    assert np.max(np.abs(exact["offsets"])) <= decay.half_width
    assert np.max(np.abs(exact["offsets"])) > 0.01 * decay.half_width


def test_dashpots_alone_never_bring_an_oscillation_to_rest() -> None:
    """Its turns fall by a constant ratio: nothing of them is lost in constant steps."""
    time = np.linspace(0, 8 * np.pi, 8001)
    swing = np.cos(time) * np.exp(-0.01 * time)
    assert loss_a_cycle(swing) == pytest.approx((1 - np.exp(-0.01 * 8 * np.pi)) / 4, rel=0.05)


def test_reference_and_mujoco_decay_as_the_exact_motion_does() -> None:
    judged = findings(FreeDecay(), Variant("reference"), MUJOCO)
    assert len(judged) == 2 * (8 + 7 + 7)
    assert not deviating(judged)


def test_friction_that_is_too_large_by_a_twentieth_is_found(monkeypatch) -> None:
    """It stops earlier and elsewhere, and loses more in a cycle."""
    rub_harder(monkeypatch, 1.05)
    wrong = {
        (finding.case, finding.metric.name): finding
        for finding in findings(FreeDecay(), MUJOCO)
        if finding.comparison.verdict is Verdict.DISAGREE
    }
    loss = wrong["friction oscillator", "loss a cycle"]
    assert loss.value == pytest.approx(1.05, rel=1e-3)
    assert ("inner masses let go", "offsets") in wrong


def test_variant_that_is_not_installed_is_blocked_in_every_metric(monkeypatch) -> None:
    from multibody_xval.engines.mujoco import MuJoCo

    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _self: "no wheel")
    judged = findings(FreeDecay(), MUJOCO)
    assert {finding.comparison.verdict for finding in judged} == {Verdict.BLOCKED}
    assert "no wheel" in judged[0].comparison.reason
