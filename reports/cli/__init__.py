"""Further commands of ``python -m reports``."""
