"""Simulations and comparisons: tasks, their runs, verdicts, studies, sweeps, the catalogue.

`sweep` and `check` are all that a notebook needs; they are imported on first use.
"""

from typing import TYPE_CHECKING, Any

# A checkout has the folder of this name too: nothing is to be imported twice.
if __name__ != "multibody_xval.scenarios":
    raise ImportError("scenarios is a folder of the suite, and no package; allowed: multibody_xval.scenarios")

if TYPE_CHECKING:
    from multibody_xval.scenarios.functions import check, sweep

__all__ = ["check", "sweep"]


def __getattr__(name: str) -> Any:
    """Import the functions on first use: a worker process needs neither of them."""
    if name in __all__:
        from multibody_xval.scenarios import functions

        return getattr(functions, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
