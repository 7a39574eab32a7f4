"""Texts of others on a screen: characters that control a terminal are shown, not obeyed."""

import re

_CONTROLS = re.compile(
    "["
    "\x00-\x1f\x7f-\x9f"  # C0 with line feeds and escape sequences, C1
    "\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"  # the order in which letters are shown, and ends of lines
    "\ud800-\udfff"  # bytes of file names that are no UTF-8
    "\ufffe\uffff"  # no characters; XML refuses them
    "]"
)


def visible(text: str) -> str:
    r"""Give a text in one line that no terminal obeys: an escape character becomes the letters ``\x1b``."""
    return _CONTROLS.sub(lambda control: control[0].encode("unicode_escape").decode(), text)
