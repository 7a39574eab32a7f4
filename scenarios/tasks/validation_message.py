"""Wrong values that pydantic finds, in the words of the suite."""

from typing import Any

from pydantic import ValidationError

from reference_lcp.refusal import ParameterError, shown

TAGS = ("values", "range", "adaptive", "one for all", "one a cell")
"""Of the ways in which a value may be written; they stand in no file."""


def first_error(problem: ValidationError, known: str) -> ParameterError:
    """Give the first error in one line: its key, its value and what is allowed.

    Parameters
    ----------
    problem
        The error of pydantic.
    known
        The names that are allowed where one is unknown.
    """
    error: Any = problem.errors()[0]
    key = ".".join(str(part) for part in error["loc"] if part not in TAGS)
    kind = error["type"]
    if kind == "value_error":
        return ParameterError(str(error["ctx"]["error"]))
    if kind in ("extra_forbidden", "unexpected_keyword_argument"):
        return ParameterError(f"{key} is unknown; allowed: {known}")
    if kind == "missing":
        return ParameterError(f"{key} is missing")
    message = f"{error['msg'][0].lower()}{error['msg'][1:]}"
    return ParameterError(f"{key} = {shown(error['input'])}; {message}" if key else message)
