"""Programs of others find the chain's exact motions: harmonic balance slowly, an integrator of second order."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

from multibody_xval.scenarios.model import Case
from multibody_xval.scenarios.ruler.proven import proven
from reference_lcp import exact_steady_state
from reference_lcp.observables.transmittance import complex_transmittance

pytestmark = [pytest.mark.extra, pytest.mark.filterwarnings("ignore")]

FOLDER = Path(__file__).parents[1] / "docs" / "opinions"

POINTS = [(0.3, 0.9), (0.1, 1.4)]

ONE_CELL = Case(friction_ratio=0.3, frequency_ratio=0.9, cells=1)

OF_STEPS = 1e-3
"""Error of 100 steps per period, of second order: 0.2 % with 50."""

EXTRAPOLATED = 5e-3
"""Of one cell, from 16 and 32 odd harmonics: what remains when the error that halves is gone."""


def script(name: str, package: str) -> ModuleType:
    """Import a script of the page, or skip where its package is absent."""
    pytest.importorskip(package, reason=f"pip install '.[opinions]' installs {package}")
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def with_more_friction(case: Case) -> complex:
    """Give the exact transmittance with 1 % more friction: what a check has to tell from that of the case."""
    other = Case(**(case.as_data() | {"friction_ratio": 1.01 * case.friction_ratio}))  # type: ignore[operator]
    return complex_transmittance(exact_steady_state(*other.setting).orbit)


@pytest.mark.parametrize("point", POINTS)
def test_a_nonsmooth_integrator_follows_the_exact_motion_with_an_error_of_second_order(point) -> None:
    period = script("nonsmooth_integrator", "solve_nivp").period
    case = Case(friction_ratio=point[0], frequency_ratio=point[1])
    exact = proven()[case]
    coarse, fine = (period(case, steps) for steps in (50, 100))
    errors = [abs(own.transmittance / exact - 1) for own in (coarse, fine)]
    assert errors[1] < OF_STEPS
    assert 3 < errors[0] / errors[1] < 5
    assert fine.returns < 0.02
    assert abs(fine.transmittance / with_more_friction(case) - 1) > 2 * OF_STEPS


def test_harmonic_balance_of_one_cell_tends_to_the_exact_motion_as_the_number_of_harmonics() -> None:
    found = script("harmonic_balance", "pyHarm").transmittance(ONE_CELL, (1, 2, 4, 8, 16, 32))
    exact = proven()[ONE_CELL]
    errors = [abs(own / exact - 1) for own in found]
    assert 1.7 < errors[-2] / errors[-1] < 2.3
    extrapolated = 2 * found[-1] - found[-2]
    assert abs(extrapolated / exact - 1) < EXTRAPOLATED
    assert abs(extrapolated / with_more_friction(ONE_CELL) - 1) > EXTRAPOLATED


@pytest.mark.parametrize("point", POINTS)
def test_harmonic_balance_of_the_chain_comes_closer_with_more_harmonics(point) -> None:
    case = Case(friction_ratio=point[0], frequency_ratio=point[1])
    found = script("harmonic_balance", "pyHarm").transmittance(case, (1, 2, 4))
    errors = [abs(own / proven()[case] - 1) for own in found]
    assert errors[0] > errors[1] > errors[2]
