"""The catalogue: one scenario a file; commands list them by their `descriptions` before any is imported."""
