"""The commands of ``python -m scenarios``."""
