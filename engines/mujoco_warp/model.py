"""Models of lanes as one model of MuJoCo Warp, in which each world has its own numbers."""

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from engines.interface.presets import Option

TUNED_OPTIONS = {
    "units": Option("lane", "SI", "Numbers near one, of which single precision keeps seven digits."),
    "solver": Option("Newton", "Newton", "MuJoCo Warp has no dual solver but the sweep after it."),
    "iterations": Option(1, 100, "The sweep after it decides what friction is."),
    "noslip_iterations": Option(
        1, 0, "One sweep without softness: frictions do not touch each other's masses, so that it is exact."
    ),
    "jacobian": Option("auto", "auto", "MuJoCo Warp takes no dense matrices above 60 degrees of freedom."),
    "integrator": Option("Euler", "Euler", "Velocities first, then positions, as equation (5)."),
    "disable": Option(
        ("eulerdamp", "warmstart", "island"),
        (),
        "Damping at the start of the step; no warm start; no search for islands.",
    ),
}
"""Options of the whole model that the tuned presets of both formulations share."""


def batched_model(models: Sequence[Any]) -> Any:
    """Give one model for MuJoCo Warp, with a row a world of friction bounds, and of whatever differs between models."""
    import mujoco_warp
    import warp

    differing = {field.name for field in dataclasses.fields(mujoco_warp.Model) if _differs(models, field.name)}
    names = sorted(differing | {"dof_frictionloss"})
    batched = mujoco_warp.put_model(models[0], batch_sizes=dict.fromkeys(names, len(models)))
    for name in names:
        rows = getattr(batched, name)
        rows.assign(np.stack([getattr(model, name) for model in models]).reshape(rows.numpy().shape))
    batched.opt.timestep = warp.array([model.opt.timestep for model in models], dtype=float)
    batched.opt.warn_overflow = 0  # a solver that ends at its last iteration says so on standard output
    return batched


def _differs(models: Sequence[Any], name: str) -> bool:
    """Whether a field of MuJoCo's model is an array that differs between the models."""
    first = getattr(models[0], name, None)
    return isinstance(first, np.ndarray) and any(not np.array_equal(first, getattr(model, name)) for model in models)
