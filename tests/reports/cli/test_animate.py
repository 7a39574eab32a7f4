"""``multibody-xval animate``: as many pictures as asked, cells where they are, colours of their modes."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from PIL import Image

from engines.interface.variant import Variant
from reference_lcp.observables.stick_slip import Mode
from reference_lcp.process import run_command
from reports.cli import shown as module
from reports.cli.console_script import app
from reports.figures.animation import ChainDrawing, write_animation
from reports.figures.stick_slip import MODE_COLOURS
from scenarios.runs.parameters import DEFAULT_AMPLITUDE, ChainRatios, Excitation
from scenarios.runs.recorded import RecordedPeriod
from scenarios.runs.task import SteadyStateTask
from tests.reports.conftest import motion

QUESTION = SteadyStateTask(
    variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9, ratios=ChainRatios(cells=2)
)  # fmt: skip


@pytest.fixture
def no_computation(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> RecordedPeriod:
        raise AssertionError("something was computed")

    monkeypatch.setattr(module, "period_of", refuse)


def test_a_file_has_as_many_frames_as_asked_and_a_page_holds_every_one_itself(tmp_path: Path) -> None:
    for name in ("chain.gif", "chain.html"):
        write_animation(QUESTION, motion(), 8, tmp_path / name)
    with Image.open(tmp_path / "chain.gif") as picture:
        assert picture.n_frames == 8
    assert (tmp_path / "chain.html").read_text().count("data:image/png;base64") == 8


def test_boxes_are_where_the_masses_are_and_have_the_colours_of_their_modes() -> None:
    found = motion()
    drawing = ChainDrawing(QUESTION, found, 80)
    for frame in (0, 19, 60):
        drawing.draw(frame)
        displacement = np.array([box.get_x() + box.get_width() / 2 for box in drawing._inner]) - drawing._centres
        np.testing.assert_allclose(displacement, drawing._scale * found.inner[frame])
        mode = Mode.BACKWARD if found.modes[frame, 0] < 0 else Mode.FORWARD
        colours = [to_hex(box.get_facecolor()).upper() for box in drawing._inner]
        assert colours == [MODE_COLOURS[mode].upper(), MODE_COLOURS[Mode.STICK].upper()]


def test_neighbours_never_meet_and_inner_masses_stay_inside() -> None:
    found = motion()
    wild = RecordedPeriod(outer=50 * found.outer, inner=50 * found.inner, friction=found.friction, modes=found.modes)
    drawing = ChainDrawing(QUESTION, wild, 16)
    for frame in range(16):
        drawing.draw(frame)
        first, second = drawing._outer
        assert first.get_x() + first.get_width() < second.get_x()
        for outer, inner in zip(drawing._outer, drawing._inner, strict=True):
            assert outer.get_x() <= inner.get_x()
            assert inner.get_x() + inner.get_width() <= outer.get_x() + outer.get_width()


CHAIN = """\
engines = ["reference"]
steps_per_period = 800
[grid]
friction_ratio = [0.5]
frequency_ratio = [1.0]
[chain]
cells = 3
friction_profile = [1.0, 0.5, 2.0]
[drive]
kind = "force"
"""


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (
            ["--chain", "cells=3", "--chain", "mass_ratio=0.5,1,2", "--chain", "friction_profile=1,0,1"],
            {"ratios": ChainRatios(cells=3, mass_ratio=(0.5, 1.0, 2.0), friction_profile=(1.0, 0.0, 1.0))},
        ),
        (
            ["--sweep", "{sweep}"],
            {
                "ratios": ChainRatios(cells=3, friction_profile=(1.0, 0.5, 2.0)),
                "excitation": Excitation(kind="force", amplitude=DEFAULT_AMPLITUDE["force"]),
                "steps_per_period": 800,
            },
        ),
        (
            ["--engine", "mujoco", "--set", "noslip_iterations=3"],
            {"variant": Variant.parse("mujoco:noslip_iterations=3")},
        ),
    ],
)
def test_any_chain_and_variant_can_be_animated(
    options: list[str], expected: dict[str, object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sweep.toml").write_text(CHAIN)
    tasks: list[SteadyStateTask] = []

    def noted(task: SteadyStateTask, _: float) -> RecordedPeriod:
        tasks.append(task)
        return motion()

    monkeypatch.setattr(module, "period_of", noted)
    monkeypatch.setattr(
        "reports.figures.animation.write_animation", lambda *arguments: arguments[-1].write_text("drawn")
    )
    arguments = [option.format(sweep=tmp_path / "sweep.toml") for option in options]
    assert run_command(app, ["animate", *arguments, "--out", str(tmp_path / "chain.gif")]) == 0
    (task,) = tasks
    assert {name: getattr(task, name) for name in expected} == expected


def test_an_engine_without_a_steady_state_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(module, "period_of", lambda *_: RecordedPeriod("period limit after 400 periods"))
    assert run_command(app, ["animate", "--out", str(tmp_path / "chain.gif")]) == 1
    assert "Reference (LCP): period limit after 400 periods" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("no_computation")
@pytest.mark.parametrize(
    ("option", "value", "named"),
    [
        ("--engine", "mujocco", "mujocco"),
        ("--friction-ratio", "-1", "friction_ratio"),
        ("--frequency-ratio", "0", "frequency_ratio"),
        ("--frames", "4", "frames"),
        ("--frames", "401", "8 to 400"),
        ("--out", "chain.mp4", ".gif or .html"),
        ("--chain", "cells=0", "cells"),
        ("--chain", "cells=two", "cells = 'two'"),
        ("--chain", "mass_ratio=1,2", "mass_ratio has 2 values and the chain 7 cells"),
        ("--chain", "masses=1", "masses is unknown; allowed: cells, mass_ratio"),
        ("--chain", "mass_ratio=nan", "mass_ratio"),
        ("--sweep", "nowhere.toml", "nowhere.toml cannot be read"),
        ("--set", "substeps=2", "option 'substeps' cannot be set in reference:joint:tuned"),
    ],
)
def test_wrong_input_is_refused_before_any_work(
    option: str, value: str, named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(app, ["animate", option, value]) == 2
    assert named in capsys.readouterr().err
