"""The one ruler: every number beside the exact value, and how far from that it may be.

Level and phase are one complex number, the transmittance T. An engine agrees where |T − T_expected| ≤ allowed:

- a preset that shares Euler's scheme is expected where the reference is at equal steps, and nothing is allowed but what
  neither can resolve: what residuals leave open, round-off, and contacts that give way;
- all others are expected at the exact value, and their step may be off as much as Euler's is there, or as much as their
  preset states to be accurate; so are all presets where contacts open, which are measured and not judged there.

The error that readers see is always that to the exact value. Judging asks for no runs: `judged` is a function of a
table.
"""

import math
from collections.abc import Callable

import numpy as np
import pandas as pd

from multibody_xval.engines.interface.presets import LARGEST_ACCURACY
from multibody_xval.scenarios.model import Case, linear_limits
from multibody_xval.scenarios.result_tables import is_exact
from multibody_xval.scenarios.ruler.exact_values import MARGIN, exact_values, scheme_errors
from reference_lcp.steady.richardson import ROUND_OFF_STEPS

FLOOR_DB = -60.0
"""Transmittance below which differences are those of amplitudes, as large in dB as they are at the floor."""

FLOOR, DB = 10 ** (FLOOR_DB / 20), 20 / math.log(10)

COARSE_SHARE = 0.1
"""Part of what friction changes at all that a step may be off, and at most that a stated accuracy allows: with a tenth,
friction that is missing altogether, or never lets go, is ten times what is allowed."""

OTHER_SCHEMES = 2.0
"""Times what is allowed that schemes other than Euler's may be off where its step alone errs by more than any accuracy
that may be stated: beyond what is allowed, and up to this, the step is too large to say more."""

LAST_DIGITS = 1e-12
"""Part of what is allowed by which a distance may be beyond: both are rounded, such as multiples of a step over a
period."""

MOST_MISSING = 0.25
"""Part of the numbers of a judged preset that may be missing, or of a named one that may fail."""

AT_EQUAL_STEPS, EXACT_VALUE = "reference at equal steps", "exact value"
"""What is expected of presets that share the scheme, and of all others."""

AGREES, DEVIATES, TOO_LARGE, UNKNOWN = "agrees", "deviates", "time step too large", "unknown"
"""Verdicts on numbers that are there; those that are not have the status of their run."""

VERDICTS = (AGREES, DEVIATES, TOO_LARGE, "not periodic", "failed", "unsupported", UNKNOWN)


