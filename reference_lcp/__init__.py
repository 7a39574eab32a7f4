"""The reference: LCP time stepping of the frictional mass-in-mass chain after Sethi, Banerjee and Manna.

What a study of a chain needs is here, each name imported from its folder when it is first used, which spares a command
the compiled solvers that it does not need: `__init__.pyi` says where it is. The rest is in the folders themselves.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
