"""A module whose own package is not installed."""

import no_such_package  # noqa: F401
