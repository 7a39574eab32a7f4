"""The table of the target sheets' index: published values beside the motion without a time step.

python docs/targets/exact_values.py docs/targets/exact_values.csv
"""

import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.reference_lcp.published.anchors import ANCHORS, exact_values


def write(path: Path) -> None:
    """Write a row a value."""
    with path.open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["value", "published", "exact motion", "error", "may be off by"])
        for name, value in exact_values().items():
            anchor = ANCHORS[name]
            numbers = (anchor.value, value, value - anchor.value, anchor.uncertainty)
            table.writerow(
                [name, *(f"{number:.{digits}g}" for number, digits in zip(numbers, (9, 9, 2, 2), strict=True))]
            )


if __name__ == "__main__":
    write(Path(sys.argv[1]))
