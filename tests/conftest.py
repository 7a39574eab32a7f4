"""Settings of the whole test run."""

import os

from hypothesis import settings

# A run of CI repeats bit for bit; elsewhere every run looks at new examples.
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")
