"""A benchmark problem: what to build, in SI units, and its exact motion, as the files of `problems` hold it."""

import json
from functools import cache
from importlib import resources
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.lcp.systems import FrictionContact, Harmonic, MassSpringSystem, Signal, Spring

FORMAT = 1
"""Version of the files. What would read a file wrongly changes it."""

GROUND = -1
"""Index of the base, which stands still or moves as a sine: what stands for a body in springs and contacts."""

Positive = Annotated[FiniteFloat, Field(gt=0)]
NotNegative = Annotated[FiniteFloat, Field(ge=0)]
Body = Annotated[int, Field(ge=GROUND)]


class _Record(BaseModel):
    """A part of a file: no names but its own, and descriptions of all of them in the schema."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


class Enclosed(_Record):
    """A number that is known to a radius, both as decimals."""

    value: str
    radius: str
    unit: str
    """SI, or dB; 1 of a number without unit."""


class Transition(_Record):
    """A change of the mode of one contact, in a period that begins at phase zero of the base."""

    contact: int
    kind: Literal["stick", "forward slip", "backward slip"]
    """The mode that begins."""
    time: Enclosed
    """Over the period."""


class Problem(_Record):
    """Bodies on one axis, springs, dashpots and dry friction between them, forces on them, and their exact motion.

    Lists that begin with the same word belong together, one entry a spring, contact or force. All sines have the one
    angular frequency ω and are zero at t = 0.
    """

    format: Literal[1]
    """Version of this format."""
    name: str
    title: str
    build: str
    """How an engine would build it, in words."""
    masses: list[Positive]
    """m [kg], one a body; bodies are counted from 0, and −1 is the base."""
    angular_frequency: NotNegative
    """ω [rad/s] of all sines."""
    base_amplitude: NotNegative
    """U0 [m]: the base moves as U0 sin ωt, and stands still if this is 0."""
    spring_first: list[Body]
    """A body."""
    spring_second: list[Body]
    """The other body; −1 is the base."""
    spring_stiffness: list[NotNegative]
    """k [N/m]."""
    spring_damping: list[NotNegative]
    """c [N s/m] of the dashpot beside it."""
    contact_first: list[Body]
    """The body whose velocity relative to the other one is the slip velocity."""
    contact_second: list[Body]
    """The other body; −1 is the base."""
    contact_normal_force: list[NotNegative]
    """Mean N0 [N] of the normal force N = N0 + N1 sin ωt."""
    contact_normal_amplitude: list[FiniteFloat]
    """N1 [N]."""
    contact_kinetic: list[NotNegative]
    """μ_k: friction is μ_k N against the slip."""
    contact_static: list[NotNegative]
    """μ_s >= μ_k: at rest it is up to μ_s N."""
    force_body: list[Body]
    force_mean: list[FiniteFloat]
    """F0 [N] of the force F = F0 + F1 sin ωt."""
    force_amplitude: list[FiniteFloat]
    """F1 [N]."""
    start_position: list[FiniteFloat]
    """Of every body at t = 0 [m]; springs are without force where all bodies are at 0."""
    start_velocity: list[FiniteFloat]
    """[m/s]."""
    time_step: Positive
    """Step for which the errors below are stated [s]; those of other steps are in proportion."""
    times: list[Positive]
    """When the motion is compared [s]: whole numbers of steps, to round-off."""
    positions: list[list[FiniteFloat]]
    """The exact motion [m], one row a time, one column a body."""
    velocities: list[list[FiniteFloat]]
    """[m/s], likewise."""
    position_uncertainty: Positive
    """How far the positions above may be from the exact ones [m]."""
    velocity_uncertainty: Positive
    """[m/s], likewise."""
    position_error: list[NotNegative]
    """What a scheme of first order may be off with the step above [m], one a body: twice as much as the symplectic
    Euler scheme is, or as the motion is if it comes a step late; of what stands still, the rounding of single
    precision."""
    velocity_error: list[NotNegative]
    """[m/s], likewise."""
    observables: dict[str, Enclosed]
    """What is known of the motion, by its name."""
    transitions: list[Transition]
    """All changes between stick and slip of a steady state; none of other motions."""

    @property
    def system(self) -> MassSpringSystem:
        """Build it; the base acts through the springs on it, as a force."""
        forces: dict[int, Signal] = {}
        for body, mean, amplitude in zip(self.force_body, self.force_mean, self.force_amplitude, strict=True):
            forces[body] = Harmonic(mean, amplitude, self.angular_frequency)
        springs = zip(self.spring_first, self.spring_second, self.spring_stiffness, self.spring_damping, strict=True)
        own = [Spring(first, None if second == GROUND else second, k, c) for first, second, k, c in springs]
        if self.base_amplitude:
            (shaken,) = (spring for spring in own if spring.second is None)
            wave = self.base_amplitude * (shaken.stiffness + 1j * self.angular_frequency * shaken.damping)
            forces[shaken.first] = Harmonic(0.0, abs(wave), self.angular_frequency, float(np.angle(wave)))
        return MassSpringSystem(masses=np.array(self.masses), springs=own, friction=self._contacts, forces=forces)

    @property
    def _contacts(self) -> list[FrictionContact]:
        ends = zip(self.contact_first, self.contact_second, strict=True)
        pressed = zip(self.contact_normal_force, self.contact_normal_amplitude, strict=True)
        coefficients = zip(self.contact_kinetic, self.contact_static, strict=True)
        return [
            FrictionContact(
                first,
                None if second == GROUND else second,
                Harmonic(mean, amplitude, self.angular_frequency),
                kinetic,
                static,
            )
            for (first, second), (mean, amplitude), (kinetic, static) in zip(ends, pressed, coefficients, strict=True)
        ]


def problem_of(text: str, source: str) -> Problem:
    """Read a problem from JSON; `source` names it in errors.

    Raises
    ------
    ParameterError
        If it is no JSON, of another format, or not as the schema says.
    """
    try:
        data = json.loads(text)
    except ValueError as problem:
        raise ParameterError(f"{source} is no JSON: {problem}") from None
    version = data.get("format") if isinstance(data, dict) else None
    if version != FORMAT:
        raise ParameterError(f"format of {source} = {version!r}; allowed: {FORMAT}")
    try:
        return Problem.model_validate(data)
    except ValidationError as problem:
        first = problem.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise ParameterError(f"{place} of {source}: {first['msg']}; allowed: what problem.schema.json says") from None


@cache
def problems() -> dict[str, Problem]:
    """Give all problems by their names."""
    folder = resources.files(__package__).joinpath("problems")
    files = sorted((file for file in folder.iterdir() if file.name.endswith(".json")), key=lambda file: file.name)
    read = [problem_of(file.read_text(encoding="utf-8"), file.name) for file in files]
    return {problem.name: problem for problem in read}


def problem_named(name: str) -> Problem:
    """Give the problem of a name.

    Raises
    ------
    ParameterError
        If there is none.
    """
    return problems()[checked_choice("problem", name, list(problems()))]


def text_of(problem: Problem) -> str:
    """Give the file of a problem: a name a line, and a row of the motion a line."""
    lines = [f' "{name}": {_value(value)}' for name, value in problem.model_dump().items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _value(value: Any) -> str:
    if isinstance(value, list) and value and isinstance(value[0], (list, dict)):
        return "[\n  " + ",\n  ".join(json.dumps(row, ensure_ascii=False) for row in value) + "\n ]"
    return json.dumps(value, ensure_ascii=False)
