"""Engines in another Python: worker processes, and engines of a distribution.

Some engines come with a Linux distribution, for its own Python only. Such an engine is a *server*, which runs in that
Python and imports nothing but NumPy and the engine, and an adapter, which runs here, declares the engine's capabilities
and hands lanes over. A server defines ``versions()`` and ``EngineLane``, as `worker` describes.
"""
