"""What the commands of ``python -m reference_lcp`` do and print."""