@np.errstate(invalid="ignore", divide="ignore")
def judged(
    table: pd.DataFrame, ruler: pd.DataFrame | None = None, closed_forms: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Add exact value, error, what is expected and allowed, and the verdict to every row but those of the exact motion.

    The reference and the exact motion that they are judged by are those of another table, `ruler`, where one is given;
    exact values are those of a table like that of `exact_values`, `closed_forms`, where one is given.

    Added columns: ``exact_db``, ``exact_deg``, ``exact_kind``; the error to the exact value as ``error_db``,
    ``error_deg`` and ``error_percent`` (of the complex distance); ``expected``: exact value, or reference at equal
    steps; ``distance`` from that and ``allowed``, both over U0; ``verdict``, one of `VERDICTS`. Rows keep their order.
    """
    rows = table[~is_exact(table)].reset_index(drop=True)
    by = table if ruler is None else ruler
    exact = exact_values(by) if closed_forms is None else closed_forms
    rows = rows.merge(exact, on="case", how="left")
    rows = rows.merge(scheme_errors(by), on=["case", "steps"], how="left")
    rows = rows.assign(distance=_distance(rows), expected=_expected(rows))
    return rows.assign(**_errors(rows), **decided(parts_of(rows)))


def parts_of(rows: pd.DataFrame) -> pd.DataFrame:
    """Give what decides on transmittances, over U0; see `decided`."""
    return pd.DataFrame(
        {
            **{name: rows[name] for name in ("status", "shares_scheme", "distance", "exact_bar", "scheme_error")},
            "stated": rows.accuracy * amplitude(rows),
            "resolution": resolution(rows),
            "repeats": rows.reference_residual.fillna(0) * MARGIN * rows.growth,
            "size": amplitude(rows),
            "effect": _effects(rows),
        }
    )


@np.errstate(invalid="ignore")
def decided(parts: pd.DataFrame) -> dict[str, pd.Series]:
    """Decide on numbers of any kind: gives ``allowed``, in the unit of each number, and ``verdict``.

    Columns of `parts`, all but the first two in that unit: ``status`` of the run; ``shares_scheme``, whether the
    reference at equal steps is expected; ``distance`` from what is expected; ``exact_bar``; ``scheme_error``, of
    Euler's step; ``stated`` accuracy; ``resolution``; ``repeats``, what the reference itself leaves open at equal
    steps; ``size``, which parts refer to; ``effect``, how much friction changes the number at all.
    """
    stated = np.minimum(parts.stated, COARSE_SHARE * parts.effect)
    other = parts.exact_bar + np.maximum(parts.scheme_error, stated) + parts.resolution
    allowed = other.where(~parts.shares_scheme, parts.resolution + parts.repeats)
    known = parts.distance.notna() & allowed.notna()
    beyond = parts.distance > allowed * (1 + LAST_DIGITS)
    coarse = ~parts.shares_scheme & (parts.scheme_error > LARGEST_ACCURACY * parts["size"])
    near = beyond & coarse & (parts.distance <= OTHER_SCHEMES * allowed)
    by_step = (parts.exact_bar + parts.scheme_error + parts.resolution).where(~parts.shares_scheme, allowed)
    verdicts = np.select(
        [~known, beyond & ~near, near | (by_step > COARSE_SHARE * parts.effect)], [UNKNOWN, DEVIATES, TOO_LARGE], AGREES
    )
    done = parts.status.isin(["periodic", "finished"])
    return {"allowed": allowed, "verdict": pd.Series(np.where(done, verdicts, parts.status), parts.index, dtype=object)}


def _expected(rows: pd.DataFrame) -> np.ndarray:
    return np.where(rows.shares_scheme, AT_EQUAL_STEPS, EXACT_VALUE)


def _distance(rows: pd.DataFrame) -> pd.Series:
    """Give how far T is from what is expected, over U0."""
    return (rows.ratio - rows.reference.where(rows.shares_scheme, rows.exact)).abs()


def amplitude(rows: pd.DataFrame) -> pd.Series:
    """Give the exact amplitude that parts refer to, over U0: that of the floor where it is below."""
    return rows.exact.abs().clip(lower=FLOOR)


def _effects(rows: pd.DataFrame) -> pd.Series:
    """Give what friction changes at all."""
    effects = [friction_effect(*own) for own in zip(rows.case, rows.exact, strict=True)]
    return pd.Series(effects, rows.index, dtype=float)


def resolution(rows: pd.DataFrame) -> pd.Series:
    """Give what residual, round-off and contacts that give way leave open of an amplitude, over U0."""
    motion = rows.ratio.abs().clip(lower=1.0)
    steps = rows.periods.clip(lower=1) * rows.steps
    repeats = rows.residual.clip(lower=rows.least_residual) * MARGIN * rows.growth
    return repeats + rows.round_off * np.sqrt(steps / ROUND_OFF_STEPS) * motion + rows.gives_way


def _errors(rows: pd.DataFrame) -> dict[str, pd.Series]:
    """Give the error to the exact value in dB, degrees, and per cent of the exact amplitude or the floor's."""
    level, exact_level = _decibel(rows.ratio), _decibel(rows.exact)
    turn = pd.Series(np.degrees(np.angle(rows.ratio / rows.exact)), rows.index)
    return {
        "exact_db": exact_level,
        "exact_deg": pd.Series(np.degrees(np.angle(rows.exact)), rows.index),
        "error_db": on_scale(level) - on_scale(exact_level),
        "error_deg": turn,
        "error_percent": 100 * (rows.ratio - rows.exact).abs() / amplitude(rows),
    }


def _decibel(ratio: pd.Series) -> pd.Series:
    return DB * np.log(ratio.abs())


def on_scale(level_db: pd.Series) -> pd.Series:
    """Give levels on the scale of differences: dB, and below the floor linear in the amplitude."""
    linear = FLOOR_DB + DB * (10 ** ((level_db - FLOOR_DB) / 20) - 1)
    return level_db.where(~(level_db < FLOOR_DB), linear)


def friction_effect(case: Case, exact: complex) -> float:
    """Give how much friction changes T at all: its distance from the farther linear limit, over U0.

    Between contacts that slide freely and contacts that never slide lies what friction can do.
    """
    return max(abs(limit - exact) for limit in linear_limits(case))


def _in_percent(off: pd.DataFrame) -> str:
    return f"{off.error_percent.max():.3g} %"


def failures(
    rows: pd.DataFrame,
    named: Callable[[pd.DataFrame], pd.Series] | None = None,
    by: Callable[[pd.DataFrame], str] = _in_percent,
) -> list[str]:
    """Say why a command fails, a line a configuration; nothing where it does not. `by` says how far rows deviate.

    It fails where a judged number deviates, where more than a quarter of the numbers of a judged preset are missing,
    and where a preset that is judged or `named` fails at more than a quarter. What is unsupported is not counted.
    """
    lines = []
    asked = rows.judged if named is None else rows.judged | named(rows)
    for name, own in rows[asked & (rows.verdict != "unsupported")].groupby("configuration", sort=False):
        total = len(own)
        counts = own.verdict.value_counts()
        deviating, failed = int(counts.get(DEVIATES, 0)), int(counts.get("failed", 0))
        missing = total - deviating - int(counts.get(AGREES, 0))
        if own.judged.all() and deviating:
            worst = by(own[own.verdict == DEVIATES])
            lines.append(f"{name}: {deviating} of {total} numbers deviate, by up to {worst}")
        elif failed > MOST_MISSING * total:
            first = own[own.verdict == "failed"].reason.iloc[0]
            lines.append(f"{name}: {failed} of {total} numbers failed: {first}")
        elif own.judged.all() and missing > MOST_MISSING * total:
            lines.append(f"{name}: {missing} of {total} numbers are missing")
    return lines


def conclusion(rows: pd.DataFrame) -> str:
    """Say in one sentence what has come out."""
    own = rows[rows.judged & (rows.verdict != "unsupported")]
    if own.empty:
        return "Nothing was judged: no preset here is judged, their errors are measured."
    off, agreeing = own[own.verdict == DEVIATES], int((own.verdict == AGREES).sum())
    rest = len(own) - len(off) - agreeing
    silent = f" {rest} have no verdict." if rest else ""
    if off.empty:
        return f"{agreeing} of {len(own)} judged numbers agree with the exact motion, none deviates.{silent}"
    whose = ", ".join(f"{name} {count}" for name, count in off.groupby("configuration", sort=False).size().items())
    return f"{len(off)} of {len(own)} judged numbers deviate from the exact motion: {whose}.{silent}"
