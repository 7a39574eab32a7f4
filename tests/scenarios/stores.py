"""Stores of an engine whose version is named, and whose friction is wrong by a factor: what `compare` compares."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from multibody_xval.scenarios import store as stores
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.store import opened
from tests.scenarios.in_this_process import result_of

CASE = Case(friction_ratio=0.3, frequency_ratio=0.47)
OTHER = Case(friction_ratio=0.3, frequency_ratio=0.9)
STEPS = 400
ENGINE = Config("mujoco")


def with_bound(factor: float, case: Case = CASE) -> Result:
    """The scheme's steady state where the friction bound is wrong by a factor."""
    return result_of(Run(REFERENCE, replace(case, friction_ratio=factor * case.friction_ratio), STEPS))


def write_store(
    file: Path,
    results: Mapping[Case, Result],
    version: str = "1.0",
    *,
    ruled: bool = True,
    options: Mapping[str, str] | None = None,
) -> Path:
    """Write results of an engine, with the ruler of their cases or without; what is there already stays."""
    runs = ruler((case, STEPS) for case in results) if ruled else []
    with pytest.MonkeyPatch.context() as patched, opened(file) as store:
        own, identity = (version, json.dumps(dict(options or {}))), stores.identity
        patched.setattr(stores, "identity", lambda config: own if config == ENGINE else identity(config))
        store.add({run: result_of(run) for run in runs})
        store.add({Run(ENGINE, case, STEPS): result for case, result in results.items()})
    return file
