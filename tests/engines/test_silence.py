"""Engines in a Python that has just begun: imported late, nothing said, nothing written, however a motion ends."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.shared.pip_engine import PipEngine
from tests.installed import each_engine

STOPS = ("drake", "exudyn-regularised", "exudyn-bristle")
"""Engines that end a motion that diverges with an error, as others do where a body leaves its plate."""

PROGRAM = """
import sys
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import variants_of
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import lane_of, unstable_lane
assert {module!r} not in sys.modules
for variant in variants_of({name!r}):
    lane = unstable_lane() if variant.formulation in {unstable!r} else lane_of()
    variant.build([lane]).advance(State.at_rest(1, 7), 0, 400)
"""

ON_PLATES = ("pybullet", "dart", "pinocchio", "pymunk", "box2d3", "rapier", "sapien")
ANYWHERE = ("newton", "mujoco-warp")


@pytest.mark.parametrize("name", each_engine(["mujoco", *ON_PLATES, *ANYWHERE, *STOPS]))
def test_it_is_imported_late_says_and_writes_nothing_and_survives_divergence(name: str, tmp_path: Path) -> None:
    """Standard output and error are read as file descriptors: compiled code does not write to sys.stderr."""
    adapter = engine(name)
    assert isinstance(adapter, PipEngine)
    unstable = () if name in STOPS else ("joint", "contact") if name in ANYWHERE else ("joint",)
    program = PROGRAM.format(module=adapter.module, name=name, unstable=unstable)
    path = os.pathsep.join(filter(None, [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH")]))
    done = subprocess.run(
        [sys.executable, "-B", "-W", "error", "-c", program], cwd=tmp_path, env={**os.environ, "PYTHONPATH": path},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert list(tmp_path.iterdir()) == []
