"""Pinocchio's joint formulation: a tree of sliders with a friction constraint on the inner ones."""

from collections.abc import Callable
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.coordinates import JointCoordinates
from multibody_xval.engines.shared.force_loop import ExplicitForcesLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


class PinocchioJointLane(ExplicitForcesLane):
    """One chain; data and solver are made anew for a run, so that nothing is left of earlier ones."""

    coordinates = JointCoordinates()

    def __init__(self, lane: Lane, preset: Preset):
        super().__init__(lane, preset)
        self._impulses = np.zeros(lane.chain.cells)
        # The loop gives impulses of a step in place of forces, which saves the multiplications by the time step.
        self._forces *= self._time_step
        self._force_unit = self._units.force / self._time_step

    def _begin(self, motion: FloatArray) -> Step:
        import pinocchio

        model, data, impulses_for = self._solver()
        half = motion.size // 2
        positions, velocities = motion[:half], motion[half:]
        gap_rates = velocities[1::2]
        aba, integrate, add, multiply = pinocchio.aba, pinocchio.integrate, np.add, np.multiply
        # NumPy multiplies by an array in half the time that it takes for a number.
        time_step = np.full(half, self._time_step)
        gaps, move = np.empty(half // 2), np.empty(half)

        def step(force: FloatArray) -> None:
            # Forces are impulses here, and accelerations changes of velocity: parallel sliders have no bias forces.
            add(aba(model, data, positions, velocities, force)[1::2], gap_rates, gaps)
            self._impulses = impulses = impulses_for(gaps)
            friction = force[1::2]
            add(friction, impulses, friction)
            add(velocities, aba(model, data, positions, velocities, force), velocities)
            multiply(velocities, time_step, move)
            positions[:] = integrate(model, positions, move)

        return step

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        import pinocchio

        limits = self._chain.friction_coefficient * normal_load
        self._friction.setFrictionUpperLimit(limits)
        self._friction.setFrictionLowerLimit(-limits)
        # The solver's list holds a copy, and its data what the last calculation has read from it.
        self._models[0] = pinocchio.ConstraintModel(self._friction)
        self._models[0].calc(*self._arguments)

    def _contacts(self) -> FloatArray:
        return self._impulses / self._time_step

    def _solver(self) -> tuple[Any, Any, Callable[[FloatArray], FloatArray]]:
        """Give model, data, and what finds the impulses of friction from the relative velocities without it."""
        import pinocchio

        model, sliders = self._new_model()
        data = model.createData()
        bounds = np.zeros(model.nv)
        bounds[1::2] = self._chain.friction_bound
        friction = pinocchio.JointFrictionConstraintModel(model, sliders, -bounds, bounds)
        # Bounds are forces, and impulses after this only: a constraint's own time step is one.
        friction.setTimeStep(self._time_step)
        models, datas = pinocchio.StdVec_ConstraintModel(), pinocchio.StdVec_ConstraintData()
        models.append(pinocchio.ConstraintModel(friction))
        datas.append(models[0].createData())
        models[0].calc(model, data, datas[0])
        self._friction, self._models, self._arguments = friction, models, (model, data, datas[0])
        # Of parallel sliders, the same in every configuration.
        inverse_mass = np.array(pinocchio.computeMinverse(model, data, np.zeros(model.nq)))
        delassus = pinocchio.DelassusOperatorDense(inverse_mass[1::2, 1::2].copy())
        name = self._preset["solver"]
        settings, result = self._settings(name), getattr(pinocchio, f"{name}SolverResult")()
        solve = getattr(pinocchio, f"{name}ConstraintSolver")(self._chain.cells).solve

        def impulses_for(gaps: FloatArray) -> FloatArray:
            solve(delassus, gaps, models, datas, settings, result)
            impulses: FloatArray = result.retrieveConstraintImpulses()
            return impulses

        return model, data, impulses_for

    def _settings(self, name: str) -> Any:
        import pinocchio

        settings = getattr(pinocchio, f"{name}SolverSettings")()
        settings.max_iterations = self._preset["max_iterations"]
        for kind in ("feasibility", "complementarity"):
            for scale in ("absolute", "relative"):
                setattr(settings, f"{scale}_{kind}_tol", self._preset["tolerance"])
        return settings

    def _new_model(self) -> tuple[Any, Any]:
        """Make the tree, depth first as Pinocchio needs it, and list its inner joints."""
        import pinocchio

        model, sliders = pinocchio.Model(), pinocchio.StdVec_Index()
        here = pinocchio.SE3.Identity()

        def add_slider(carrier: int, name: str, mass: float) -> int:
            joint: int = model.addJoint(carrier, pinocchio.JointModelPX(), here, name)
            model.appendBodyToJoint(joint, pinocchio.Inertia(mass, np.zeros(3), mass * np.eye(3)), here)
            return joint

        masses = zip(self._chain.outer_mass.tolist(), self._chain.inner_mass.tolist(), strict=True)
        for cell, (outer, inner) in enumerate(masses):
            carrier = add_slider(0, f"outer {cell}", outer)
            sliders.append(add_slider(carrier, f"inner {cell}", inner))
        model.gravity.linear = np.zeros(3)
        return model, sliders
