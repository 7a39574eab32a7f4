"""How tasks are run: evaluator, executors, store, progress."""
