"""Engines with one fault each, made from a sound one: the scheme of equation (5) in NumPy."""

import dataclasses

import numpy as np

from multibody_xval.engines import Capabilities, Engine, Formulation, FrictionLaw, NormalForce, Option, Preset
from reference_lcp import HarmonicBase, State, StillBase, Trajectory
from reference_lcp.chain.preload import normal_motion
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation

PRESETS = {
    "tuned": Preset("The scheme.", {}, shares_scheme=True, normal_force=NormalForce.LIFTING),
    "default": Preset("The scheme, with friction that stops a contact in four steps.", {}),
}


class Lane(LaneModel):
    """One chain; every fault overrides the part it breaks."""

    stopping = 1.0

    def __init__(self, lane, preset):
        self.lane = lane
        self.chain = lane.chain
        self.mass = np.diag(lane.chain.mass_matrix)
        self.reduced_mass = 1 / (1 / lane.chain.outer_mass + 1 / lane.chain.inner_mass)
        self.stiffness = lane.chain.stiffness_matrix
        self.bound = lane.chain.friction_bound
        if preset is PRESETS["default"]:
            self.stopping = 0.25

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`."""
        rows = []
        x, v = state.positions[0].copy(), state.velocities[0].copy()
        normal = self.across(state, self.lane.preloads(start, steps))
        for load, force in zip(self.lane.loads(start, steps), normal.normal_force, strict=True):
            if self.lane.preload is not None:
                self.bound = self.chain.friction_coefficient * force
            x, v, friction = self.step(x, v, load)
            rows.append((x, v, friction))
        positions, velocities, friction = (np.array(column) for column in zip(*rows, strict=True))
        internal_state = np.concatenate([normal.gap[-1], normal.speed])
        own = (internal_state, normal.gap) if self.lane.opens else (None, None)
        return Trajectory(self.lane.times(start, steps), positions, velocities, friction, normal.normal_force, *own)

    def across(self, state, normal_load):
        """Press and fly."""
        gap, speed = state.normal_state(self.chain.cells)
        return normal_motion(normal_load, self.chain.inner_mass, self.lane.time_step, gap[0], speed[0])

    def step(self, x, v, load):
        """Velocities first, then positions."""
        v, friction = self.velocity_after(x, v, load)
        return x + self.lane.time_step * v, v, friction

    def velocity_after(self, x, v, load):
        """Equation (5), with the closed solution of each cell's contact."""
        dt = self.lane.time_step
        force = -self.stiffness @ x - self.chain.damping_matrix @ v
        force[0] += load
        free = v + dt * force / self.mass
        friction = self.friction(self.chain.contact_directions.T @ free)
        return free + dt * (self.chain.contact_directions @ friction) / self.mass, friction

    def friction(self, slip):
        """Stop the slip, within the bound."""
        stop = -self.stopping * self.reduced_mass * slip / self.lane.time_step
        return np.minimum(np.maximum(stop, -self.bound), self.bound)  # half the time of np.clip, step by step


class Faulty(Engine):
    """The sound one."""

    name = "faulty-sound"
    capabilities = Capabilities(
        title="Sound", package="faulty-engines", licence="MIT", friction_law=FrictionLaw.COULOMB,
        presets={Formulation.JOINT: PRESETS},
    )  # fmt: skip
    lane_model = Lane

    def version(self) -> str:
        """Version of the package."""
        return "1.0.0"

    def unavailable_reason(self) -> str | None:
        """It needs nothing but NumPy."""
        return None

    def _build(self, lanes, formulation, preset):
        return SequentialSimulation([self.lane_model(lane, preset) for lane in lanes])


class Forgets(Faulty):
    """The first step of a run has no friction: two halves are not the whole."""

    name = "faulty-forgets"

    class lane_model(Lane):  # noqa: N801
        first = False

        def run(self, state, start, steps):
            self.first = True
            return super().run(state, start, steps)

        def friction(self, slip):
            first, self.first = self.first, False
            return 0 * slip if first else super().friction(slip)


class Remembers(Faulty):
    """Something of the last run is left in the next."""

    name = "faulty-remembers"

    class lane_model(Lane):  # noqa: N801
        left = 0.0

        def run(self, state, start, steps):
            found = super().run(dataclasses.replace(state, velocities=state.velocities + self.left), start, steps)
            self.left = 1e-12 * found.velocities[-1, 0]
            return found


class Crosstalk(Faulty):
    """Lanes of one batch feel each other."""

    name = "faulty-crosstalk"

    def _build(self, lanes, formulation, preset):
        simulation = super()._build(lanes, formulation, preset)
        alone = simulation.run

        def run(state, start, steps):
            felt = np.mean(state.positions, axis=0) - state.positions
            return alone(dataclasses.replace(state, positions=state.positions + 1e-9 * felt), start, steps)

        simulation.run = run
        return simulation


class StopsShort(Faulty):
    """`advance` leaves out the last step."""

    name = "faulty-short"

    class lane_model(Lane):  # noqa: N801
        def advance(self, state, start, steps):
            return super().advance(state, start, max(steps - 1, 1))


class NotANumber(Faulty):
    """Velocities are NaN while the base pushes."""

    name = "faulty-nan"

    class lane_model(Lane):  # noqa: N801
        def step(self, x, v, load):
            x, v, friction = super().step(x, v, load)
            return x, np.where(load > 0, np.nan, v), friction


class Unsteady(Faulty):
    """Velocities are NaN in one run of a hundred, drawn by chance."""

    name = "faulty-unsteady"

    class lane_model(Lane):  # noqa: N801
        chance = np.random.default_rng(7)

        def run(self, state, start, steps):
            found = super().run(state, start, steps)
            if self.chance.random() < 0.01:
                found.velocities[-1] = np.nan
            return found


class Raises(Faulty):
    """Raises an error in every run."""

    name = "faulty-raises"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            raise RuntimeError("no solution")


class PressesHarder(Faulty):
    """The normal force grows with the slip."""

    name = "faulty-presses"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            found = super().run(state, start, steps)
            return dataclasses.replace(found, normal_force=found.normal_force * (1 + np.abs(found.relative_velocity)))


class RubsEverywhere(Faulty):
    """Cells without friction have some."""

    name = "faulty-rubs"

    class lane_model(Lane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            self.bound = np.maximum(self.bound, 1e-3 * np.max(self.bound))


class RubsFaintly(Faulty):
    """Friction is never less than a tenth of a newton, where there is any."""

    name = "faulty-floor"

    class lane_model(Lane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            self.bound = np.where(self.bound > 0, np.maximum(self.bound, 0.1), 0.0)


class PassesTheBound(Faulty):
    """Reported friction passes its bound by a thousandth."""

    name = "faulty-bound"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            found = super().run(state, start, steps)
            return dataclasses.replace(found, friction=1.001 * found.friction)


class WrongSign(Faulty):
    """Friction is reported as it acts on the outer mass."""

    name = "faulty-sign"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            found = super().run(state, start, steps)
            return dataclasses.replace(found, friction=-found.friction)


class ReportsHalf(Faulty):
    """Only half of the friction that acts is reported."""

    name = "faulty-momentum"

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            found = super().run(state, start, steps)
            return dataclasses.replace(found, friction=0.5 * found.friction)


class MakesEnergy(Faulty):
    """Every step makes the motion faster."""

    name = "faulty-energy"

    class lane_model(Lane):  # noqa: N801
        def step(self, x, v, load):
            x, v, friction = super().step(x, v, load)
            return x, 1.005 * v, friction


class SoftSprings(Faulty):
    """Springs are too soft by a twentieth."""

    name = "faulty-spring"

    class lane_model(Lane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            self.stiffness = 0.95 * self.stiffness


class Creeps(Faulty):
    """Stuck contacts creep: a twentieth of the friction that would stop them."""

    name = "faulty-creep"

    class lane_model(Lane):  # noqa: N801
        stopping = 0.002


class DriftsApart(Faulty):
    """Friction drives a fast slip: no longer monotone."""

    name = "faulty-drift"

    class lane_model(Lane):  # noqa: N801
        def friction(self, slip):
            return np.where(np.abs(slip) > 0.02, -1.0, 1.0) * super().friction(slip)


class RubsHarder(Faulty):
    """The coefficient of friction is too large by a twentieth, and the report hides it."""

    name = "faulty-coefficient"

    class lane_model(Lane):  # noqa: N801
        def friction(self, slip):
            return 1.05 * super().friction(slip)


class PositionsFirst(Faulty):
    """Positions move before velocities do: another scheme of the same order."""

    name = "faulty-order"

    class lane_model(Lane):  # noqa: N801
        def step(self, x, v, load):
            x = x + self.lane.time_step * v
            v, friction = self.velocity_after(x, v, load)
            return x, v, friction


class AllCellsAlike(Faulty):
    """Every mass is taken for the mean of all: no fault of a chain of equal masses."""

    name = "faulty-alike"

    class lane_model(Lane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            self.mass = np.full_like(self.mass, np.mean(self.mass))


class KnowsOnlySines(Faulty):
    """Whatever moves the base is taken for a sine at the resonator's frequency."""

    name = "faulty-drive"

    class lane_model(Lane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            if not isinstance(lane.drive, HarmonicBase | StillBase):
                scale = lane.drive.displacement_scale(lane.chain)
                self.lane = dataclasses.replace(lane, drive=HarmonicBase(scale, lane.chain.resonator_frequency))


class AnotherDefault(Faulty):
    """The springs of its default are given in kilogram-force a millimetre, taken for newtons a metre."""

    name = "faulty-default"

    class lane_model(Lane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            if preset is PRESETS["default"]:
                self.stiffness = 1000 / 9.81 * self.stiffness


class GivesNoReason(Faulty):
    """An option is set without a reason."""

    name = "faulty-silent"
    capabilities = dataclasses.replace(
        Faulty.capabilities, presets={Formulation.JOINT: {"tuned": Preset("The scheme.", {"gain": Option(1, 0, "")})}}
    )


class TakesEverything(Faulty):
    """It builds whatever formulation and preset it is asked for."""

    name = "faulty-takes"

    def build(self, lanes, formulation="joint", preset="tuned"):
        """Build the tuned joint."""
        return self._build(lanes, Formulation.JOINT, PRESETS["tuned"])


class TakesEveryShape(Faulty):
    """It runs whatever state it is given."""

    name = "faulty-shapes"

    def _build(self, lanes, formulation, preset):
        simulation = super()._build(lanes, formulation, preset)
        simulation.run = lambda _state, start, steps: [
            model.run(State.at_rest(1, 7), start, steps) for model in simulation.models
        ]
        return simulation


class FollowsLate(Faulty):
    """Friction follows the normal force a step late."""

    name = "faulty-late"

    class lane_model(Lane):  # noqa: N801
        def friction(self, slip):
            late, self.last = getattr(self, "last", self.bound), self.bound
            stop = -self.stopping * self.reduced_mass * slip / self.lane.time_step
            return np.clip(stop, -late, late)


class KeepsItsBound(Faulty):
    """The normal force changes, the bound of friction does not."""

    name = "faulty-rigid"

    class lane_model(Lane):  # noqa: N801
        def friction(self, slip):
            self.bound = self.chain.friction_bound
            return super().friction(slip)


class NeverFlies(Faulty):
    """A contact is closed again as soon as it is pressed, wherever the masses are."""

    name = "faulty-grounded"

    class lane_model(Lane):  # noqa: N801
        def across(self, state, normal_load):
            return dataclasses.replace(super().across(state, normal_load), normal_force=np.maximum(normal_load, 0.0))


class LandsBetweenRuns(Faulty):
    """A run begins with closed contacts, whatever the state says."""

    name = "faulty-lands"

    class lane_model(Lane):  # noqa: N801
        def across(self, state, normal_load):
            return super().across(dataclasses.replace(state, internal_state=None), normal_load)


class KnowsItsUnits(Faulty):
    """Positions are stored to a hundredth of a femtometre."""

    name = "faulty-units"

    class lane_model(Lane):  # noqa: N801
        def step(self, x, v, load):
            x, v, friction = super().step(x, v, load)
            return 1e-17 * np.rint(x / 1e-17), v, friction


class NeverSlippery(Faulty):
    """Coefficients of friction are at least a twentieth."""

    name = "faulty-slippery"

    class lane_model(Lane):  # noqa: N801
        def __init__(self, lane, preset):
            super().__init__(lane, preset)
            self.bound = np.maximum(lane.chain.friction_coefficient, 0.05) * lane.chain.normal_force


class CutsOff(Faulty):
    """Masses are never faster than fifty times the drive."""

    name = "faulty-cuts"

    class lane_model(Lane):  # noqa: N801
        def velocity_after(self, x, v, load):
            v, friction = super().velocity_after(x, v, load)
            limit = 50 * self.lane.drive.displacement_scale(self.chain) * self.chain.resonator_frequency
            return np.clip(v, -limit, limit), friction


class Pushes(Faulty):
    """The first spring is longer than its place, by 1e-13 of the displacement scale."""

    name = "faulty-pushes"

    class lane_model(Lane):  # noqa: N801
        def step(self, x, v, load):
            scale = self.lane.drive.displacement_scale(self.chain)
            return super().step(x, v, load + 1e-13 * scale * self.stiffness[0, 0])


class RoundsEveryRun(Faulty):
    """Every run begins half of what two halves may differ by beside its state."""

    name = "faulty-rounds"
    capabilities = dataclasses.replace(
        Faulty.capabilities,
        presets={Formulation.JOINT: {"tuned": dataclasses.replace(PRESETS["tuned"], split_tolerance=1e-12)}},
    )

    class lane_model(Lane):  # noqa: N801
        def run(self, state, start, steps):
            shift = 5e-13 * self.lane.drive.displacement_scale(self.chain)
            return super().run(dataclasses.replace(state, positions=state.positions + shift), start, steps)


class NamedWithASign(Faulty):
    """Sound, with a name that means something else where a regular expression is read."""

    name = "mine+fast"
