"""What a notebook writes: `sweep` and `check`, with lists and arrays, and mistakes that cost no time."""

import re
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray as xr

from multibody_xval.scenarios import check, functions, sweep
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from reference_lcp import Chain, HarmonicBase, HarmonicForce, ParameterError, steady_state

MASSES = [1.0, 0.8, 1.2]

SCRIPT = """\
from multibody_xval.scenarios import check, sweep
from multibody_xval.reports import report

data = sweep(["reference", "mujoco"], friction_ratio=[0.1, 0.3], frequency_ratio=(0.6, 1.2, 3), store="kept.sqlite")
table = check("frictionless-limit", engines=["mujoco"], store="kept.sqlite")
print(report(data, "my_report"))
print(sorted(data.sizes.items()), set(table.verdict))
"""


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Run tasks in this process: starting workers takes seconds."""
    monkeypatch.setattr(functions, "executor_for", lambda *_: InProcessExecutor())


def driven(chain: Chain) -> HarmonicBase:
    """Move the base at η_r = 0.9."""
    return HarmonicBase.from_ratio(chain, frequency_ratio=0.9)


def by_reference(drive_of, **ratios) -> float:
    """Transmittance [dB] of one point by the reference alone."""
    chain = Chain.from_ratios(**ratios)
    return steady_state(chain, drive_of(chain), with_error_bar=False).transmittance_db


@pytest.mark.slow
def test_script_without_a_main_guard_sweeps_checks_and_reports(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    page, said = done.stdout.splitlines()
    assert (tmp_path / page).stat().st_size > 1e5
    assert "('frequency_ratio', 3), ('friction_ratio', 2)" in said
    assert "('variant', 3)" in said
    assert said.endswith("{'agree'}")


@pytest.mark.usefixtures("here")
def test_array_has_one_number_a_cell() -> None:
    data = sweep("reference", 0.3, 0.9, chain={"cells": 3, "mass_ratio": np.array(MASSES)})
    expected = by_reference(
        driven,
        cells=3,
        mass_ratio=MASSES,
        friction_ratio=0.3,
    )
    assert float(data.transmittance_db.sel(variant="reference").squeeze()) == pytest.approx(expected, abs=1e-6)
    alike = sweep("reference", 0.3, 0.9, chain={"cells": 3})
    assert abs(float(alike.transmittance_db.sel(variant="reference").squeeze()) - expected) > 0.1, (
        "the masses make no difference"
    )


@pytest.mark.usefixtures("here")
def test_further_axes_are_varied_and_named() -> None:
    data = sweep("reference", [0.3], [0.9], vary={"mass_ratio": (0.5, 1.5, 3)}, chain={"cells": 2})
    assert data.sizes["mass_ratio"] == 3
    np.testing.assert_allclose(data.mass_ratio, [0.5, 1.0, 1.5])
    expected = by_reference(driven, cells=2, mass_ratio=1.5, friction_ratio=0.3)
    found = data.transmittance_db.sel(variant="reference", mass_ratio=1.5).squeeze()
    assert float(found) == pytest.approx(expected, abs=1e-6)


@pytest.mark.usefixtures("here")
def test_force_on_cell_one_drives_the_chain() -> None:
    data = sweep("reference", 0.0, 0.9, chain={"cells": 2}, drive="force", amplitude=5.0)
    assert (data.attrs["drive_kind"], data.attrs["drive_amplitude"]) == ("force", 5.0)
    expected = by_reference(
        lambda chain: HarmonicForce(5.0, 0.9 * chain.resonator_frequency), cells=2, friction_ratio=0.0
    )
    assert float(data.transmittance_db.sel(variant="reference").squeeze()) == pytest.approx(expected, abs=1e-6)


@pytest.mark.usefixtures("here")
def test_every_point_has_a_verdict_where_the_reference_takes_part() -> None:
    data = sweep(["reference", "exudyn-regularised"], 0.3, [0.6, 0.9], chain={"cells": 2})
    verdicts = data.verdict.attrs["flag_meanings"].split()
    found = {verdicts[k] for k in data.verdict.sel(variant=["reference", "exudyn-regularised"]).values.ravel()}
    assert found <= {"agree", "disagree"}
    alone = sweep("exudyn-regularised", 0.3, [0.6, 0.9], chain={"cells": 2})
    assert {verdicts[k] for k in alone.verdict.values.ravel()} == {"inconclusive"}


@pytest.mark.usefixtures("here")
def test_second_call_takes_everything_from_the_store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given = {"friction_ratio": [0.1, 0.3], "frequency_ratio": 0.9, "chain": {"cells": 2}, "store": tmp_path / "s.db"}
    first = sweep("reference", **given)
    monkeypatch.setattr(
        "multibody_xval.scenarios.runs.executor.run_batch", lambda _: pytest.fail("a task is run whose result is known")
    )
    second = sweep("reference", **given)
    xr.testing.assert_identical(first, second)


@pytest.mark.usefixtures("here")
def test_check_gives_a_row_a_number() -> None:
    table = check("frictionless-limit", "reference")
    assert set(table.engine) == {"reference"}
    assert set(table.verdict) == {"agree"}
    assert (table.difference.abs() <= table.allowed).all()
    assert len(table) > 0


@pytest.mark.usefixtures("here")
def test_verdicts_are_one_line_and_their_parts_are_rows() -> None:
    table = check("frictionless-limit", ["reference", "exudyn-regularised"])
    line = repr(table)
    assert "\n" not in line
    assert f"on {len(table)} numbers" in line
    assert table.counts.to_numpy().sum() == len(table)
    bars = table.counts.plot.barh(stacked=True)
    assert sum(bar.get_width() for bar in bars.patches) == len(table)
    plt.close(bars.figure)
    part = table[table.engine == "reference"]
    assert len(repr(part).splitlines()) > len(part) > 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"engines": "mojuco"}, "mojuco"),
        ({"engines": []}, "engines"),
        ({"friction_ratio": -0.1}, "friction_ratio = -0.1"),
        ({"frequency_ratio": []}, "frequency_ratio"),
        ({"frequency_ratio": (0.3, 1.6, 1)}, "points = 1"),
        ({"chain": {"cells": 3, "mass_ratio": [1.0, 2.0]}}, "mass_ratio has 2 values and the chain 3 cells"),
        ({"chain": {"masratio": 1.0}}, "chain.masratio is unknown; allowed: cells, .*; did you mean mass_ratio?"),
        ({"chain": 3}, "chain = 3; allowed: values by name"),
        ({"cells": 12}, "sweep has no argument 'cells'; allowed: in chain={'cells': ...}"),
        ({"friction_ratio": (0.1, 0.3, 5.0)}, "(0.1, 0.3, 5.0) is a tuple; allowed: [0.1, 0.3, 5.0] for these values"),
        ({"friction_ratio": (0.1, 0.3)}, "(0.1, 0.3) is a tuple; allowed: [0.1, 0.3] for these values"),
        ({"vary": {"colour": [1.0]}}, "colour"),
        ({"drive": "wind"}, "wind"),
        ({"steps_per_period": 3}, "steps_per_period = 3"),
        ({"workers": 0}, "workers"),
        ({"store": "no/such/folder/kept.sqlite"}, "no/such/folder"),
    ],
)
def test_mistake_is_named_before_any_work(
    arguments: dict[str, object], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "multibody_xval.scenarios.runs.evaluator.Evaluator.complete", lambda *_: pytest.fail("computed")
    )
    whole = {"engines": "reference", "friction_ratio": 0.3, "frequency_ratio": 0.9, **arguments}
    with pytest.raises(ParameterError, match=re.escape(message).replace(r"\.\*", ".*")):
        sweep(**whole)


def test_unknown_scenario_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(ParameterError, match="unit-cell"):
        check("unit-sell")
