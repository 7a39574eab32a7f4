"""A stand-alone script for one number of a configuration: the engine's own part, set into what all scripts share."""

import math
import textwrap
from collections.abc import Mapping
from importlib import import_module
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

from jinja2 import ChoiceLoader, DictLoader, Environment, PackageLoader

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.reproducer import Reproducer
from multibody_xval.engines.interface.texts import shortened, visible
from multibody_xval.engines.isolated.out_of_process import OutOfProcessEngine
from multibody_xval.reports.formatting import environment
from multibody_xval.reports.reproducers.questions import FROM_REST, PERIODS, Number, Reproduction, reproduction
from multibody_xval.reports.reproducers.scene_lines import scene_lines
from multibody_xval.reports.reproducers.specialise import NotWritable
from multibody_xval.scenarios.cases.carrier_drives import GrowingAcceleration, Vibration
from multibody_xval.scenarios.cases.motions import BlockMotion, Motion
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.blocks import breakaway, published, static_friction
from multibody_xval.scenarios.compute.motions import is_pressed
from multibody_xval.scenarios.compute.scenes import unsupported_reason
from multibody_xval.scenarios.model import AnyCase, Config, Run
from reference_lcp.chain.drives import Drive, HarmonicBase, HarmonicForce, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

LONGEST_LINE = 128
"""Characters, where numbers of many digits stand in a line."""

WIDTH = 116
"""Characters a line of the header has at most."""

LONGEST_PARAGRAPH = 800
"""Characters of a paragraph of the header: versions are texts of others."""


def checked(name: str, scenario: str, case: str | None = None) -> Reproduction:
    """Check what is to be shown, before any work."""
    shown = reproduction(name, scenario, case)
    if not isinstance(shown.run.case, SceneMotion):
        reproducer_of(shown.run.config)
        if (reason := shown.run.config.preset.unsupported_reason(_lane(shown.run), str(shown.run.config))) is not None:
            raise ParameterError(reason)
    elif (reason := unsupported_reason(shown.run.config, shown.run.case.scene)) is not None:
        raise ParameterError(reason)
    else:
        _check_written(shown)
    return shown


def _check_written(shown: Reproduction) -> None:
    """Refuse a scene that an adapter builds in a way that cannot be written as a script, with the reason."""
    try:
        scene_lines(shown, Number(math.nan, 0.0))
    except NotWritable as reason:
        raise ParameterError(f"{shown.run.config} has no script of {shown.scenario.name}: {reason}") from None


def reproducer_of(config: Config) -> Reproducer:
    """Give how a configuration is written as a script."""
    reproducer = engine(config.engine).reproducers.get(Formulation(config.formulation))
    if reproducer is None or config.preset_name in reproducer.without or config.preset.settings:
        allowed = ", ".join(f"{name}:{own}" for name in engine_names() for own in engine(name).reproducers)
        raise ParameterError(f"{config} has no reproducer; allowed: {allowed}")
    return reproducer


def script(shown: Reproduction, number: Number) -> str:
    """Write the script of one number; the suite's own is in its header."""
    if isinstance(shown.run.case, SceneMotion):
        return f'"""{header(shown, number)}\n"""\n\n{scene_lines(shown, number).rstrip()}\n'
    return _lane_script(shown, number)


def _lane_script(shown: Reproduction, number: Number) -> str:
    """Write the script of a chain or a block."""
    run, case, quantity = shown.run, shown.run.of(Motion), shown.quantity
    reproducer, preset = reproducer_of(run.config), run.config.preset
    lane, start = _lane(run), case.initial_state()
    units = preset.options.get("units")
    converted = units is not None and units.value != "SI" and not reproducer.own_units
    protocol = f", the last of {PERIODS} periods from rest" if quantity is FROM_REST else ""
    templates = _templates(engine(run.config.engine), reproducer.template)
    reading = templates.get_template(f"{quantity.name}.py.jinja")
    text = templates.get_template("engine").render(
        header=header(shown, number, protocol, "Here in SI units, there in its own." if converted else ""),
        lists=_lists(lane.chain, start, lane.time_step, run.steps),
        load=load_lines(lane.drive),
        reading=reading.render(
            case=case,
            steps=run.steps,
            periods=PERIODS,
            breakaway=breakaway,
            static_friction=static_friction,
            over=number.over,
            **_published(run.case),
        ).rstrip(),
        metric=quantity.name,
        unit=f" {quantity.unit}" if quantity.unit else "",
        exact=_short(number.exact),
        static_ratio=lane.static_ratio,
        **reproducer.numbers(lane, preset, start),
    )
    return text.rstrip() + "\n"


def _lane(run: Run) -> Lane:
    return run.of(Motion).lane(run.steps, pressed=is_pressed(run))


def _published(case: AnyCase) -> Mapping[str, Any]:
    """Give what a published number is given over, and how it is read of a slip."""
    if not isinstance(case, BlockMotion) or case not in published.NUMBERS:
        return {}
    own = published.NUMBERS[case]
    factor = published.ALONG if own.name.startswith("sdnd100") else 1.0
    ahead = published.BEFORE_BRAKING if own is published.BRAKE else 0.0
    rows = [round(time / case.time * own.steps) for time in (published.WEAR_FROM, published.WEAR_TO)]
    wear = own.name.startswith("sdnd104")
    return {"wear": wear, "rows": rows, "factor": factor, "ahead": ahead, "of": repr(own.over),
            "force": published.WEAR_FORCE, "seconds": published.WEAR_TO - published.WEAR_FROM}  # fmt: skip


