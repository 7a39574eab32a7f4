"""``python -m reference_lcp bench``, ``convergence`` and ``coverage``: what they measure, and print."""

import json
from functools import partial
from pathlib import Path
from typing import Any

from reference_lcp.accuracy.benchmark import bench, bench_cells
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS, Convergence, convergence, plot_convergence
from reference_lcp.accuracy.coverage import QUANTITIES, CoverageStudy, coverage
from reference_lcp.accuracy.point_benchmark import bench_points
from reference_lcp.accuracy.richardson import SAFETY
from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.compilation import announce_compilation
from reference_lcp.progress_lines import tracked
from reference_lcp.terminal_table import print_table


def print_speed(*, cells: bool, points: bool, as_json: bool) -> None:
    """Measure the speed of the reference, or what chains of several lengths cost, or points by several methods."""
    announce_compilation()
    if points:
        methods = bench_points()
        print(json.dumps(methods, indent=2)) if as_json else _print_methods(methods)
        return
    if cells:
        lengths = bench_cells()
        print(json.dumps(lengths, indent=2)) if as_json else _print_lengths(lengths)
        return
    numbers = bench()
    print(json.dumps(numbers, indent=2) if as_json else "\n".join(f"{name}: {n:.4g}" for name, n in numbers.items()))


def print_studies(plot: Path | None, *, as_json: bool) -> None:
    """Compare steps with the exact motion, at every point with stick and slip."""
    announce_compilation()
    studies = {
        f"({friction:g}, {frequency:g})": _study(friction, frequency) for friction, frequency in STICK_SLIP_POINTS
    }
    if as_json:
        print(json.dumps({name: study.as_dict() for name, study in studies.items()}, indent=2))
    else:
        _print_studies(studies)
    if plot is not None:
        plot_convergence(studies, plot)


def print_covered(chains: int, seed: int, *, as_json: bool) -> None:
    """Compare error bars of random chains with the exact motion, with a bar on the way."""
    announce_compilation()
    study = coverage(chains, seed, partial(tracked, unit="chains"))
    if as_json:
        print(json.dumps(study.as_dict(), indent=2))
        return
    _print_coverage(study)


def _study(friction_ratio: float, frequency_ratio: float) -> Convergence:
    chain = Chain.from_ratios(friction_ratio=friction_ratio)
    return convergence(chain, HarmonicBase.from_ratio(chain, frequency_ratio))


def _print_studies(studies: dict[str, Convergence]) -> None:
    rows = [
        (
            name,
            f"{each.transmittance_order:.2f}",
            f"{each.transition_order:.2f}",
            f"{each.transmittance_error_db[0]:.4f}",
        )
        for name, each in studies.items()
    ]
    print_table(("friction, frequency", "order: transmittance", "transition times", "error at 400 steps (dB)"), rows)


def _print_lengths(lengths: list[dict[str, float]]) -> None:
    rows = [
        (
            f"{row['cells']:,}",
            f"{1e9 * row['seconds_per_cell_step']:.2f}",
            f"{row['bytes']:,}",
            f"{row['bytes'] / row['cells']:.0f}",
        )
        for row in lengths
    ]
    print_table(("cells", "ns per cell-step", "bytes", "bytes per cell"), rows)


def _print_methods(methods: list[dict[str, Any]]) -> None:
    rows = []
    for row in methods:
        bar = row["median_bar_db"], row["covered"]
        columns = [
            row["method"],
            f"{1e3 * row['seconds_per_point']:.3g}",
            str(row["failed"]),
            *(f"{row[name]:.2g}" for name in ("median_error_db", "largest_error_db")),
            *(("", "") if None in bar else (f"{bar[0]:.2g}", f"{100 * bar[1]:.0f}")),
        ]
        rows.append(columns)
    errors = "median error (dB)", "largest (dB)"
    print_table(("method", "ms a point", "failed", *errors, "median bar (dB)", "covered (%)"), rows)


def _print_coverage(study: CoverageStudy) -> None:
    """Print a line for each quantity, with the numbers of the three steps, the coarsest first, in every column."""
    lines = []
    for quantity in QUANTITIES:
        rows = [row for row in study.rows if row.quantity == quantity]
        columns = (
            [str(len(row.margins)) for row in rows],
            [f"{100 * row.covered():.1f}" for row in rows],
            [f"{100 * row.covered(SAFETY):.1f}" for row in rows],
            [f"{row.median_margin:.1f}" for row in rows],
            [str(row.undecided) for row in rows],
        )
        lines.append((quantity, *("\n".join(column) for column in columns)))
    headings = ("quantity", "compared", "covered (%)", f"by bar / {SAFETY:g} (%)", "bar / error", "undecided")
    print_table(headings, lines)
    print(f"{study.chains} chains, {study.uncertified} of them without a certified steady state; for each quantity the")
    print("fewest steps, twice and four times as many (by two steps: the last two); bar / error is the median")
