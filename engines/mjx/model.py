"""Models of lanes as one model of MJX, in which each world has its own numbers."""

from collections.abc import Sequence
from typing import Any

import numpy as np

SIZES = (1, 8, 64)
"""Numbers of worlds for which steps are compiled; fewer are filled up, and above the last its multiples are taken.

Compiling takes seconds for every size, and the lanes of a search for steady states become fewer one by one.
"""


def size_of(worlds: int) -> int:
    """Give the number of worlds that is compiled for, to hold so many."""
    return next((size for size in SIZES if size >= worlds), -(-worlds // SIZES[-1]) * SIZES[-1])


def batched_model(models: Sequence[Any]) -> tuple[Any, Any]:
    """Give one model in which every number has a row a world, filled up with the last one, and data of one world.

    Whatever the numbers, models of one structure share what has been compiled for any of them.
    """
    import jax
    from mujoco import mjx

    put = [_model(model) for model in models]
    put += put[-1:] * (size_of(len(models)) - len(models))
    columns = zip(*(jax.tree.leaves(each) for each in put), strict=True)
    rows = [jax.device_put(np.stack(column)) for column in columns]
    return jax.tree.unflatten(jax.tree.structure(put[0]), rows), mjx.make_data(put[0])


def _model(model: Any) -> Any:
    """Put a model into MJX: all inner masses have friction, be it none now and then; nothing but arrays differs."""
    from mujoco import mjx

    rubs = np.zeros(model.nv, dtype=bool)
    rubs[1::2] = True
    # Sizes of geometries beside height fields, of which there are none, would be a part of the structure.
    no_sizes = np.zeros(model.ngeom)
    return mjx.put_model(model).tree_replace({"_impl.dof_hasfrictionloss": rubs, "_impl.geom_rbound_hfield": no_sizes})
