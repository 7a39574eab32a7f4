"""Engines in another Python: worker processes, environments that the suite makes, and engines of a distribution.

Some engines come with a Linux distribution, for its own Python only. Such an engine is a *server*, which runs in that
Python and imports nothing but NumPy and the engine, and an adapter, which runs here, declares the engine's capabilities
and hands lanes over. A server defines ``versions()`` and ``EngineLane``, as `worker` describes.

An *environment* holds an engine, or a version of one, and what it needs, and nothing of the suite: its worker process
takes the adapter from the suite that started it, and advances lanes there as the adapter does here; see `server`.
"""
