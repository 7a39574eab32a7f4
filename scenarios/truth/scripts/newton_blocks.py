"""A block in plain Newton, by Kamino on the processor, whose step takes 50 ms there: the ``friction`` of its joint."""

import newton
import numpy as np
import warp
from blocks import run

warp.config.quiet = True
NO_GRAVITY = (0.0, 0.0, 0.0) if tuple(map(int, newton.__version__.split(".")[:2])) >= (1, 5) else 0.0


def joint(block, options):
    builder = newton.ModelBuilder(gravity=NO_GRAVITY)
    link = builder.add_link(mass=block.mass, inertia=warp.mat33(np.eye(3, dtype=np.float32)))
    rail = builder.add_joint_prismatic(
        -1, link, axis=newton.Axis.X, limit_lower=-1e9, limit_upper=1e9, armature=0.0, friction=block.bound
    )
    builder.add_articulation([rail])
    model = builder.finalize(device="cpu")
    solver, control = newton.solvers.SolverKamino(model), model.control()
    before, after = model.state(), model.state()
    before.joint_qd.assign(np.array([block.velocity], np.float32))
    newton.eval_fk(model, before.joint_q, before.joint_qd, before)
    for step in range(block.steps):
        before.clear_forces()
        control.joint_f.assign(np.array([block.pull(step)], np.float32))
        solver.step(before, after, control, None, block.step)
        newton.eval_ik(model, after, after.joint_q, after.joint_qd)
        before, after = after, before
        yield before.joint_q.numpy()[0], before.joint_qd.numpy()[0]


run({"joint": joint})
