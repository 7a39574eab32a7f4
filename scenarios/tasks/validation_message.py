"""Wrong values that pydantic finds, in the words of the suite."""

from typing import Any

from pydantic import ValidationError

from reference_lcp.validation import ParameterError

TAGS = ("values", "range", "adaptive", "one for all", "one a cell")
"""Of the ways in which a value may be written; they stand in no file."""


def first_error(problem: ValidationError, known: str) -> ParameterError:
    """Say what is wrong first, in one line: its place, its value and what is allowed.

    Parameters
    ----------
    problem
        What pydantic found.
    known
        What is allowed in place of an unknown name.
    """
    error: Any = problem.errors()[0]
    place = ".".join(str(part) for part in error["loc"] if part not in TAGS)
    kind = error["type"]
    if kind == "value_error":
        return ParameterError(str(error["ctx"]["error"]))
    if kind in ("extra_forbidden", "unexpected_keyword_argument"):
        return ParameterError(f"{place} is unknown; allowed: {known}")
    if kind == "missing":
        return ParameterError(f"{place} is missing")
    message = f"{error['msg'][0].lower()}{error['msg'][1:]}"
    return ParameterError(f"{place} = {error['input']!r}; {message}" if place else message)
