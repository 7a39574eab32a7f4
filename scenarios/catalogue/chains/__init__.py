"""Chains under any drive, in a steady state or from a state on."""
