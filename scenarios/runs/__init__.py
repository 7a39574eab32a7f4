"""Tasks and results, and how tasks are run: executors, workers, store, progress."""

TIME_LIMIT = 300.0
"""Seconds that a batch of tasks may take: a hundred times what the slowest engine needs for a typical one."""
