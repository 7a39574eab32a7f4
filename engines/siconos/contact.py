"""Presets of Siconos's contact formulation: in every cell two pressed masses; `server` holds its model."""

from engines.interface.presets import Option, Preset
from engines.siconos.joint import SHARED_TUNED_OPTIONS
from engines.siconos.law import moreau_jean, opening_contacts

CONTACT_TUNED = Preset(
    "Moreau–Jean with θ = ½, and a contact solver that goes on to round-off.",
    {
        **SHARED_TUNED_OPTIONS,
        "solver": Option("NSGS", "NSGS", "Gauss–Seidel over the contacts; Lemke's method sometimes opens a contact."),
        "tolerance": Option(1e-14, 1e-4, "Of NSGS: it stops early otherwise, and motions err by 1e-6 of U0."),
        "threshold": Option(
            1e-6, 0.0, "Gap over the displacement scale up to which a contact acts; round-off must not open it."
        ),
    },
    law=moreau_jean,
    split_tolerance=1e-12,
)

CONTACT_DEFAULT = Preset(
    "The same contacts in SI units, with Siconos's own solver and tolerance.",
    {
        "units": Option("SI", "SI", "The chain in SI units."),
        "theta": Option(0.5, "none", "Needed; the value of Siconos's examples."),
        "springs": Option("own", "own", "Stiffness and damping matrix of LagrangianLinearTIDS."),
        "newton": Option("nonlinear", "nonlinear", "Siconos's own."),
        "solver": Option("NSGS", "NSGS", "Siconos's own."),
        "tolerance": Option(1e-4, 1e-4, "Siconos's own."),
        "threshold": Option(0.0, 0.0, "Siconos's own: a contact acts where its gap is not positive."),
    },
    split_tolerance=1e-12,
    known_deviation=(
        "a contact acts where its gap is not positive only: round-off opens a closed one now and then for a step or "
        "two, which have no friction; and the contact solver stops at 1e-4"
    ),
    law=opening_contacts,
)
