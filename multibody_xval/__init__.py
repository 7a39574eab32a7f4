"""The three functions of the suite under a name that nothing else has: `sweep`, `check` and `report`.

``import multibody_xval`` also works beside files of the user's that are called ``engines.py`` or ``reports.py``, which
``from scenarios import sweep`` takes for packages of the suite: the suite's own are imported here, from where this
package lies.
"""

import importlib
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from reports import report
    from scenarios import check, sweep

__all__ = ["check", "report", "sweep"]

_PACKAGES = ("reference_lcp", "engines", "scenarios", "reports")
_ROOT = Path(__file__).resolve().parents[1]


def __getattr__(name: str) -> Any:
    """Import a function on first use."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module("reports" if name == "report" else "scenarios"), name)


def _import_packages() -> None:
    """Import the packages of the suite, whatever has their names in the working folder.

    Raises
    ------
    ImportError
        If something else has been imported under one of their names before.
    """
    sys.path.insert(0, str(_ROOT))
    try:
        for name in _PACKAGES:
            own = str(_ROOT / name / "__init__.py")
            file = importlib.import_module(name).__file__
            if file != own:
                problem = f"{name} has been imported from {file}, which is not the suite's {own}"
                raise ImportError(f"{problem}; allowed: import multibody_xval first")
    finally:
        sys.path.remove(str(_ROOT))


_import_packages()
