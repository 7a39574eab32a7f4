"""Curves, map and features of chains with one dry contact, in closed form.

python docs/targets/one_contact.py docs/_static docs/targets/one_contact.csv
"""

import csv
import sys
from functools import cache, partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from multibody_xval.reports.figures.style import COLUMN, PALETTE, PRINT_STYLE
from reference_lcp import FrictionContact, Harmonic, MassSpringSystem, ParameterError, Spring
from reference_lcp.exact.continuous_sliding import SlidingMotion, largest_sliding_friction
from reference_lcp.exact.one_contact import OneContact
from reference_lcp.exact.sliding_features import bounding_friction, invariant_frequencies

CONTACTS = {
    2: {"wall": (1, None), "mass": (1, 0), "base": (1, None)},
    5: {"wall": (2, None), "mass": (3, 2), "base": (2, None)},
}
"""Of chains of so many masses, the bodies of the contact; against the base, displacements are relative to it."""

TITLES = {"wall": "mass {} and wall", "mass": "masses {1} and {0}", "base": "mass {} and base"}

FRICTIONS = (0.05, 0.2, 0.5, 0.75, 1.0)
"""F / (k U0) of the curves."""

LOWEST, HIGHEST, POINTS = 0.2, 2.4, 397
"""Frequencies over √(k / m)."""

SLIDES, STOPS, LOCKED = "#a6dccb", "#f6dca5", "#a6cde3"
"""Colours of the regimes."""

TALLEST = 100.0
"""Amplitude over U0 at which panels end; resonances are taller."""


def chain(masses: int, place: str, omega: float, friction: float = 0.0) -> MassSpringSystem:
    """Equal masses in a row, m = k = 1, on a base that moves by sin ωt."""
    first, second = CONTACTS[masses][place]
    sizes = np.full(masses, omega**2) if place == "base" else np.eye(masses)[0]
    return MassSpringSystem(
        masses=np.ones(masses),
        springs=[Spring(k, k - 1 if k else None, 1.0) for k in range(masses)],
        friction=[FrictionContact(first, second, 1.0, friction)],
        forces={k: Harmonic(amplitude=a, angular_frequency=omega) for k, a in enumerate(sizes.tolist()) if a},
    )


def moving(place: str) -> float:
    """Amplitude of what displacements are relative to."""
    return 1.0 if place == "base" else 0.0


def transmissibility(masses: int, place: str, omega: float, friction: float) -> complex:
    """Of the last mass, NaN where the contact stops or the drive is in resonance."""
    try:
        motion = SlidingMotion.of(chain(masses, place, omega, friction))
    except ParameterError:
        return complex("nan")
    return complex(motion.fundamental[-1]) + moving(place)


def title(masses: int, place: str) -> str:
    """Name the contact."""
    return TITLES[place].format(*(body + 1 for body in CONTACTS[masses][place] if body is not None))


def curves(masses: int, picture: Path) -> None:
    """Draw amplitude and phase of the last mass for every place of the contact."""
    omegas = np.linspace(LOWEST, HIGHEST, POINTS)
    with plt.rc_context(PRINT_STYLE):
        figure, panels = plt.subplots(
            2, 3, figsize=(2 * COLUMN, 1.15 * COLUMN), sharex=True, sharey="row", layout="constrained"
        )
        for place, (upper, lower) in zip(CONTACTS[masses], panels.T, strict=True):
            for friction, colour in zip((0.0, *FRICTIONS), ("0.6", *PALETTE), strict=False):
                values = np.array([transmissibility(masses, place, omega, friction) for omega in omegas.tolist()])
                upper.plot(omegas, np.abs(values), color=colour, label=f"{friction:g}")
                phases = np.degrees(np.angle(values)) % -360
                phases[1:][np.abs(np.diff(phases)) > 180] = np.nan  # where −360° becomes 0°
                lower.plot(omegas, phases, color=colour)
            for omega in invariant(masses, place):
                upper.plot(
                    omega,
                    abs(transmissibility(masses, place, omega, 1e-9)),
                    "o",
                    color="k",
                    markersize=3.5,
                    fillstyle="none",
                )
            upper.set(title=title(masses, place), yscale="log", ylim=(0.01, TALLEST))
            lower.set(xlabel="$\\omega / \\sqrt{k/m}$", ylim=(-365, 5), yticks=[-360, -180, 0])
        panels[0, 0].set_ylabel("amplitude / $U_0$")
        panels[1, 0].set_ylabel("phase [°]")
        figure.legend(
            *panels[0, 0].get_legend_handles_labels(), title="$F / (k U_0)$", loc="outside upper center", ncols=6
        )
        figure.savefig(picture, metadata={"Date": None})


@cache
def invariant(masses: int, place: str) -> list[float]:
    """Frequencies at which friction does not change the amplitude of the last mass."""
    family = partial(chain, masses, place)
    return invariant_frequencies(family, masses - 1, lowest=LOWEST, highest=HIGHEST, moving=moving(place))


def regimes(axes: Axes, masses: int, place: str) -> None:
    """Fill where the contact slides, stops in between, and is locked."""
    omegas = np.linspace(LOWEST, HIGHEST, POINTS)
    slides = np.array([largest_sliding_friction(chain(masses, place, omega)) for omega in omegas.tolist()])
    locks = np.array([OneContact.of(chain(masses, place, omega)).locked_friction for omega in omegas.tolist()])
    axes.set_facecolor(LOCKED)
    for highest, colour in ((locks, STOPS), (slides, SLIDES)):
        axes.fill([LOWEST, *omegas, HIGHEST], [1e-3, *np.minimum(highest, 1e3), 1e-3], color=colour, linewidth=0)
    axes.plot(omegas, slides, color="0.15")
    axes.plot(omegas, locks, "--", color="0.15")
    axes.set(yscale="log", xlim=(LOWEST, HIGHEST), ylim=(0.01, 10.0), title=title(masses, place))


def region_map(picture: Path) -> None:
    """Draw the regimes of all chains."""
    with plt.rc_context(PRINT_STYLE):
        figure, panels = plt.subplots(
            2, 3, figsize=(2 * COLUMN, 1.15 * COLUMN), sharex=True, sharey=True, layout="constrained"
        )
        for masses, row in zip(CONTACTS, panels, strict=True):
            for place, axes in zip(CONTACTS[masses], row, strict=True):
                regimes(axes, masses, place)
            row[0].set_ylabel(f"{masses} masses: $F / (k U_0)$")
        for axes in panels[1]:
            axes.set_xlabel("$\\omega / \\sqrt{k/m}$")
        figure.savefig(picture, metadata={"Date": None})


def features(table: Path) -> None:
    """Write natural frequencies with the friction that bounds them, and invariant frequencies."""
    with table.open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(
            [
                "masses",
                "contact",
                "natural frequency: friction that bounds it",
                "last mass is the same with any friction at",
            ]
        )
        for masses, places in CONTACTS.items():
            for place in places:
                bounds = zip(*bounding_friction(partial(chain, masses, place)), strict=True)
                texts = ", ".join(f"{omega:.4f}: {friction:.4g}" for omega, friction in bounds)
                rows.writerow(
                    [
                        masses,
                        title(masses, place),
                        texts,
                        ", ".join(f"{omega:.4f}" for omega in invariant(masses, place)),
                    ]
                )


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for masses in CONTACTS:
        curves(masses, folder / f"target_one_contact_{masses}.svg")
    region_map(folder / "target_one_contact_map.svg")
    features(Path(sys.argv[2]))
