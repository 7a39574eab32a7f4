"""Cost of accuracy: error and processor time of each configuration, at several time steps."""

import math
from collections.abc import Iterable, Iterator, Sequence

import pandas as pd

from multibody_xval.scenarios.model import Case, Config, Run
from multibody_xval.scenarios.result_tables import CONFIG
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.studies.accuracy_map import SIX, first_failure
from multibody_xval.scenarios.table_text import number_texts

USUAL_STEPS = (50, 100, 200, 400, 800)
"""Steps per period of every configuration: from what games take, a few steps a stick, to a minute of an engine."""

MOST_STEPS = 6400
"""Steps per period up to which they are doubled where the error still falls."""

TIMED = Case(friction_ratio=0.3, frequency_ratio=0.9)
"""One of the six; its frequency is the median of theirs."""

STILL_FALLS = 0.9
"""Error after twice the steps over the error before: 1/2 for a first-order scheme, 1 where friction itself is off."""

HEADINGS = {
    "configuration": "configuration",
    "steps": "steps per period",
    "error_db": "error [dB]",
    "error_percent": "error [%]",
    "milliseconds": "ms per second",
    "product": "error × time [dB ms]",
    "periodic": "periodic",
}
"""Columns that are printed, with their headings."""

LEGEND = """\
What does accuracy cost? Every configuration is simulated at six points with stick and slip, with several numbers of
steps per period:

- *error*: the largest of the transmittance, to the proven value; in per cent, a difference of phase counts too;
- *ms per second*: processor time of a simulated second of the chain of seven cells (friction ratio 0.3, frequency ratio
  0.9): the search for a steady state with all its work, over the steps that it simulated; the median of the points;
- *error × time*: nearly the same at every step where the scheme is of first order; the less, the better;
- *periodic*: points at which the motion becomes periodic.
"""


def step_runs(configs: Iterable[Config], steps: Sequence[int] = USUAL_STEPS) -> list[Run]:
    """Give the runs of configurations at the six points with every number of steps, and those of the ruler there.

    More steps than the usual ones have no ruler: the error is that to the proven value, and nothing is judged.
    """
    places = [(case, number) for number in steps for case in SIX]
    ruled = ruler(place for place in places if place[1] <= USUAL_STEPS[-1])
    return list(dict.fromkeys([*(Run(own, *place) for own in configs for place in places), *ruled]))


def finer(points: pd.DataFrame) -> list[Run]:
    """Give the runs with twice the steps of configurations whose error still falls with the step."""
    runs: list[Run] = []
    for _, own in step_table(judged(points)).groupby("configuration", sort=False):
        last = own.iloc[-1]
        if 2 * last.steps <= MOST_STEPS and last.complete and _falls(own):
            runs += step_runs([last.config], [2 * last.steps])
    return runs


def step_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Give, of judged points, a row a configuration and number of steps per period, by ascending steps.

    Columns: ``configuration``, ``config``, those of `CONFIG`, ``steps``, the largest error to the exact value as
    ``error_db`` and ``error_percent``, ``seconds`` of a processor to the steady state and ``step_seconds`` of a step
    (medians of the periodic points), ``milliseconds`` of a simulated second, ``product`` of error and time [dB ms],
    ``periodic`` and ``points`` (their numbers), ``complete`` (whether all six are periodic: an error over fewer is not
    comparable), ``reason`` of the first run that failed.
    """
    by_config = rows[rows.case.isin(SIX)].groupby("configuration", sort=False)
    return pd.DataFrame([_row(at) for _, own in by_config for _, at in own.groupby("steps")])


def _row(rows: pd.DataFrame) -> dict[str, object]:
    """Give the numbers of one configuration with one number of steps."""
    steady = rows[rows.status == "periodic"]
    steps = int(rows.steps.iloc[0])
    a_step = (steady.seconds / (steady.periods * steps)).median()
    milliseconds = 1e3 * a_step / TIMED.lane(steps).time_step
    complete = len(steady) == len(SIX)
    error = steady.error_db.abs().max()
    return {
        **rows.iloc[0][["configuration", *CONFIG, "config"]], "steps": steps,
        "error_db": error, "error_percent": steady.error_percent.max(),
        "seconds": steady.seconds.median(), "step_seconds": a_step,
        "milliseconds": milliseconds, "product": error * milliseconds if complete else math.nan,
        "periodic": len(steady), "points": len(rows), "complete": complete,
        "reason": first_failure(rows),
    }  # fmt: skip


def _falls(own: pd.DataFrame) -> bool:
    """Tell whether the error falls from the last but one number of steps to the last, or is not known."""
    if len(own) < 2:
        return True
    before, last = own.iloc[-2], own.iloc[-1]
    return not last.error_db > STILL_FALLS ** math.log2(last.steps / before.steps) * before.error_db


def remarks(table: pd.DataFrame) -> list[str]:
    """Say of each configuration why points are missing, and where its error falls no more: friction itself is off."""
    return [f"{name}: {text}" for name, own in table.groupby("configuration", sort=False) for text in _remarks(own)]


def _remarks(own: pd.DataFrame) -> Iterator[str]:
    if (own.reason != "").any():
        yield f"first failure: {own.reason[own.reason != ''].iloc[0]}"
    elif not own.complete.all():
        lacking = ", ".join(str(steps) for steps in own.steps[~own.complete])
        yield f"not all of the six points are periodic with {lacking} steps per period"
    whole = own[own.complete]
    if not _falls(whole):
        (before, last) = (f"{row.error_db:.3g} dB with {row.steps}" for row in whole.iloc[-2:].itertuples())
        yield f"the error does not fall with the step: {before} steps per period, {last}"


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """Give the table as people read it: texts, a dash where there is no number."""
    texts = number_texts(table, dict.fromkeys(("error_db", "error_percent", "milliseconds", "product"), "{:.3g}"))
    periodic = [f"{own}/{len(SIX)}" for own in table.periodic]
    return texts.assign(steps=table.steps.astype(str), periodic=periodic)[[*HEADINGS]].rename(columns=HEADINGS)
