"""A sweep in words: its drive, its axes, its band, what its variants are compared with."""

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.formatting import ratio
from multibody_xval.scenarios.sweeps.sweep import Case, GivenTolerance, Sweep, baseline
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE


def drive_description(sweep: Sweep) -> str:
    """Describe the drive of the chain, and the meaning of U0."""
    drive = sweep.excitation
    if drive.kind == "base":
        return f"on a base that moves harmonically (U0 = {drive.amplitude:g} m)"
    scale = f"U0 stands for P0 / k_c = {drive.displacement:g} m"
    return f"driven by a harmonic force on the outer mass of cell 1 (P0 = {drive.amplitude:g} N; {scale})"


def compared_with(variant: Variant, given: GivenTolerance | None = None) -> str:
    """Describe the baseline of a variant, its tolerance, and the reason for both."""
    if given is not None and given.judges(variant):
        against = "converged reference" if given.baseline == CONVERGED else "reference at equal time step"
        return f"Compared with the {against}; {given.transmittance_db:g} dB are allowed, the tolerance of the sweep."
    if variant == CONVERGED:
        return "The baseline: the reference's scheme with a step so fine that its own error does not show."
    if variant == REFERENCE:
        return (
            "Compared with the converged reference: the difference is the scheme's own first-order step error, and its "
            "own estimate from two step sizes is allowed."
        )
    if baseline(variant) == REFERENCE:
        return (
            "Takes the same semi-implicit Euler step as the reference, and so shares its step error: compared with "
            "the reference at equal time step; nothing is allowed but what neither can resolve."
        )
    return (
        "Has an integrator of its own: compared with the converged reference; its own error is allowed, from two step "
        "sizes, or the reference's at the same step where that is larger."
    )


def named_axes(sweep: Sweep, *, plural: bool = True) -> str:
    """Name what is varied beside the frequency ratio, such as ``friction ratios and mass ratios``."""
    *first, last = (axis_name(name, plural=plural) for name in sweep.case_axes)
    return f"{', '.join(first)} and {last}" if first else last


def axis_name(name: str, *, plural: bool = False) -> str:
    """Name an axis of a sweep in words."""
    if name in ("cells", "steps_per_period"):
        what = "cells" if name == "cells" else "steps"
        return f"number{'s' if plural else ''} of {what}"
    return name.replace("_", " ") + ("s" if plural else "")


def file_name(point: tuple[Case, *tuple[float, ...]]) -> str:
    """Give the values of a case, and what follows it, as part of the name of a file, such as ``0.3-0.9``."""
    case, *rest = point
    return "-".join(f"{value:g}" for value in (*case.by_axis.values(), *rest))


def band_definition(sweep: Sweep) -> str:
    """Give the definition of the attenuation band in a sentence."""
    band = sweep.band
    return (
        "The low-frequency attenuation band is the interval of η_r that holds the first deep attenuation "
        f"(transmittance below {ratio(band.depth_db)} dB), extended both ways to where the transmittance crosses "
        f"{ratio(band.threshold_db)} dB."
    )
