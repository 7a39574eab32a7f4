"""A stand-alone script for one number of one variant: the engine's own part, set into what all scripts share."""

import math
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.resources import files
from importlib.resources.abc import Traversable

from jinja2 import ChoiceLoader, DictLoader, Environment, PackageLoader

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.reproducer import Reproducer
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.formatting import environment
from multibody_xval.reports.reproducers.questions import QUESTIONS, Number, Question
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.verdicts.finding import Metric
from reference_lcp.chain.drives import Drive, GrowingAcceleration, HarmonicBase, StillBase, Vibration
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError, checked_choice, shortened
from reference_lcp.terminal import visible
from reference_lcp.validation import FloatArray

LONGEST_LINE = 128
"""Characters, where numbers of many digits stand in a line."""

WIDTH = 116
"""Characters a line of the header has at most."""

LONGEST_PARAGRAPH = 800
"""Characters of a paragraph of the header: versions are texts of others."""


@dataclass(frozen=True)
class Reproduction:
    """What is shown: a number of a variant; see `checked`."""

    variant: Variant
    question: Question
    case: str

    @property
    def metric(self) -> Metric:
        """The number."""
        return self.question.metric

    @property
    def command(self) -> str:
        """The command that prints the script."""
        case = "" if self.case == self.question.case else f' "{self.case}"'
        return f"multibody-xval reproduce {self.variant} {self.question.scenario}{case}"


def checked(variant: str, scenario: str, case: str | None = None) -> Reproduction:
    """Check what is to be shown, before any work."""
    checked_choice("scenario", scenario, list(QUESTIONS))
    question, parsed = QUESTIONS[scenario], Variant.parse(variant)
    chosen = question.case if case is None else checked_choice("case", case, list(question.cases()))
    reproducer_of(parsed)
    return Reproduction(parsed, question, chosen)


def reproducer_of(variant: Variant) -> Reproducer:
    """Give how a variant is written as a script."""
    reproducer = _template(variant)
    if reproducer is None:
        allowed = ", ".join(_reproducible())
        raise ParameterError(f"{variant} has no reproducer; allowed: {allowed}")
    return reproducer


def _template(variant: Variant) -> Reproducer | None:
    reproducer = _adapter(variant.engine).reproducers.get(Formulation(variant.formulation))
    written = reproducer is not None and variant.preset_name not in reproducer.without and not variant.preset.settings
    return reproducer if written else None


def _adapter(name: str) -> Engine:
    """Give the adapter of an engine; of the model of a law, that of the engine."""
    base = name.partition("@")[0]
    return engine(base) if base in engine_names() else engine(name)


def _reproducible() -> Iterable[str]:
    """Name every engine and formulation that has a template."""
    return [f"{name}:{formulation}" for name in engine_names() for formulation in engine(name).reproducers]


def script(shown: Reproduction, evaluator: Evaluator) -> str:
    """Write the script of one number; the suite's own is in its header, computed where the store lacks it."""
    variant, question = shown.variant, shown.question
    task = question.task(variant, shown.case)
    check_not_blocked(variant, shown.case, *evaluator.evaluate([task]))
    lane, reproducer = task.lane(), reproducer_of(variant)
    templates = _environment(variant.engine, reproducer.template)
    number = question.number(variant, shown.case, evaluator)
    reading = templates.get_template(f"{question.scenario}.py.jinja")
    text = templates.get_template("engine").render(
        header=_header(shown, number),
        lists=_lists(lane.chain, task.initial_state(), lane.time_step, task.steps),
        base_motion=base_motion(lane.drive),
        reading=reading.render(question.readings(shown.case, evaluator)).rstrip(),
        metric=question.metric.name,
        unit=f" {question.metric.unit}" if question.metric.unit else "",
        exact=_short(number.exact),
        **reproducer.numbers(lane, variant.preset, task.initial_state()),
    )
    return text.rstrip() + "\n"


def check_not_blocked(variant: Variant, case: str, result: Result) -> None:
    """Refuse to show a number that there is none of."""
    if result.status is ResultStatus.BLOCKED:
        raise ParameterError(f"{variant} has no number of {case!r}: {result.reason}; allowed: a case that it can run")


@cache
def _environment(engine_name: str, template: str) -> Environment:
    """Templates of the engine, of what all scripts share, and of other engines by their folders.

    Names that are not there are refused.
    """
    own = beside(_adapter(engine_name), template).read_text(encoding="utf-8")
    shared = PackageLoader("multibody_xval.reports.reproducers")
    frame = (
        files("multibody_xval.reports.reproducers").joinpath("templates", "script.py.jinja").read_text(encoding="utf-8")
    )
    templates = environment(markup=False)
    templates.loader = ChoiceLoader(
        [DictLoader({"engine": own, "script": frame}), shared, PackageLoader("multibody_xval.engines", "")]
    )
    templates.filters["listed"] = _list
    return templates


def beside(adapter: Engine, name: str) -> Traversable:
    """Give a file beside an adapter, which need not be there."""
    return files(str(import_module(type(adapter).__module__).__package__)).joinpath(name)


def _header(shown: Reproduction, number: Number) -> str:
    """Say what is asked, of what, what is exact, and what the suite has."""
    variant, metric = shown.variant, shown.metric
    scenario, adapter = CATALOGUE[shown.question.scenario], engine(variant.engine)
    missing = adapter.unavailable_reason()
    version = "" if missing is not None else f" {adapter.version()}"
    unit = f" {metric.unit}" if metric.unit else ""
    value = f"{number.value:.6g}{unit}" if math.isfinite(number.value) else f"no number ({number.reason})"
    units = variant.preset.options.get("units")
    protocol = f", {shown.question.protocol}" if shown.question.protocol else ""
    told = [
        f"{variant.formulation}, {variant.preset_name}: {variant.preset.description}",
        f"{shown.question.scenario}: {shown.case}{protocol}.",
        f"Exact: {_short(number.exact)}{unit}; the cross-validation suite has {value}.",
    ]
    if units is not None and units.value != "SI" and not reproducer_of(variant).own_units:
        told.append("Here in SI units, there in its own.")
    title = f"{adapter.capabilities.title}{version}: {scenario.question}"
    return docstring(title, " ".join(told))


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


def base_motion(drive: Drive) -> str:
    """Give position and velocity of the base as expressions; an empty text where it stands still."""
    match drive:
        case StillBase():
            return ""
        case HarmonicBase(amplitude=amplitude, angular_frequency=omega):
            return f"{amplitude!r} * np.sin({omega!r} * t), {amplitude * omega!r} * np.cos({omega!r} * t)"
        case Vibration(swing=swing, angular_frequency=omega):
            return f"{swing!r} * (1 - np.cos({omega!r} * t)), {swing * omega!r} * np.sin({omega!r} * t)"
        case GrowingAcceleration():
            return f"{drive.amplitude / drive.duration**3!r} * t**3, {drive.jerk / 2!r} * t**2"
    raise TypeError(f"{type(drive).__name__} is no drive of a reproducer")
