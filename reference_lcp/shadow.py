"""Files of the working folder that Python takes for packages of the suite, with ``python -m`` and in scripts."""

import importlib.util
import sys
from pathlib import Path

from reference_lcp.exit_code import ExitCode

PACKAGES = ("reference_lcp", "engines", "scenarios", "reports")
"""What the suite imports of itself."""

ROOT = Path(__file__).resolve().parents[1]


def refuse_shadows() -> None:
    """End a command of ``python -m`` where a package of the suite is hidden by something of the working folder.

    Nothing can be said where it is the package itself that ``python -m`` names: then Python runs what hides it.
    """
    for name in PACKAGES:
        spec = importlib.util.find_spec(name)
        origin = None if spec is None else spec.origin
        if origin is not None and Path(origin).resolve() != ROOT / name / "__init__.py":
            print(
                f"error: {origin} hides the package {name} of the suite; allowed: the command multibody-xval, which "
                "does not look into the working folder, or another folder",
                file=sys.stderr,
            )
            raise SystemExit(ExitCode.WRONG_INPUT)
