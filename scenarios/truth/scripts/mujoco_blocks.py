"""Blocks in plain MuJoCo, from 2.3.3 on; the option ``exact`` lets its solver go on until nothing changes."""

import mujoco
from blocks import run

JOINT = """<mujoco><option timestep="{step!r}" gravity="0 0 0"{more}/><worldbody><body>
<joint type="slide" axis="1 0 0" frictionloss="{bound!r}"/><geom type="box" size=".1 .1 .1" mass="{mass!r}"/>
</body></worldbody></mujoco>"""

CONTACT = """<mujoco><option timestep="{step!r}" gravity="0 0 -{gravity!r}"{more}/><worldbody>
<geom type="plane" size="9 9 1" friction="{friction!r} 0 0"/><body pos="0 0 .1"><freejoint/>
<geom type="box" size=".1 .1 .1" mass="{mass!r}" friction="{friction!r} 0 0"/></body></worldbody></mujoco>"""


def loaded(text, block, options):
    more = ' tolerance="0" iterations="1000"' if "exact" in options else ""
    bound = block.friction * block.normal(0)
    model = mujoco.MjModel.from_xml_string(
        text.format(
            step=block.step,
            mass=block.mass,
            friction=block.friction,
            bound=bound,
            gravity=block.gravity,
            more=more,
        )
    )
    return model, mujoco.MjData(model)


def joint(block, options):
    model, data = loaded(JOINT, block, options)
    data.qvel[0] = block.velocity
    for step in range(block.steps):
        model.dof_frictionloss[0] = block.friction * block.normal(step)
        data.qfrc_applied[0] = block.pull(step)
        mujoco.mj_step(model, data)
        yield data.qpos[0], data.qvel[0]


def contact(block, options):
    model, data = loaded(CONTACT, block, options)
    for step in range(-block.settling, block.steps):
        if step == 0:
            begin = data.qpos[0]
            data.qvel[0] = block.velocity
        data.xfrc_applied[1, 0], data.xfrc_applied[1, 2] = block.forces(step)
        mujoco.mj_step(model, data)
        if step >= 0:
            yield data.qpos[0] - begin, data.qvel[0]


run({"joint": joint, "contact": contact})
