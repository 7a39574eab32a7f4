"""How far engines are from their laws over a period: a row each, whatever becomes of the engine."""

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.mujoco import law as of_mujoco
from multibody_xval.scenarios.model import REFERENCE
from multibody_xval.scenarios.studies import laws as study

SOFT = Variant("mujoco", "joint", "default")


def test_soft_friction_of_a_joint_is_what_its_law_says_and_far_from_coulombs() -> None:
    table = study.law_distances([REFERENCE, Variant("mujoco"), SOFT, Variant("mujoco", "contact", "default")])
    assert table.steps_by.tolist() == ["the reference's scheme", "a law"], "a preset without a law has a row"
    assert (table.largest <= table.allowed).all()
    assert table.from_reference[1] > 1e3 * table.allowed[1]
    (line,) = study.formulas(table)
    assert line.startswith("mujoco:joint:default: forces at the start of the step")
    assert "d_max = 0.95" in line


def test_law_of_another_preset_is_far_from_the_engine(monkeypatch) -> None:
    hard = of_mujoco.joint_friction(Variant("mujoco", "joint", "recommended").preset)
    monkeypatch.setattr(study, "law_of", lambda *_: hard)
    assert study.period_distances(SOFT)[0] > 100 * hard.bound
