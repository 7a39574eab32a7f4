"""Steps of all worlds at once, compiled by JAX: once for each structure, and number of worlds."""

from typing import Any

import jax
import jax.numpy as jnp
from mujoco import mjx

from engines.shared.worlds import CHUNK

LEAST_BOUND = 1e-300
"""In place of a bound of friction that is zero, for which MJX welds the joint."""


@jax.jit
def recorded_steps(
    model: Any, blank: Any, state: tuple[jax.Array, ...], loads: jax.Array, bounds: jax.Array, count: int
) -> tuple[tuple[jax.Array, ...], tuple[jax.Array, ...]]:
    """Take so many steps, at most `CHUNK`; give the state after them, and `Rows` of them.

    `model` has a row a world in every number, and `blank` is the data of one world; `state` holds positions, velocities
    and the accelerations that the solver begins with, shape (worlds, nv) each; `loads`, shape (`CHUNK`, worlds), are
    controls, and `bounds`, shape (`CHUNK`, worlds, n), those of friction.
    """
    worlds = loads.shape[1]

    def step(index: Any, carried: tuple[Any, ...]) -> tuple[Any, ...]:
        state, rows = carried
        bound = jnp.maximum(bounds[index], LEAST_BOUND)
        frictionloss = model.dof_frictionloss.at[:, 1::2].set(bound)
        state, values = _step(model.replace(dof_frictionloss=frictionloss), blank, state, loads[index])
        return state, tuple(row.at[index].set(value) for row, value in zip(rows, values, strict=True))

    widths = (model.nq, model.nv, model.nv, model.nsensordata)
    rows = tuple(jnp.zeros((CHUNK, worlds, width)) for width in widths)
    return jax.lax.fori_loop(0, count, step, (state, rows))


@jax.jit
def native_steps(model: Any, blank: Any, state: tuple[jax.Array, ...], count: int) -> tuple[jax.Array, ...]:
    """Take steps without loads, and without a record; see `recorded_steps`."""
    no_load = jnp.zeros(len(state[0]))
    return jax.lax.fori_loop(0, count, lambda _, state: _step(model, blank, state, no_load)[0], state)


@jax.jit
def followed(model: Any, data: Any, count: int) -> tuple[Any, jax.Array]:
    """Take so many steps of a scene, at most `CHUNK`; gives its data and the coordinates, a row a step."""

    def step(index: Any, carried: tuple[Any, jax.Array]) -> tuple[Any, jax.Array]:
        data, rows = carried
        data = mjx.step(model, data)
        return data, rows.at[index].set(data.qpos)

    return jax.lax.fori_loop(0, count, step, (data, jnp.zeros((CHUNK, model.nq))))


def _step(model: Any, blank: Any, state: tuple[jax.Array, ...], loads: jax.Array) -> tuple[Any, Any]:
    """Take a step of every world; gives the state after it, and what is recorded of it."""

    def of_world(model: Any, qpos: jax.Array, qvel: jax.Array, qacc: jax.Array, load: jax.Array) -> tuple[Any, Any]:
        data = mjx.step(model, blank.replace(qpos=qpos, qvel=qvel, qacc_warmstart=qacc, ctrl=load[None]))
        state = (data.qpos, data.qvel, data.qacc_warmstart)
        return state, (data.qpos, data.qvel, data.qfrc_constraint, data.sensordata)

    return jax.vmap(of_world)(model, *state, loads)
