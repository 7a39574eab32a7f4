"""Documents in Markdown: parts one after the other, and nothing of what is empty."""

import pandas as pd

from multibody_xval.reports.document import Folded, document

TABLE = pd.DataFrame({"engine": ["a|b"], "number": ["1"]})


def test_parts_stand_one_after_the_other_and_empty_ones_are_left_out() -> None:
    text = document(["# Title", "", [], TABLE[:0], ["one", "two"], TABLE, Folded("more", ["within"])])
    assert text.split("\n\n") == [
        "# Title",
        "- one\n- two",
        "| engine | number |\n|---|---|\n| a\\|b | 1 |",
        "<details><summary>more</summary>",
        "within",
        "</details>\n",
    ]