def _templates(adapter: Engine, template: str) -> Environment:
    """Give the template of the engine, those that all scripts share, and those of other engines by their folders."""
    own = DictLoader({"engine": beside(adapter, template).read_text(encoding="utf-8")})
    shared, others = PackageLoader("multibody_xval.reports.reproducers"), PackageLoader("multibody_xval.engines", "")
    templates = environment(markup=False)
    templates.loader = ChoiceLoader([own, shared, others])
    templates.filters["listed"] = _list
    return templates


def beside(adapter: Engine, name: str) -> Traversable:
    """Give a file beside an adapter, which need not be there."""
    return files(str(import_module(type(adapter).__module__).__package__)).joinpath(name)


def header(shown: Reproduction, number: Number, protocol: str = "", units: str = "") -> str:
    """Say what is asked, of what, what is exact and what the suite has; and what the script does otherwise."""
    config, quantity = shown.run.config, shown.quantity
    adapter, unit = engine(config.engine), f" {quantity.unit}" if quantity.unit else ""
    version = "" if adapter.unavailable_reason() is not None else f" {adapter.version()}"
    value = f"{_short(number.value)}{unit}" if math.isfinite(number.value) else "no number"
    told = (
        f"{config.formulation}, {config.preset_name}: {config.preset.description} "
        f"{shown.scenario.name}: {shown.case}{protocol}. "
        f"Exact: {_short(number.exact)}{unit}; the cross-validation suite has {value}. {units}"
    )
    if isinstance(adapter, OutOfProcessEngine):
        told += f" Run it with the system's Python, /usr/bin/python3 (apt install {adapter.capabilities.package})."
    return docstring(f"{adapter.capabilities.title}{version}: {shown.scenario.question}", told)


def docstring(*paragraphs: str) -> str:
    """Give paragraphs as the inside of a docstring, which nothing that stands in them ends."""
    wrapped = (textwrap.wrap(shortened(_line(text), LONGEST_PARAGRAPH), WIDTH) for text in paragraphs)
    return "\n\n".join(map("\n".join, wrapped)).replace("\\", "\\\\").replace('"""', r"\"\"\"")


def _line(text: str) -> str:
    return visible(" ".join(text.split()))


def _short(value: float) -> str:
    return f"{value:.6g}"


def _lists(chain: Chain, start: State, time_step: float, steps: int) -> str:
    """Write the chain, one number a cell, its initial state and its steps."""
    rows = (
        ("OUTER_MASS, INNER_MASS", "kg", (chain.outer_mass, chain.inner_mass)),
        ("CHAIN_STIFFNESS, INNER_STIFFNESS", "N/m", (chain.chain_stiffness, chain.inner_stiffness)),
        ("CHAIN_DAMPING, INNER_DAMPING", "N s/m", (chain.chain_damping, chain.inner_damping)),
        ("NORMAL_FORCE, FRICTION", "N, 1", (chain.normal_force, chain.friction_coefficient)),
        (
            "POSITION, VELOCITY",
            "m, m/s, of outer masses, then of inner ones",
            (start.positions[0], start.velocities[0]),
        ),
    )
    lines = [f"{names} = {', '.join(_list(values) for values in lists)}  # {unit}" for names, unit, lists in rows]
    return "\n".join([*lines, f"TIME_STEP, STEPS = {time_step!r}, {steps}  # s"])


def _list(values: FloatArray) -> str:
    """Write numbers as a list, short where all are equal."""
    numbers = [float(value) for value in values]
    return f"[{numbers[0]!r}] * {len(numbers)}" if len(numbers) > 2 and len(set(numbers)) == 1 else repr(numbers)


def load_lines(drive: Drive) -> list[str]:
    """Write what a function does that gives the load on the first outer mass at a time t: what moves the base, or 0."""
    match drive:
        case StillBase():
            return ["return 0.0"]
        case HarmonicForce(amplitude=force, angular_frequency=omega):
            return [f"return {force!r} * np.sin({omega!r} * t)"]
        case HarmonicBase(amplitude=amplitude, angular_frequency=omega):
            base, rate = f"{amplitude!r} * np.sin({omega!r} * t)", f"{amplitude * omega!r} * np.cos({omega!r} * t)"
        case Vibration(swing=swing, angular_frequency=omega):
            base, rate = f"{swing!r} * (1 - np.cos({omega!r} * t))", f"{swing * omega!r} * np.sin({omega!r} * t)"
        case GrowingAcceleration():
            base, rate = f"{drive.amplitude / drive.duration**3!r} * t**3", f"{drive.jerk / 2!r} * t**2"
        case _:
            raise TypeError(f"{type(drive).__name__} is no drive of a reproducer")
    moved = [f"base, rate = {base}, {rate}  # m, m/s"]
    if len(moved[0]) > WIDTH:
        moved = [f"base = {base}  # m", f"rate = {rate}  # m/s"]
    return [*moved, "return CHAIN_STIFFNESS[0] * base + CHAIN_DAMPING[0] * rate"]
