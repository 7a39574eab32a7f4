"""The contract that every engine fulfils."""

import math
import platform
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Protocol, runtime_checkable

from multibody_xval.engines.interface.changed_options import changed_preset
from multibody_xval.engines.interface.presets import Capabilities, Formulation, Preparation, Preset
from multibody_xval.engines.interface.reproducer import Reproducer
from multibody_xval.engines.interface.scene import Scene, SceneBuilder, SceneSetting, SceneWorld, formulation_of
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, Simulation, common_cells
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError, checked_choice

if TYPE_CHECKING:
    from reference_lcp.one_call import SteadyState


STEPS_PER_PERIOD = 400
"""Of the lane by which engines are prepared; those that compile do so whatever its numbers are."""


@runtime_checkable
class SteadyStateSolver(Protocol):
    """A simulation that finds its steady states by itself, and reads them better than from rows of its trajectory."""

    def steady_states(self, steps_per_period: int) -> "list[SteadyState]":
        """Give the steady state of every lane, in order, with a trajectory of so many rows a period."""
        ...


class Engine(ABC):
    """One simulation engine. Importing its module must not import the engine's own package."""

    name: ClassVar[str]
    capabilities: ClassVar[Capabilities]
    preparation: ClassVar[Preparation | None] = None
    """What `prepare` does, where its first use on a machine takes long: compiling, above all."""
    reproducers: ClassVar[Mapping[Formulation, Reproducer]] = {}
    """How a number of it is shown without the suite, by formulation; none is needed."""
    scene_step: ClassVar[float] = math.nan
    """Time step that its users take where they choose none [s]: its own default."""
    scene_worlds: ClassVar[Mapping[Formulation, SceneBuilder]] = {}
    """What builds scenes as its users write them, by the formulation of the friction; none is needed."""
    scene_shakers: ClassVar[bool] = False
    """Whether boxes of scenes may have a `Shaker`."""
    no_scenes: ClassVar[str] = "its adapter builds none"
    """Why there are no scenes of a formulation that is not in `scene_worlds`."""

    @abstractmethod
    def version(self) -> str:
        """Version of the engine that is installed."""

    def python(self) -> str:
        """Version of the Python that the engine runs in; adapters override it where that is not this one."""
        return platform.python_version()

    @abstractmethod
    def unavailable_reason(self) -> str | None:
        """Reason in a sentence why the engine cannot be used here; ``None`` if it can."""

    @abstractmethod
    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        """Build the lanes; the arguments are checked already."""

    def preset(self, formulation: str, preset: str) -> Preset:
        """Give a preset by name; options that follow it as ``:NAME=VALUE`` are changed.

        Raises
        ------
        ParameterError
            If the engine has no such formulation, preset or option, or a value is not what the option takes.
        """
        by_formulation = self.capabilities.presets
        checked_choice(f"formulation of {self.name}", formulation, [str(name) for name in by_formulation])
        presets = by_formulation[Formulation(formulation)]
        name, *settings = preset.split(":")
        checked_choice(f"preset of {self.name}", name, list(presets))
        if not settings:
            return presets[name]
        every = [each for group in by_formulation.values() for each in group.values()]
        installed = presets.get("default", presets[name])
        return changed_preset(presets[name], settings, every, installed, f"{self.name}:{formulation}:{name}")

    def prepare(self, cells: int, formulation: str, preset: str) -> None:
        """Do what `preparation` names, for chains of this length: build a lane, and take a step.

        Workers of engines that name a preparation call this before their first batch of a variant.
        """
        simulation = self.build([sample_lane(cells)], formulation, preset)
        try:
            simulation.advance(State.at_rest(1, cells), 0, 1)
        finally:
            simulation.close()

    def build(self, lanes: Sequence[Lane], formulation: str = "joint", preset: str = "tuned") -> Simulation:
        """Build every lane in the engine.

        Parameters
        ----------
        lanes
            At least one; all chains have the same number of cells.
        formulation, preset
            Names that the engine's capabilities list.

        Raises
        ------
        ParameterError
            If lanes, formulation or preset are not what the engine takes; for one, if a normal force changes in time
            and the preset cannot represent that.
        EngineNotInstalled
            If the engine cannot be used on this machine.
        """
        chosen = self.preset(formulation, preset)
        common_cells(lanes)
        for lane in lanes:
            unsupported = chosen.unsupported_reason(lane, f"{self.name}:{formulation}:{preset}")
            if unsupported is not None:
                raise ParameterError(unsupported)
        missing = self.unavailable_reason()
        if missing is not None:
            raise EngineNotInstalled(f"{self.name}: {missing}")
        return self._build(tuple(map(chosen.pressed, lanes)), Formulation(formulation), chosen)

    def scene_gap(self, formulation: Formulation) -> str | None:
        """Give the reason why there are no scenes of a formulation; ``None`` if there are."""
        return None if formulation in self.scene_worlds else f"no scenes of {self.name}:{formulation}: {self.no_scenes}"

    def scene_world(self, scene: Scene, setting: SceneSetting) -> SceneWorld:
        """Build a scene as users of the engine do.

        Raises
        ------
        ParameterError
            If the engine has no scenes of its kind, or cannot represent this one.
        """
        gap = self.scene_gap(formulation_of(scene))
        if gap is not None:
            raise ParameterError(gap)
        return self._scene(scene, setting)

    def _scene(self, scene: Scene, setting: SceneSetting) -> SceneWorld:
        """Build a scene of a kind that the engine has."""
        return self.scene_worlds[formulation_of(scene)](scene, setting)


class EngineNotInstalled(RuntimeError):
    """The engine's own package is missing; the message names it and the reason."""


def sample_lane(cells: int) -> Lane:
    """Give a lane of so many cells of the canonical chain, that slip and stick."""
    chain = Chain.from_ratios(cells=cells, friction_ratio=0.3)
    drive = HarmonicBase.from_ratio(chain, 0.9)
    return Lane(chain, drive, drive.period / STEPS_PER_PERIOD)
