"""What a notebook writes: `sweep` and `check`, with lists and arrays, and mistakes that cost no time."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from multibody_xval.scenarios import check, functions, sweep
from multibody_xval.scenarios.sweeps.plan import UNCONFIRMED_POINTS
from reference_lcp import Chain, HarmonicBase, HarmonicForce, ParameterError, steady_state

pytestmark = pytest.mark.usefixtures("here")

MASSES = [1.0, 0.8, 1.2]

SCRIPT = """\
from multibody_xval import band_edges, check, plot, sweep

data = sweep(["reference", "mujoco"], friction_ratio=[0.1, 0.3], frequency_ratio=(0.6, 1.2, 3), store="kept.sqlite")
edges = band_edges(data, store="kept.sqlite")
table = check("static-hold", engines=["mujoco"], store="kept.sqlite")
plot(data, "curves.pdf")
print(len(edges), data.sizes["friction_ratio"], set(data.verdict.values.ravel().tolist()), set(table.verdict))
"""


def driven(chain: Chain) -> HarmonicBase:
    """Move the base at η_r = 0.9."""
    return HarmonicBase.from_ratio(chain, frequency_ratio=0.9)


def by_reference(drive_of, **ratios) -> float:
    """Transmittance [dB] of one point by the reference alone."""
    chain = Chain.from_ratios(**ratios)
    return steady_state(chain, drive_of(chain), with_error_bar=False).transmittance_db


@pytest.mark.slow
def test_script_without_a_main_guard_sweeps_checks_and_draws(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == "8 2 {'agrees'} {'agrees'}\n"
    assert (tmp_path / "curves.pdf").stat().st_size > 1e4


def test_array_has_one_number_a_cell() -> None:
    data = sweep("reference", 0.3, 0.9, chain={"cells": 3, "mass_ratio": np.array(MASSES)})
    expected = by_reference(
        driven,
        cells=3,
        mass_ratio=MASSES,
        friction_ratio=0.3,
    )
    assert float(data.transmittance_db.squeeze()) == pytest.approx(expected, abs=1e-6)
    alike = sweep("reference", 0.3, 0.9, chain={"cells": 3})
    assert abs(float(alike.transmittance_db.squeeze()) - expected) > 0.1, "the masses make no difference"


def test_further_axes_are_varied_and_named() -> None:
    data = sweep("reference", [0.3], [0.9], vary={"mass_ratio": (0.5, 1.5, 3)}, chain={"cells": 2})
    assert data.sizes["mass_ratio"] == 3
    np.testing.assert_allclose(data.mass_ratio, [0.5, 1.0, 1.5])
    expected = by_reference(driven, cells=2, mass_ratio=1.5, friction_ratio=0.3)
    found = data.transmittance_db.sel(mass_ratio=1.5).squeeze()
    assert float(found) == pytest.approx(expected, abs=1e-6)


def test_force_on_cell_one_drives_the_chain() -> None:
    data = sweep("reference", 0.0, 0.9, chain={"cells": 2}, drive="force", amplitude=5.0)
    assert json.loads(data.attrs["sweep"])["drive"] == {"kind": "force", "amplitude": 5.0}
    expected = by_reference(
        lambda chain: HarmonicForce(5.0, 0.9 * chain.resonator_frequency), cells=2, friction_ratio=0.0
    )
    assert float(data.transmittance_db.squeeze()) == pytest.approx(expected, abs=1e-6)


def test_every_point_has_a_verdict_whatever_takes_part() -> None:
    data = sweep(["exudyn-regularised"], 0.3, [0.6, 0.9], chain={"cells": 2})
    assert set(data.verdict.values.ravel()) <= {"agrees", "deviates"}
    assert set(data.exact_kind.values.ravel()) == {"exact"}
    assert data.configuration.values.tolist() == ["exudyn-regularised"]


def test_second_call_takes_everything_from_the_store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given = {"friction_ratio": [0.1, 0.3], "frequency_ratio": 0.9, "chain": {"cells": 2}, "store": tmp_path / "s.db"}
    first = sweep("reference", **given)
    monkeypatch.setattr("multibody_xval.scenarios.running.pool.run_batch", lambda _: pytest.fail("a known run is run"))
    xr.testing.assert_identical(first, sweep("reference", **given))


def test_a_large_sweep_is_refused_without_a_yes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(functions, "swept", lambda planned, _means: planned.points)
    large = {"friction_ratio": (0.0, 1.0, 400), "frequency_ratio": (0.3, 1.6, 300)}
    assert UNCONFIRMED_POINTS < 400 * 300
    with pytest.raises(ParameterError, match=r"has 120,000 points, 3.33 h of .*allowed: <= 100,000 .*with yes=True"):
        sweep("reference", **large)
    assert sweep("reference", **large, yes=True) == 120_000


def test_check_gives_a_row_a_number_and_keeps_the_results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = tmp_path / "checks.sqlite"
    table = check("static-hold", "mujoco", workers=1, store=store)
    assert set(table.configuration) == {"mujoco:joint:tuned"}
    assert set(table.verdict) == {"agrees"}
    assert (table.distance <= table.allowed).all()
    assert table.groupby("quantity").case.nunique().tolist() == [24, 24, 24]
    monkeypatch.setattr("multibody_xval.scenarios.running.pool.run_batch", lambda _: pytest.fail("a known run is run"))
    pd.testing.assert_frame_equal(table, check("static-hold", ["mujoco"], workers=1, store=store))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"scenario": "static-hole"}, "scenario = 'static-hole' is unknown; allowed: .*did you mean static-hold?"),
        ({"engines": "mojuco"}, "mojuco"),
        ({"engines": 3}, "engines = 3; allowed: a name, or a list of names"),
        ({"engines": []}, "engines = []; allowed: a name, or a list of names"),
        ({"scenario": ["static-hold", 1]}, "scenario = ['static-hold', 1]; allowed: a name, or a list of names"),
        ({"store": "no/such/folder/kept.sqlite"}, "no/such/folder"),
        ({"workers": 0}, "workers"),
        ({"time_limit": 0.0}, "time_limit = 0"),
    ],
)
def test_mistake_in_a_check_is_named_before_any_work(arguments, message, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "multibody_xval.scenarios.running.evaluate.run_missing", lambda *_, **__: pytest.fail("computed")
    )
    with pytest.raises(ParameterError, match=re.escape(message).replace(r"\.\*", ".*")):
        check(**{"scenario": "static-hold", "engines": "mujoco"} | arguments)


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
        ({"workers": 2, "scheduler": "tcp://127.0.0.1:1"}, "workers = 2 with a scheduler; allowed: one of the two"),
        ({"time_limit": 0.0}, "time_limit = 0"),
        ({"tolerance_db": 0.0}, "tolerances.transmittance_db = 0.0"),
        ({"amplitude": -1.0}, "drive.amplitude = -1.0"),
        ({"frequency_ratio": {"first": 0.3, "last": 0.2, "accuracy_db": 1.0}}, "last = 0.2; allowed: > first = 0.3"),
        ({"friction_ratio": (0.0, 1.0, 1001), "frequency_ratio": (0.3, 1.6, 1000)}, "1,001,000 points"),
        ({"store": "no/such/folder/kept.sqlite"}, "no/such/folder"),
        ({"store": "a\x00b"}, "is no path"),
    ],
)
def test_mistake_is_named_before_any_work(
    arguments: dict[str, object], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "multibody_xval.scenarios.running.evaluate.run_missing", lambda *_, **__: pytest.fail("computed")
    )
    whole = {"engines": "reference", "friction_ratio": 0.3, "frequency_ratio": 0.9, **arguments}
    with pytest.raises(ParameterError, match=re.escape(message).replace(r"\.\*", ".*")):
        sweep(**whole)
