"""A report made by hand: two friction ratios, one engine that runs and one that is not installed."""

import dataclasses
import math
import os
import pickle
from collections.abc import Iterator, Mapping, Sequence
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest
from filelock import FileLock

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.data.variants import Errors
from multibody_xval.reports.export.files import files_of
from multibody_xval.scenarios import functions
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.recorded import RecordedPeriod
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.studies.friction_map import FrictionMap
from multibody_xval.scenarios.studies.work_precision import StepPoint
from multibody_xval.scenarios.sweeps.attenuation_band import Crossing, Edge
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.edges import BandEdge, compare_edge
from multibody_xval.scenarios.sweeps.point import Point, judged
from multibody_xval.scenarios.sweeps.sweep import Case, refinements
from multibody_xval.scenarios.sweeps.truths import with_truths
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, EXACT, REFERENCE

RUNS = Variant("mujoco")
MISSING = Variant("pybullet")
AS_INSTALLED = Variant("mujoco", preset_name="default")
"""Is compared with the truth at the headline's points only."""
REASON = "not installed: the package <pybullet> is missing & has no wheel"
GRID = (0.3, 0.6, 0.9, 1.3)
FRICTION_RATIOS = (0.0, 0.3)
EDGES = {(0.0, Edge.LOWER): 0.84, (0.0, Edge.UPPER): 1.25, (0.3, Edge.LOWER): 0.64}


TRANSITION = {CONVERGED: 0.1, REFERENCE: 0.101, RUNS: 0.10125}
STEP_ERROR = 0.0125
"""Of the reference's scheme at the common step [dB]; it halves with the step, and `RUNS` shares it."""
CONVERGED_ERROR = STEP_ERROR / 32
"""Of the converged reference [dB]: its step is so much finer."""
OFF = (RUNS, 0.0, 0.9)
"""Where the engine that runs is wrong."""


def answer(variant: Variant, friction_ratio: float, frequency_ratio: float, refinement: float = 1.0) -> Result:
    if variant == MISSING:
        return Result.blocked(REASON)
    if (variant, friction_ratio, frequency_ratio) == (RUNS, 0.3, 1.3):
        return Result(status="period limit", residual=2e-3, periods=400, steps_per_period=400, period=1.0)
    error = 0.0 if variant == CONVERGED else STEP_ERROR / refinement
    if (variant, friction_ratio, frequency_ratio) == OFF:
        error += 0.03
    return Result(
        status="converged",
        transmittance_db={0.3: 5.0, 0.6: 2.0, 0.9: -15.0, 1.3: -40.0}[frequency_ratio] + error + friction_ratio,
        residual=3e-9,
        amplification=5.0,
        periods=30,
        steps_per_period=int(400 * refinement),
        period=1.0,
        stuck_fraction=(0.25, 0.5),
        transitions=((1, TRANSITION[variant], "stick"), (2, 0.5, "forward slip")) if friction_ratio else (),
        seconds=0.5,
    )


def edge_of(variant: Variant, friction_ratio: float, edge: Edge) -> BandEdge:
    shift = {CONVERGED: 0.0, REFERENCE: 0.0001, RUNS: 0.01}.get(variant, 0.0)
    place = EDGES.get((friction_ratio, edge))
    case = Case.of(friction_ratio=friction_ratio)
    if place is None or variant == MISSING:
        converged = None if place is None else Crossing(place)
        return BandEdge(variant, case, edge, None, compare_edge(None, converged))
    sides = max(eta for eta in GRID if eta < place), min(eta for eta in GRID if eta > place)
    around = [known(variant, friction_ratio, eta) for eta in sides]
    crossings = (Crossing(one, slope=-100.0, width=1e-4) for one in (place + shift, place))
    return BandEdge(variant, case, edge, place + shift, compare_edge(*crossings, around))


def known(variant: Variant, friction_ratio: float, frequency_ratio: float) -> Point:
    """Give what Figure 3 knows of a point."""
    place = friction_ratio, frequency_ratio
    return Point(
        variant=variant,
        case=Case.of(friction_ratio=friction_ratio),
        frequency_ratio=frequency_ratio,
        result=answer(variant, *place),
        others=tuple(answer(variant, *place, times) for times in refinements(variant)),
        reference=answer(REFERENCE, *place),
        converged=answer(CONVERGED, *place),
        refined=tuple(answer(REFERENCE, *place, times) for times in refinements(REFERENCE)),
    )


def made_errors(sizes: Mapping[Variant, float], points: int) -> Errors:
    """Errors of variants to the truth [dB], all of them over so many points."""
    return {
        variant: SimpleNamespace(
            variant=variant, size=abs(error), worst_error_db=error, median_error_db=1e-3, points=points,
            points_known=points, blocked=False,
        )
        for variant, error in sizes.items()
    }  # fmt: skip


