"""A step is timed on the processor, or on a graphics card by the engine's own loop alone."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

from engines.interface.device import CARD, PROCESSOR, chosen_device, on_device
from engines.interface.variant import Variant
from engines.shared.step_cost import STEPS, device_title, step_cost
from reference_lcp.errors import ParameterError

WARP = Variant("mujoco-warp")


class Stepped:
    """What is built: it keeps how many steps were asked of it, and where."""

    def __init__(self) -> None:
        self.device = chosen_device()
        self.advanced: list[int] = []
        self.native: list[int] = []
        self.recorded: list[int] = []

    def advance(self, state: Any, start: int, steps: int) -> Any:
        self.advanced.append(steps)
        return state

    def run(self, state: Any, start: int, steps: int) -> None:
        self.recorded.append(steps)

    def native_steps(self, steps: int) -> None:
        self.native.append(steps)

    def close(self) -> None:
        pass


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[Stepped]:
    every: list[Stepped] = []

    def build(*_: Any) -> Stepped:
        every.append(Stepped())
        return every[-1]

    monkeypatch.setattr(Variant, "build", build)
    return every


def with_card(monkeypatch: pytest.MonkeyPatch, there: bool) -> None:
    card = SimpleNamespace(name="a card")
    warp = SimpleNamespace(is_cuda_available=lambda: there, get_device=lambda _: card)
    monkeypatch.setattr("engines.shared.step_cost.find_spec", lambda _: "found")
    monkeypatch.setattr("engines.shared.step_cost.import_warp", lambda: warp)


def test_on_a_card_the_engine_is_timed_alone(monkeypatch: pytest.MonkeyPatch, built: list[Stepped]):
    with_card(monkeypatch, there=True)
    cost = step_cost(WARP, samples=2, lanes=3, device=CARD)
    assert (cost.device, cost.lanes, built[0].device) == ("a card", 3, CARD)
    assert math.isnan(cost.advance)
    assert math.isnan(cost.run)
    assert cost.bare > 0
    assert (built[0].advanced, built[0].recorded, built[0].native) == ([1], [], [STEPS] * 2)
    assert chosen_device() == PROCESSOR


def test_on_the_processor_the_adapter_is_timed_too(built: list[Stepped]):
    cost = step_cost(WARP, samples=2, lanes=3)
    assert (cost.device, built[0].device) == (PROCESSOR, PROCESSOR)
    assert built[0].advanced == built[0].recorded == built[0].native == [STEPS] * 2
    assert min(cost.advance, cost.run, cost.bare) > 0


def test_a_machine_without_a_card_is_told(monkeypatch: pytest.MonkeyPatch, built: list[Stepped]):
    with_card(monkeypatch, there=False)
    with pytest.raises(ParameterError, match=r"device = cuda: no graphics card .* allowed here: cpu"):
        step_cost(WARP, device=CARD)
    assert built == []


def test_an_engine_of_the_processor_takes_no_card(monkeypatch: pytest.MonkeyPatch):
    with_card(monkeypatch, there=True)
    with pytest.raises(ParameterError, match=r"device of pybullet = 'cuda' is unknown; allowed: cpu"):
        device_title(Variant("pybullet"), CARD)


def test_the_processor_is_chosen_again_after_a_build_that_fails():
    with pytest.raises(ZeroDivisionError), on_device(CARD):
        raise ZeroDivisionError
    assert chosen_device() == PROCESSOR
