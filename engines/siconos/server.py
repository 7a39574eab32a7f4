"""Siconos, served by `worker` in a Python that has it: Moreau–Jean time stepping, friction as a nonsmooth law.

A run builds its model anew, which takes less than ten steps do: nothing is left of earlier runs.
"""

import functools
import shutil
import subprocess
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
from siconos import kernel, numerics

ALLOWED_RESIDUAL = 1e-6
"""Of Coulomb's law, over the bound: a solver that fails only prints a warning, and Siconos goes on."""

DIVERGED_BEYOND = 1e12
"""Motion, over the displacement scale, beyond which an exception of Siconos is no more than that."""


def versions() -> dict[str, str]:
    """Give the version as Debian numbers it where it is Debian's: its package states that of a later release."""
    query = shutil.which("dpkg-query")
    if query is not None:
        command = [query, "-W", "-f=${Version}", "python3-siconos"]
        debian = subprocess.run(command, capture_output=True, text=True, check=False).stdout
        if debian:
            return {"engine": debian.split("-")[0].split("+")[0]}
    try:
        return {"engine": version("siconos")}
    except PackageNotFoundError:
        return {"engine": "of unknown version"}


class EngineLane:
    """One chain; `parameters` are what `engines.isolated.out_of_process` sends of it, and the options of its preset."""

    def __init__(self, parameters: dict[str, Any]):
        model = ContactModel if str(parameters["formulation"]) == "contact" else JointModel
        self._new_model = functools.partial(model, parameters)

    def run(self, position: Any, velocity: Any, loads: Any, record: bool) -> dict[str, Any]:
        """Advance; gives position, velocity, friction and, for contacts, normal force, one row a step."""
        model = self._new_model(position, velocity, len(loads))
        return model.rows(*model.advance(loads))


class JointModel:
    """Relays between outer and inner masses: an impulse within fixed bounds stops their relative velocity."""

    def __init__(self, given: dict[str, Any], position: Any, velocity: Any, steps: int):
        """Build the model with its initial state, for so many steps."""
        self._given = given
        self._dt = float(given["time_step"])
        self._bound = given["normal"] * given["coefficient"]
        self._cells = len(self._bound)
        self._make_system(position, velocity)
        self._make_stepping(steps)

    def advance(self, loads: Any) -> tuple[Any, Any]:
        """Take a step for every load; gives coordinates and velocities, and impulses, one row a step."""
        compute, advance = self._stepping.computeOneStep, self._stepping.nextStep
        # Views of what Siconos holds; the arrays that it was given are not.
        motion = self._system.q(), self._system.velocity()
        position, velocity = np.empty((2, len(loads), self._system.dimension()))
        impulses = [(interaction.lambda_(1), part) for interaction, part in self._interactions]
        impulse = np.zeros((len(loads), self._impulses))
        step = 0
        try:
            for step, _ in enumerate(self._loaded(loads, *motion)):
                compute()
                advance()
                position[step], velocity[step] = motion
                for current, part in impulses:
                    impulse[step, part] = current
        except Exception:
            limit = DIVERGED_BEYOND * float(self._given["length"])
            if step == 0 or np.max(np.abs(position[step - 1])) < limit:
                raise
            # Where Siconos stops, there the motion ends: its last row is repeated.
            for rows in (position, velocity, impulse):
                rows[step:] = rows[step - 1]
        return (position, velocity), impulse

    def rows(self, motion: Any, impulse: Any) -> dict[str, Any]:
        """Name the rows; impulses become forces."""
        position, velocity = motion
        friction = impulse / self._dt
        if str(self._given["activation"]) == "always":
            self._check(velocity, friction)
        return {"position": position, "velocity": velocity, "friction": friction}

    def _check(self, velocity: Any, friction: Any) -> None:
        """Raise unless every relay obeys Coulomb's law: λ is what λ − ρ ġ_T is when it is cut off at the bound."""
        outer, inner = np.split(velocity[:, : 2 * self._cells], 2, axis=1)
        mass = self._given["mass"][: 2 * self._cells].reshape(2, -1)
        pull = (inner - outer) / (self._dt * np.sum(1 / mass, axis=0))
        excess = np.abs(friction - np.clip(friction - pull, -self._bound, self._bound))
        allowed = ALLOWED_RESIDUAL * self._bound + 1e-9 * np.max(np.abs(pull), initial=0.0)
        wrong = np.argwhere(~(excess <= allowed) & np.isfinite(pull))
        if wrong.size:
            step, cell = wrong[0].tolist()
            raise RuntimeError(
                f"the solver {self._given['solver']} failed: friction of cell {cell + 1} in step {step + 1} breaks "
                f"Coulomb's law by {excess[step, cell] / self._bound[cell]:.2g} of its bound"
            )

    def _loaded(self, loads: Any, position: Any, velocity: Any) -> Iterator[None]:
        """Set the forces of one step after the other."""
        force = self._system.fExt()
        if str(self._given["springs"]) == "own":
            for force[0] in loads.tolist():
                yield
            return
        matrix = -np.hstack([self._given["stiffness"], self._given["damping"]])
        product, now = matrix.dot, np.empty(matrix.shape[1])
        first, second = np.split(now, 2)
        for load in loads.tolist():
            first[:] = position
            second[:] = velocity
            product(now, force)
            force[0] += load
            yield

    def _matrices(self) -> tuple[Any, ...]:
        """Mass, stiffness and damping matrix; the last two are left out where the springs are forces."""
        mass = np.diag(self._given["mass"])
        if str(self._given["springs"]) == "own":
            return mass, self._given["stiffness"], self._given["damping"]
        return (mass,)

    def _make_system(self, position: Any, velocity: Any) -> None:
        """Make the masses and springs, with their state and a force on every coordinate."""
        mass, *others = self._matrices()
        state = np.zeros((2, mass.shape[0]))
        state[:, : len(position)] = position, velocity
        self._system = kernel.LagrangianLinearTIDS(*state, mass, *others)
        self._system.setFExtPtr(np.zeros(mass.shape[0]))

    def _make_stepping(self, steps: int) -> None:
        """Link the frictions to the masses, and make what takes the steps."""
        self._problem = kernel.NonSmoothDynamicalSystem(0.0, (steps + 2) * self._dt)
        self._problem.insertDynamicalSystem(self._system)
        self._impulses = self._cells
        self._interactions = list(self._linked())
        self._integrator = kernel.MoreauJeanOSI(float(self._given["theta"]))
        self._discretisation = kernel.TimeDiscretisation(0.0, self._dt)
        self._solver = self._new_solver()
        self._stepping = kernel.TimeStepping(self._problem, self._discretisation, self._integrator, self._solver)
        if str(self._given["newton"]) == "linear":
            self._stepping.setNewtonOptions(kernel.SICONOS_TS_LINEAR)

    def _linked(self) -> Iterator[tuple[Any, Any]]:
        """Link a relay to every group of contacts; gives it with the contacts whose impulses it holds."""
        always = str(self._given["activation"]) == "always"
        depth = -float(self._given["deep"]) * float(self._given["length"]) if always else 0.0
        for cells in self._groups():
            impulse = float(self._bound[cells[0]]) * self._dt
            direction = np.zeros((len(cells), 2 * self._cells))
            direction[range(len(cells)), cells] = -1.0
            direction[range(len(cells)), cells + self._cells] = 1.0
            relation = kernel.LagrangianLinearTIR(direction, [depth] * len(cells))
            interaction = kernel.Interaction(kernel.RelayNSL(len(cells), -impulse, impulse), relation)
            self._problem.link(interaction, self._system)
            yield interaction, cells

    def _groups(self) -> list[Any]:
        """Contacts that share a relay: each its own, or all of one bound, which takes a quarter of the time."""
        rubbing = np.flatnonzero(self._bound > 0)
        if str(self._given["interactions"]) == "one a contact":
            return np.split(rubbing, range(1, len(rubbing))) if len(rubbing) else []
        return [np.flatnonzero(self._bound == bound) for bound in np.unique(self._bound[rubbing])]

    def _new_solver(self) -> Any:
        return kernel.Relay(getattr(numerics, f"SICONOS_RELAY_{self._given['solver']}"))


