"""A record of a moving base, read from a table of time [s] and displacement [m]."""

import csv
import io
import math
from pathlib import Path

from multibody_xval.engines.interface.texts import is_number, text_of_file
from reference_lcp.chain.transient import FEWEST_SAMPLES, RecordedBase
from reference_lcp.errors import ParameterError


def read_record(file: Path, amplitude: float | None = None) -> RecordedBase:
    """Read a table, separated by a comma, one sample a line; scaled to an amplitude [m] where one is given.

    A first line of words is a heading; empty lines and lines that begin with # are skipped.

    Raises
    ------
    ParameterError
        If the file cannot be read, or a line is not a sample; the message names file and line.
    """
    samples = _samples(file)
    if len(samples) < FEWEST_SAMPLES:
        raise ParameterError(f"record {file} has {len(samples)} samples; allowed: at least {FEWEST_SAMPLES}")
    times, displacements = zip(*samples, strict=True)
    try:
        base = RecordedBase(times, displacements)
        factor = 1.0 if amplitude is None else amplitude / base.amplitude
        return RecordedBase(times, tuple(factor * value for value in displacements))
    except ParameterError as problem:
        raise ParameterError(f"record {file}: {problem}") from None


def _samples(file: Path) -> list[tuple[float, float]]:
    try:
        lines = list(csv.reader(io.StringIO(text_of_file("record", file), newline="")))
    except (OSError, UnicodeDecodeError, csv.Error) as problem:
        reason = problem.strerror if isinstance(problem, OSError) else problem
        raise ParameterError(f"record {file} cannot be read: {reason}") from None
    filled = ((number, line) for number, line in enumerate(lines, start=1) if any(cell.strip() for cell in line))
    samples = [(number, line) for number, line in filled if not line[0].lstrip().startswith("#")]
    if samples and len(samples[0][1]) == 2 and not any(is_number(cell) for cell in samples[0][1]):
        samples = samples[1:]
    return [_sample(file, number, line) for number, line in samples]


def _sample(file: Path, number: int, line: list[str]) -> tuple[float, float]:
    where = f"line {number} of record {file}"
    if len(line) != 2:
        raise ParameterError(f"{where} has {len(line)} columns; allowed: 2, time [s] and displacement [m]")
    for cell in line:
        if not is_number(cell) or not math.isfinite(float(cell)):
            raise ParameterError(f"{cell.strip()!r} in {where} is not a number; allowed: finite numbers")
    return float(line[0]), float(line[1])
