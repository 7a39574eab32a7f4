"""Multibody engines that simulate the frictional chain, behind one contract.

Each name is imported on first use, so that a command heeds Ctrl-C before anything is imported.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