class ContactModel(JointModel):
    """Unilateral contacts with friction: every mass has a second coordinate, across, in which it is pressed on."""

    def advance(self, loads: Any) -> tuple[Any, Any]:
        """Press inner on outer masses, and take a step for every load."""
        pressing = np.where(self._bound > 0, self._given["normal"], 0.0)
        self._system.fExt()[2 * self._cells :] = np.concatenate([pressing, -pressing])
        return super().advance(loads)

    def rows(self, motion: Any, impulse: Any) -> dict[str, Any]:
        """Name the rows; motions across are left out, and frictionless cells have the normal load that is given."""
        along = [each[:, : 2 * self._cells] for each in motion]
        normal, friction = np.split(impulse / self._dt, 2, axis=1)
        normal[:, self._bound == 0] = self._given["normal"][self._bound == 0]
        return {"position": along[0], "velocity": along[1], "friction": friction, "normal": normal}

    def _matrices(self) -> tuple[Any, ...]:
        mass, stiffness, damping = super()._matrices()
        along = np.diag([1.0, 0.0])
        return np.kron(np.eye(2), mass), np.kron(along, stiffness), np.kron(along, damping)

    def _make_stepping(self, steps: int) -> None:
        super()._make_stepping(steps)
        self._impulses = 2 * self._cells
        threshold = float(self._given["threshold"]) * float(self._given["length"])
        self._integrator.setConstraintActivationThreshold(threshold)

    def _linked(self) -> Iterator[tuple[Any, Any]]:
        """Link a contact to every cell that rubs; gives it with the places of its two impulses."""
        for cell in np.flatnonzero(self._bound > 0).tolist():
            direction = np.zeros((2, 4 * self._cells))
            for row, outer in enumerate((cell + 2 * self._cells, cell)):
                direction[row, [outer, outer + self._cells]] = -1.0, 1.0
            law = kernel.NewtonImpactFrictionNSL(0.0, 0.0, float(self._given["coefficient"][cell]), 2)
            interaction = kernel.Interaction(law, kernel.LagrangianLinearTIR(direction))
            self._problem.link(interaction, self._system)
            yield interaction, [cell, self._cells + cell]

    def _new_solver(self) -> Any:
        solver = kernel.FrictionContact(2, getattr(numerics, f"SICONOS_FRICTION_2D_{self._given['solver']}"))
        solver.numericsSolverOptions().dparam[numerics.SICONOS_DPARAM_TOL] = float(self._given["tolerance"])
        return solver
