"""What scenes detect of a point mass that is wrong by little; they have no chain, and judge other engines."""

from collections.abc import Mapping
from dataclasses import dataclass

from scenarios.catalogue.registry import CATALOGUE
from scenarios.catalogue.scenes.base import SceneScenario
from scenarios.tables import Column
from scenarios.verdicts.finding import failures
from tests.scenarios.point_mass import judged

SCENE_ERRORS: Mapping[str, Mapping[str, float]] = {
    "without an error": {},
    "friction × 0.99": {"friction": 0.99},
    "normal force × 1.01": {"normal": 1.01},
    "creep of 1 µm/s": {"creep": 1e-6},
    "falls by 10 mm at once": {"fall": 0.01},
}
"""Arguments of `PointMass`, by what is wrong with it."""

SCENE_LEGEND = """\
Scenes have no chain. They judge Coulomb's law of one mass in Euler's steps, and the same with an error
(`tests/scenarios/catalogue/test_scenes.py` has more of them). A body that holds feels no friction that is wrong by a
hundredth, and one that is spun may have any torque between two limits.
"""


@dataclass(frozen=True)
class SceneRow:
    """A scene, and which errors it detects."""

    name: str
    detected: Mapping[str, bool]


def scene_rows() -> list[SceneRow]:
    """Judge the point mass in every scene, with every error."""
    scenes = [scenario for scenario in CATALOGUE.values() if isinstance(scenario, SceneScenario)]
    return [
        SceneRow(scene.name, {error: bool(failures(judged(scene, **wrong))) for error, wrong in SCENE_ERRORS.items()})
        for scene in scenes
    ]


def _column(error: str) -> Column[SceneRow]:
    return Column(error, lambda row: "detected" if row.detected[error] else "passes")


SCENE_COLUMNS = [Column[SceneRow]("scene", lambda row: row.name), *map(_column, SCENE_ERRORS)]
