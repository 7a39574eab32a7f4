"""Engines that live in another Python: a child process, a protocol, and the lanes that are advanced there.

Some engines come with a Linux distribution, for its own Python only. Such an engine is two files: a *server*,
which runs in that Python and imports nothing but NumPy and the engine, and an adapter, which runs here, says what
the engine can do and hands lanes over. A server defines ``versions()`` and ``Lane``, as `child` describes.
"""