@pytest.fixture(scope="module")
def in_this_process() -> Iterator[None]:
    """Let `sweep` and `band_edges` start no processes, which would take longer than their work."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(functions, "executor_for", lambda *_: InProcessExecutor())
        yield


@pytest.fixture(scope="session")
def result() -> ComparedSweep:
    asked = figure3((RUNS, MISSING), FRICTION_RATIOS, GRID)
    places = [(v, f, eta) for v in asked.variants for f in FRICTION_RATIOS for eta in GRID]
    eta = np.linspace(0.3, 1.3, 21)
    curve = np.where(eta < 1.0, 5 - 20 * eta, math.nan)
    compared = ComparedSweep(
        asked,
        judged(known(*place) for place in places),
        tuple(edge_of(v, f, edge) for v in asked.variants for f in FRICTION_RATIOS for edge in Edge),
        dict.fromkeys(asked.cases, (eta, curve)),
    )
    with patch(
        "multibody_xval.scenarios.sweeps.truths.proven_level", return_value=None
    ):  # of this chain all numbers are invented
        return with_truths(compared, ExactMotion())


def motion(cells: int = 2, steps: int = 80) -> RecordedPeriod:
    """A slip of constant friction to and fro in the first cell; the others stick."""
    phase = np.arange(1, steps + 1) / steps
    relative = np.zeros((steps, cells))
    relative[:, 0] = np.abs(2 * phase - 1)
    direction = np.where(phase < 0.5, -1, 1)
    modes = np.zeros((steps, cells), dtype=np.int8)
    modes[:, 0] = direction
    friction = 0.4 * np.sin(2 * np.pi * phase)[:, None] * np.ones(cells)
    friction[:, 0] = -direction
    outer = np.sin(2 * np.pi * phase)[:, None] * np.ones(cells)
    return RecordedPeriod(outer=outer, inner=outer + relative, friction=friction, modes=modes)


def step_points(variant: Variant, error: float) -> tuple[StepPoint, ...]:
    """Errors of a scheme of first order, at equal cost of a step."""
    return tuple(
        StepPoint(
            variant=variant, steps_per_period=steps, error_db=error * 400 / steps, step_seconds=5e-6,
            seconds=1e-4 * steps, certified=6, evaluated=6, reason="",
        )
        for steps in (400, 800, 1600)
    )  # fmt: skip


class ExactMotion:
    """Gives the exact motion, from which the converged reference of `answer` is `CONVERGED_ERROR` away."""

    def evaluate(self, tasks: Sequence[SteadyStateTask]) -> list[Result]:
        return [self._exact(task) for task in tasks]

    @staticmethod
    def _exact(task: SteadyStateTask) -> Result:
        assert task.variant == EXACT
        nearly = answer(CONVERGED, float(task.friction_ratio), task.frequency_ratio)
        return dataclasses.replace(
            nearly, transmittance_db=nearly.transmittance_db - CONVERGED_ERROR, residual=1e-12, amplification=math.nan
        )


@pytest.fixture(scope="session")
def report(result: ComparedSweep) -> Report:
    eta = np.array([0.3, 0.6, 0.9, 1.3])
    friction_map = FrictionMap(
        friction_ratios=np.array([0.0, 0.3]),
        frequency_ratios=eta,
        transmittance_db=np.array([[5.0, 2.0, -15.0, math.nan], [4.0, -1.0, -20.0, -40.0]]),
        lower=np.array([0.64, 0.55]),
        upper=np.array([math.nan, math.nan]),
    )
    return Report(
        result,
        "multibody-xval report --quick --engine '<b>'",
        {
            (Case.of(friction_ratio=0.3), 0.9): {
                REFERENCE: motion(),
                RUNS: motion(),
                MISSING: RecordedPeriod("not installed: the package is missing"),
            }
        },
        (*step_points(REFERENCE, 0.01), *step_points(RUNS, 0.02)),
        friction_map,
        unit_cell=dict.fromkeys(FRICTION_RATIOS, (eta, 5 - 20 * eta)),
        headline=(
            *(point for point in result.points if point.frequency_ratio == 0.9),
            *(
                dataclasses.replace(point, variant=AS_INSTALLED, findings=())
                for point in result.points_of(RUNS)
                if point.frequency_ratio == 0.9
            ),
        ),
    )


@pytest.fixture(scope="session")
def files(report: Report, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Every file of the report, written once in all processes of a run of the tests."""
    run = tmp_path_factory.getbasetemp()
    kept = (run.parent if os.environ.get("PYTEST_XDIST_WORKER") else run) / "report.pickle"
    with FileLock(f"{kept}.lock"):
        if not kept.exists():
            kept.write_bytes(pickle.dumps(files_of(report)))
        contents: dict[str, bytes] = pickle.loads(kept.read_bytes())
    return contents
