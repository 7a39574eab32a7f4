"""``python -m reference_lcp bench``, ``convergence`` and ``coverage``: what they measure, and print."""

import json
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import track
from rich.table import Column, Table

from reference_lcp.accuracy.benchmark import bench, bench_cells
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS, Convergence, convergence, plot_convergence
from reference_lcp.accuracy.coverage import QUANTITIES, CoverageStudy, coverage
from reference_lcp.accuracy.point_benchmark import bench_points
from reference_lcp.accuracy.richardson import SAFETY
from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.compilation import announce_compilation


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
    study = coverage(chains, seed, partial(track, console=Console(stderr=True), transient=True))
    if as_json:
        print(json.dumps(study.as_dict(), indent=2))
        return
    _print_coverage(study)


def _study(friction_ratio: float, frequency_ratio: float) -> Convergence:
    chain = Chain.from_ratios(friction_ratio=friction_ratio)
    return convergence(chain, HarmonicBase.from_ratio(chain, frequency_ratio))


def _print_studies(studies: dict[str, Convergence]) -> None:
    table = Table("friction, frequency", "order: transmittance", "transition times", "error at 400 steps (dB)")
    for name, study in studies.items():
        orders = f"{study.transmittance_order:.2f}", f"{study.transition_order:.2f}"
        table.add_row(name, *orders, f"{study.transmittance_error_db[0]:.4f}")
    Console().print(table)


def _print_lengths(lengths: list[dict[str, float]]) -> None:
    table = Table("cells", "ns per cell-step", "bytes", "bytes per cell")
    for row in lengths:
        nanoseconds, per_cell = 1e9 * row["seconds_per_cell_step"], row["bytes"] / row["cells"]
        table.add_row(f"{row['cells']:,}", f"{nanoseconds:.2f}", f"{row['bytes']:,}", f"{per_cell:.0f}")
    Console().print(table)


def _print_methods(methods: list[dict[str, Any]]) -> None:
    errors = "median\nerror (dB)", "largest\n(dB)"
    table = Table("method", "ms a point", "failed", *errors, "median\nbar (dB)", "covered\n(%)")
    for row in methods:
        bar = row["median_bar_db"], row["covered"]
        table.add_row(
            row["method"],
            f"{1e3 * row['seconds_per_point']:.3g}",
            str(row["failed"]),
            *(f"{row[name]:.2g}" for name in ("median_error_db", "largest_error_db")),
            *(("", "") if None in bar else (f"{bar[0]:.2g}", f"{100 * bar[1]:.0f}")),
        )
    Console().print(table)


def _print_coverage(study: CoverageStudy) -> None:
    """Print a line for each quantity, with the numbers of the three steps, the coarsest first, in every column."""
    name = Column("quantity", min_width=len("transmittance"))
    table = Table(name, "compared", "covered\n(%)", f"by bar\n/ {SAFETY:g} (%)", "bar / error", "undecided")
    for quantity in QUANTITIES:
        rows = [row for row in study.rows if row.quantity == quantity]
        columns = (
            [str(len(row.margins)) for row in rows],
            [f"{100 * row.covered():.1f}" for row in rows],
            [f"{100 * row.covered(SAFETY):.1f}" for row in rows],
            [f"{row.median_margin:.1f}" for row in rows],
            [str(row.undecided) for row in rows],
        )
        table.add_row(quantity, *("\n".join(column) for column in columns))
    Console().print(table)
    print(f"{study.chains} chains, {study.uncertified} of them without a certified steady state; for each quantity the")
    print("fewest steps, twice and four times as many (by two steps: the last two); bar / error is the median")
