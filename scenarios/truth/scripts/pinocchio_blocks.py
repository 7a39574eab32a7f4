"""A block in plain Pinocchio, from 4.0 on: a friction constraint of its joint, solved by ADMM."""

import numpy as np
import pinocchio
from blocks import run


def joint(block, options):
    model, here = pinocchio.Model(), pinocchio.SE3.Identity()
    model.gravity.linear = np.zeros(3)
    rail = model.addJoint(0, pinocchio.JointModelPX(), here, "rail")
    model.appendBodyToJoint(rail, pinocchio.Inertia(block.mass, np.zeros(3), np.eye(3)), here)
    data, joints, bound = model.createData(), pinocchio.StdVec_Index(), np.array([block.bound])
    joints.append(rail)
    friction = pinocchio.JointFrictionConstraintModel(model, joints, -bound, bound)
    friction.setTimeStep(block.step)
    models, datas = pinocchio.StdVec_ConstraintModel(), pinocchio.StdVec_ConstraintData()
    models.append(pinocchio.ConstraintModel(friction))
    datas.append(models[0].createData())
    models[0].calc(model, data, datas[0])
    delassus = pinocchio.DelassusOperatorDense(np.array([[1 / block.mass]]))
    solver, settings, result = (
        pinocchio.ADMMConstraintSolver(1),
        pinocchio.ADMMSolverSettings(),
        pinocchio.ADMMSolverResult(),
    )
    if "exact" in options:
        settings.max_iterations = 1000
        settings.absolute_feasibility_tol = settings.relative_feasibility_tol = 1e-14
        settings.absolute_complementarity_tol = settings.relative_complementarity_tol = 1e-14
    position, velocity = 0.0, block.velocity
    for step in range(block.steps):
        impulse = block.step * block.pull(step)
        slip = np.array([velocity + impulse / block.mass])
        solver.solve(delassus, slip, models, datas, settings, result)
        velocity = float(slip[0] + result.retrieveConstraintImpulses()[0] / block.mass)
        position += block.step * velocity
        yield position, velocity


run({"joint": joint})
