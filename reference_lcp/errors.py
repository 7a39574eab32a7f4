"""Refused input, proofs that fail, and how a message shows a value; imports no NumPy."""

import difflib
from collections.abc import Sequence

SHOWN = 80
"""Characters of a value that a message shows."""


class ParameterError(ValueError):
    """A parameter outside its allowed range; the message is one line."""


class NotProven(Exception):
    """Nothing is claimed; the message says which step of a proof fails."""


def shown(value: object) -> str:
    """Give a value as a message shows it: in one line, and the beginning of a long one."""
    try:
        text = repr(value)
    except ValueError:  # integers of more than 4300 digits have no text
        return "a number of more than 4300 digits"
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}… ({len(text)} characters)"


def checked_choice(name: str, value: str, allowed: Sequence[str]) -> str:
    """Give `value` if it is one of `allowed`; else raise `ParameterError` with these."""
    if value in allowed:
        return value
    raise ParameterError(f"{name} = {shown(value)} is unknown; {choices(value, allowed)}")


def choices(value: object, allowed: Sequence[str]) -> str:
    """List the names that are allowed in place of `value`, and ask whether the one most like it was meant.

    Names with commas are quoted.
    """
    names = [repr(name) if "," in name else name for name in allowed]
    return f"allowed: {', '.join(names)}{meant(value, allowed)}"


def meant(value: object, allowed: Sequence[str]) -> str:
    """Ask whether the name most like a value was meant, or the first that begins with it; else give an empty text.

    Case and punctuation make no difference.
    """
    text = _letters(str(value)[:SHOWN])
    names = {_letters(name): name for name in reversed(allowed) if text and _letters(name)}
    begun = [own for own in reversed(names) if own.startswith(text)]
    near = difflib.get_close_matches(text, names, 1) or begun
    return f"; did you mean {names[near[0]]}?" if near else ""


def _letters(text: str) -> str:
    """Give the letters and digits of a text, in small letters."""
    return "".join(filter(str.isalnum, text.casefold()))
