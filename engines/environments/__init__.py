"""Environments that the suite makes: Pythons of their own for engines, or for versions of engines, beside its own.

An environment holds an engine and what it needs, and nothing of the suite: its worker process takes the adapter from
the suite that started it, and advances lanes there as the adapter does here. See `engines.out_of_process`.
"""
