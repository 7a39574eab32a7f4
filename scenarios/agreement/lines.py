"""What is printed of a check: a line with its numbers, whether or not it passes."""

import cmath
import math
from typing import NamedTuple

import numpy as np
import pandas as pd

from multibody_xval.scenarios.agreement.measured import Measured, Row
from multibody_xval.scenarios.catalogue.ruler import DONE
from multibody_xval.scenarios.catalogue.scenario import TRANSMITTANCE
from multibody_xval.scenarios.model import Status
from multibody_xval.scenarios.ruler.judge import AGREES, AT_EQUAL_STEPS, DEVIATES, on_scale

PASSED, FAILED, SKIPPED = "passed", "failed", "skipped"

MEASURED = "measured"

MOST_DIGITS = 17
"""That tell two numbers in double precision apart."""


class Line(NamedTuple):
    """What a check is, and what is printed of it."""

    outcome: str
    text: str


def line_of(own: Measured, allow_db: float | None) -> Line:
    """Say what has come of a check; `allow_db` judges levels of presets that are not judged."""
    title, status, judged = own.check.title, own.result.status, any(row["judged"] for row in own.rows)
    if status is Status.UNSUPPORTED:
        return Line(SKIPPED, f"{title}: unsupported: {own.result.reason}")
    if status not in DONE:
        reason = f": {own.result.reason}" if own.result.reason else ""
        what = "no periodic steady state" if status is Status.NOT_PERIODIC else "failed"
        passes = status is Status.NOT_PERIODIC and not judged and allow_db is None
        return Line(PASSED if passes else FAILED, f"{title}: {what}{reason}{'' if judged else f'; {MEASURED}'}")
    parts = [_part(row, allow_db) for row in own.rows]
    outcomes = [outcome for outcome, _ in parts]
    worst = next((outcome for outcome in (FAILED, SKIPPED) if outcome in outcomes), PASSED)
    return Line(worst, f"{title}: {'; '.join(text for _, text in parts)}{_unjudged(own, allow_db)}")


def _unjudged(own: Measured, allow_db: float | None) -> str:
    levels = all(row["quantity"] == TRANSMITTANCE.name for row in own.rows)
    return "" if own.rows[0]["judged"] or (levels and allow_db is not None) else f"; {MEASURED}"


def _part(row: Row, allow_db: float | None) -> Line:
    """Say what a number is, and what is allowed."""
    level = row["quantity"] == TRANSMITTANCE.name
    text = _level(row, allow_db) if level else _number(row)
    if row["judged"]:
        outcome = {AGREES: PASSED, DEVIATES: FAILED}.get(row["verdict"], SKIPPED)
        return Line(outcome, text if outcome != SKIPPED else f"{text}: {row['verdict']}")
    off = level and allow_db is not None and not abs(level_error(row)) <= allow_db
    return Line(FAILED if off else PASSED, text)


def _level(row: Row, allow_db: float | None) -> str:
    """Say what a transmittance is; level and phase are judged as one number, and of others the level is off."""
    value, exact, reference = row["value"], row["exact"], row["reference"]
    if not row["judged"]:
        allowed = "" if allow_db is None else f", allowed {allow_db:g} dB"
        return f"{decibels(value)} dB, exact {decibels(exact)}, off by {_digits(abs(level_error(row)))} dB{allowed}"
    shares = row["expected"] == AT_EQUAL_STEPS
    expected = reference if shares else exact
    words = f"reference at equal steps {decibels(reference)}" if shares else f"exact {decibels(exact)}"
    off, allowed = "", _digits(_as_level(row["allowed"], expected), 1)
    if row["verdict"] == DEVIATES:
        apart, allowed = _told_apart(*(_as_level(row[name], expected) for name in ("distance", "allowed")))
        off = f", level and phase differ by {apart} dB"
    end = f"; exact {decibels(exact)}" if shares else ""
    return f"{decibels(value)} dB, {words}{off}, allowed {allowed} dB{end}"


def level_error(row: Row) -> float:
    """Give the error of a level to the exact one [dB], as reports have it."""
    levels = on_scale(pd.Series([20 * math.log10(abs(row[name]) or 1e-300) for name in ("value", "exact")]))
    return float(levels[0] - levels[1])


def _as_level(distance: float, expected: complex) -> float:
    """Give what a distance over U0 can change a level by, at most [dB]."""
    return 20 * math.log10(1 + distance / abs(expected))


def _told_apart(off: float, allowed: float) -> tuple[str, str]:
    """Give two numbers with as many digits as show that they differ."""
    texts = ((_digits(off, digits), _digits(allowed, digits)) for digits in range(2, MOST_DIGITS))
    return next((pair for pair in texts if pair[0] != pair[1]), (f"{off}", f"{allowed}"))


def decibels(ratio: complex) -> str:
    """Give a level with three decimals."""
    return "none" if not cmath.isfinite(ratio) else f"{20 * math.log10(abs(ratio) or 1e-300):.3f}".replace("-", "−")


def _number(row: Row) -> str:
    """Say what a number is that is none of a level."""
    unit = f" {row['unit']}" if row["unit"] else ""
    deviates = row["judged"] and row["verdict"] == DEVIATES
    digits = 5 if deviates else 3
    shares = row["expected"] == AT_EQUAL_STEPS
    expected = row["reference"] if shares and pd.notna(row["reference"]) else row["exact"]
    text = f"{row['quantity']} {_digits(row['value'], digits)}{unit}"
    if expected:
        text += f", {'reference' if shares else 'exact'} {_digits(expected, digits)}"
    if deviates:
        off, allowed = _told_apart(row["distance"], row["allowed"])
        return f"{text}, off by {off}, allowed {allowed}"
    return f"{text}, allowed {_digits(row['allowed'])}" if row["judged"] and (row["value"] or row["allowed"]) else text


def _digits(value: float, digits: int = 2) -> str:
    """Give a number with few digits: 1e-6, 0.12, 7,294."""
    number = float(np.real(value))
    if abs(number) >= 100:
        return f"{number:,.0f}".replace("-", "−")
    text = f"{number:.{digits}g}"
    mantissa, e, power = text.partition("e")
    return mantissa.replace("-", "−") + (f"e{int(power)}" if e else "")
