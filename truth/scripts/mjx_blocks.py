"""Blocks in plain MJX, in double precision, from 3.2.3 on; the block on a rail has another beside it that rubs less."""

import jax
import mujoco
import numpy as np
from blocks import run
from mujoco import mjx

jax.config.update("jax_enable_x64", True)

RAIL = """<body pos="0 {place!r} 0"><joint type="slide" axis="1 0 0" frictionloss="{bound!r}"/>
<inertial pos="0 0 0" mass="{mass!r}" diaginertia="1 1 1"/></body>"""

JOINT = """<mujoco><option timestep="{step!r}" gravity="0 0 0"/><worldbody>{rails}</worldbody></mujoco>"""

CONTACT = """<mujoco><option timestep="{step!r}" gravity="0 0 -{gravity!r}"/><worldbody>
<geom type="plane" size="9 9 1" friction="{friction!r} 0 0"/><body pos="0 0 .1"><freejoint/>
<geom type="box" size=".1 .1 .1" mass="{mass!r}" friction="{friction!r} 0 0"/></body></worldbody></mujoco>"""


def joint(block, options):
    rails = RAIL.format(place=0.0, bound=block.bound, mass=block.mass)
    rails += RAIL.format(place=1.0, bound=0.0, mass=block.mass)
    model = mujoco.MjModel.from_xml_string(JOINT.format(step=block.step, rails=rails))
    data = mujoco.MjData(model)
    data.qvel[0] = block.velocity
    step, on_device, state = jax.jit(mjx.step), mjx.put_model(model), mjx.put_data(model, data)
    for number in range(block.steps):
        state = step(on_device, state.replace(qfrc_applied=np.array([block.pull(number), 0.0])))
        yield state.qpos[0], state.qvel[0]


def contact(block, options):
    text = CONTACT.format(step=block.step, gravity=block.gravity, friction=block.friction, mass=block.mass)
    model = mujoco.MjModel.from_xml_string(text)
    step, on_device, state = jax.jit(mjx.step), mjx.put_model(model), mjx.put_data(model, mujoco.MjData(model))
    begin = 0.0
    for number in range(-block.settling, block.steps):
        if number == 0:
            begin = state.qpos[0]
            state = state.replace(qvel=state.qvel.at[0].set(block.velocity))
        along, up = block.forces(number)
        state = step(on_device, state.replace(qfrc_applied=np.array([along, 0.0, up, 0.0, 0.0, 0.0])))
        if number >= 0:
            yield state.qpos[0] - begin, state.qvel[0]


run({"joint": joint, "contact": contact})
