"""The gates that an engine has to pass: the contract, the scenarios, the report."""

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Protocol
from xml.etree import ElementTree

from engines.interface.variant import Variant
from reference_lcp.errors import ParameterError
from scenarios.catalogue.base import run_with_predictions
from scenarios.catalogue.registry import CATALOGUE
from scenarios.catalogue.scenes.base import SceneScenario
from scenarios.runs.evaluator import Evaluator
from scenarios.studies.figure3 import figure3
from scenarios.sweeps.compared import compare_sweep
from scenarios.verdicts.finding import Finding, failures

LEFT_OUT = {
    "figure3": "its points and edges are the third gate",
    "swept-sine": "it has the chain of ricker-pulse, and takes longer",
    "filtered-noise": "it has the chain of ricker-pulse, and takes longer",
    "long-chain": "no error here depends on the number of cells, and it takes the longest",
    "inclined-steady-state": "it has the contacts of inclined-chain, and takes minutes",
    **{
        name: "it has no chain, see the second table"
        for name, scenario in CATALOGUE.items()
        if isinstance(scenario, SceneScenario)
    },
}
"""Scenarios that the second gate has not, and why."""

SCENARIO_NAMES = tuple(name for name in CATALOGUE if name not in LEFT_OUT)
"""Scenarios of the second gate."""

NEEDED = {
    "inclined-chain": "inclines",
    "static-above-kinetic": "static_friction",
}
"""What a preset has to be able to, for a scenario to say anything of it; another engine would be blocked there."""

FRICTION_RATIOS, FREQUENCY_RATIOS = (0.1, 0.3, 1.0), (0.5, 0.62, 0.7, 0.8, 0.9, 1.0, 1.1, 1.3, 1.5)
"""The sweep of the third gate: a part of figure 3 that holds both edges of every curve."""

PYTEST_FINISHED = (0, 1)
"""Exit codes of pytest that has run all tests: all have passed, or some have not."""


class Gate(Protocol):
    """What says which variants are wrong."""

    def caught(self, variants: Sequence[Variant]) -> set[Variant]:
        """Give those of the variants that do not pass."""
        ...


class ContractGate:
    """The tests of `engines.contract`, run by pytest in a process of its own.

    Raises
    ------
    ParameterError
        If pytest is not installed.
    """

    def __init__(self) -> None:
        if find_spec("pytest") is None:
            raise ParameterError(
                "pytest is not installed, and the contract needs it: pip install '.[test]' in the suite's folder"
            )

    def caught(self, variants: Sequence[Variant]) -> set[Variant]:
        """Give the variants whose engine breaks a clause."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "junit.xml")
            names = [option for variant in variants for option in ("--xval-engine", variant.engine)]
            options = ["-q", "-p", "no:cacheprovider", "--override-ini=addopts=", "--tb=no", f"--junitxml={file}"]
            command = [sys.executable, "-m", "pytest", "--pyargs", "engines.contract", *options, *names]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            if done.returncode not in PYTEST_FINISHED:
                raise RuntimeError(f"pytest ended with {done.returncode}: {done.stdout[-1000:]}{done.stderr[-1000:]}")
            cases = ElementTree.parse(file).getroot().iter("testcase")
            failed = [case.attrib["name"] for case in cases if {part.tag for part in case} & {"failure", "error"}]
        return {variant for variant in variants if any(is_of(variant.engine, name) for name in failed)}


def is_of(engine: str, test: str) -> bool:
    """Say whether a test, ``clause[ENGINE]`` or ``clause[ENGINE-formulation-preset…]``, is one of an engine."""
    case = test.partition("[")[2]
    return case.startswith((f"{engine}]", f"{engine}-joint-", f"{engine}-contact-"))


@dataclass(frozen=True)
class ScenarioGate:
    """Scenarios of the catalogue, judged as their command's exit code is."""

    evaluator: Evaluator
    names: Sequence[str] = SCENARIO_NAMES

    def caught(self, variants: Sequence[Variant]) -> set[Variant]:
        """Give the variants of which a scenario fails; one that fails is not run through the scenarios after it."""
        found: set[Variant] = set()
        for name in self.names:
            needed = NEEDED.get(name)
            due = [
                variant
                for variant in variants
                if variant not in found and (needed is None or getattr(variant.preset, needed))
            ]
            findings = run_with_predictions(CATALOGUE[name], due, self.evaluator) if due else []
            found |= {variant for variant in due if failures(own(variant, findings))}
        return found


def own(variant: Variant, findings: Sequence[Finding]) -> list[Finding]:
    """Give the findings of a variant."""
    return [finding for finding in findings if finding.variant == variant]


@dataclass(frozen=True)
class ReportGate:
    """Points and band edges of a report, judged as its command's exit code is."""

    evaluator: Evaluator
    friction_ratios: Sequence[float] = FRICTION_RATIOS
    frequency_ratios: Sequence[float] = FREQUENCY_RATIOS

    def caught(self, variants: Sequence[Variant]) -> set[Variant]:
        """Give the variants for which the report fails."""
        sweep = figure3(variants, self.friction_ratios, self.frequency_ratios)
        findings = compare_sweep(sweep, self.evaluator).findings
        return {variant for variant in variants if failures(own(variant, findings))}
