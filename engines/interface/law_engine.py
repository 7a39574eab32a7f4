"""The laws of an engine's presets as an engine of their own, so that whatever runs engines runs their predictions."""

from collections.abc import Mapping
from dataclasses import replace

from engines.interface.engine import Engine
from engines.interface.law import Law
from engines.interface.presets import Capabilities, Formulation, NormalForce, Preset
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.steady.limits import DEFAULT_RESIDUAL

LAW_SUFFIX = "@law"
"""What follows the name of an engine to name the model of its laws."""

BATCH_LANES = 16
"""Lanes of a batch: they are advanced one after the other, and cost the same alone."""

SPLIT_TOLERANCE = 1e-12
"""Largest difference between one run and the same run split in two, over the displacement scale: round-off, unless the
engine itself does not begin where it ended."""


class LawEngine(Engine):
    """The models of an engine's presets, under their own names; presets without a model are left out.

    Parameters
    ----------
    modelled
        The engine; its package need not be installed.
    version
        Of the suite, whose models they are.
    """

    def __init__(self, modelled: Engine, version: str):
        self.name = f"{modelled.name}{LAW_SUFFIX}"  # type: ignore[misc]
        self.capabilities = _capabilities(modelled.capabilities)  # type: ignore[misc]
        self._version = version

    def version(self) -> str:
        """Version of the suite."""
        return self._version

    @property
    def host(self) -> str:
        """The reference, which is the suite's own code as well."""
        return "reference"

    def unavailable_reason(self) -> str | None:
        """``None``: models need nothing but the suite."""
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        law = law_of(preset)
        assert law is not None, "presets without a law are not listed"
        return law.build(lanes)


def law_of(preset: Preset) -> Law | None:
    """Give the model of a preset; ``None`` where it has none."""
    law = preset.stated_law()
    return law if isinstance(law, Law) else None


def _capabilities(modelled: Capabilities) -> Capabilities:
    """Give what the models of an engine can do; a formulation without any is none of theirs."""
    modelled_presets = {formulation: _presets(presets) for formulation, presets in modelled.presets.items()}
    return replace(
        modelled,
        title=f"{modelled.title}'s law",
        presets={formulation: presets for formulation, presets in modelled_presets.items() if presets},
        batch_lanes=BATCH_LANES,
        precision="double",
        residual=DEFAULT_RESIDUAL,
        deterministic=True,
        optional=True,
    )


def _presets(presets: Mapping[str, Preset]) -> dict[str, Preset]:
    """Give the presets that have a model; its constants come from the options that they keep.

    Where a preset has one for inclined contacts alone, that is the model.
    """
    presets = {name: _inclined(preset) for name, preset in presets.items()}
    laws = {name: law_of(preset) for name, preset in presets.items()}
    return {
        name: replace(
            presets[name],
            split_tolerance=max(SPLIT_TOLERANCE, presets[name].split_tolerance),
            known_deviation="",
            normal_force=_normal_force(law),
            modulated_options={},
            batch_lanes=None,
            versions="",
            inclines=law.inclines,
            static_friction=False,
        )
        for name, law in laws.items()
        if law is not None
    }


def _inclined(preset: Preset) -> Preset:
    """Give a preset with its law for inclined contacts, and the options there, if it has one."""
    if preset.inclined_law is None:
        return preset
    return replace(preset.modulated(), law=preset.inclined_law, shares_scheme=False)


def _normal_force(law: Law) -> NormalForce:
    """Give how the normal force may change, that a law holds."""
    if law.lifting:
        return NormalForce.LIFTING
    return NormalForce.MODULATED if law.modulated else NormalForce.CONSTANT
