"""Options and presets of Pinocchio."""

from multibody_xval.engines.interface.law import NotModelled
from multibody_xval.engines.interface.presets import NormalForce, Option, Preset


def admm(preset: Preset) -> NotModelled:
    """Say what decides its steps."""
    return NotModelled(
        f"Coulomb's law in equation (5), but where ADMM stops, at {preset['tolerance']:g} N s, decides the impulses"
    )


JOINT_OPTIONS = {
    "units": Option.own("SI", "The chain in SI units."),
    "solver": Option.own("PGS or ADMM", "Pinocchio has both, and leaves the choice to its user."),
    "tolerance": Option.own(1e-6, "Pinocchio's own, of feasibility and of complementarity: absolute."),
    "max_iterations": Option.own(1000, "Pinocchio's own."),
}

JOINT_TUNED = Preset(
    "Friction impulses by projected Gauss-Seidel, which one sweep solves.",
    JOINT_OPTIONS,
    {
        "units": ("lane", "No number comes near built-in smallest ones."),
        "solver": ("PGS", "Frictions do not touch each other's masses: the first sweep is exact."),
        "tolerance": (0.0, "The solver's tolerances are absolute, whatever the units."),
        "max_iterations": (2, "One sweep solves it; the second one confirms that."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "Projected Gauss-Seidel in SI units, with Pinocchio's own settings.",
    JOINT_OPTIONS,
    {"solver": ("PGS", "Gauss–Seidel, as in most contact engines.")},
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)

JOINT_ADMM = Preset(
    "ADMM in SI units, with Pinocchio's own settings: an impulse is right to 1e-6 N s, however small it is.",
    JOINT_OPTIONS,
    {"solver": ("ADMM", "Pinocchio's solver for hard problems.")},
    known_deviation=(
        "the solver's tolerance of 1e-6 N s is absolute: the finer the step, the larger the relative error of the "
        "friction impulses F dt"
    ),
    law=admm,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)
