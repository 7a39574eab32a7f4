"""Runs and their results: worker processes, clusters, progress."""
