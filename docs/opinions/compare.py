"""Two second opinions on the paper's chain beside its exact motion: a table.

pip install '.[opinions]' && python docs/opinions/compare.py docs/opinions/opinions.csv
"""

import csv
import sys
from cmath import isnan
from pathlib import Path

import harmonic_balance
import nonsmooth_integrator

from multibody_xval.scenarios.model import Case
from multibody_xval.scenarios.ruler.proven import proven
from reference_lcp import decibel
from reference_lcp.defaults import STICK_SLIP_POINTS

POINTS = (*STICK_SLIP_POINTS, (0.1, 0.9), (0.1, 1.4), (0.3, 1.5), (1.0, 1.4))
"""Friction and frequency ratios: in the pass band, at the resonator's frequency, and deep in the band."""

HARMONICS, STEPS = (1, 2, 4, 8), (50, 100, 200)
"""Numbers of odd harmonics, and steps per period."""


def row(case: Case) -> dict[str, str]:
    """Compare both with the exact motion at a point: errors over its amplitude."""
    exact = proven()[case]
    found = {"friction ratio": f"{case.friction_ratio:g}", "η_r": f"{case.frequency_ratio:g}",
             "exact [dB]": f"{decibel(abs(exact)):.4f}"}  # fmt: skip
    for count, own in zip(HARMONICS, harmonic_balance.transmittance(case, HARMONICS), strict=True):
        found[f"{2 * count - 1} harmonics"] = "not solved" if isnan(own) else percent(own, exact)
    for steps in STEPS:
        period = nonsmooth_integrator.period(case, steps)
        found[f"{steps} steps"] = percent(period.transmittance, exact)
    return found | {"returns within": f"{period.returns:.0e} U0", "unsolved": str(period.unsolved)}


def percent(found: complex, exact: complex) -> str:
    """Give the distance over the exact amplitude, in two digits."""
    return f"{float(f'{100 * abs(found / exact - 1):.2g}'):g} %"


def main(file: Path) -> None:
    """Write the table."""
    rows = []
    for friction, eta in POINTS:
        rows.append(row(Case(friction_ratio=friction, frequency_ratio=eta)))
        print(rows[-1], flush=True)
    with file.open("w", encoding="utf-8", newline="") as written:
        table = csv.DictWriter(written, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
