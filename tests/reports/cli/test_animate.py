"""``python -m reports animate``: as many pictures as asked, cells where they are, colours of their modes."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from PIL import Image

from engines.interface.variant import Variant
from reference_lcp.console import run_command
from reference_lcp.observables.stick_slip import Mode
from reports.__main__ import app
from reports.cli import animation as module
from reports.figures.animation import ChainDrawing, write_animation
from reports.figures.stick_slip import MODE_COLOURS
from scenarios.tasks.parameters import ChainRatios
from scenarios.tasks.recorded import RecordedPeriod
from scenarios.tasks.task import SteadyStateTask
from tests.reports.conftest import motion

QUESTION = SteadyStateTask(
    variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9, ratios=ChainRatios(cells=2)
)  # fmt: skip


@pytest.fixture
def no_computation(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> RecordedPeriod:
        raise AssertionError("something was computed")

    monkeypatch.setattr(module, "period_of", refuse)


def test_a_gif_has_as_many_frames_as_asked(tmp_path: Path) -> None:
    write_animation(QUESTION, motion(), 8, tmp_path / "chain.gif")
    with Image.open(tmp_path / "chain.gif") as picture:
        assert picture.n_frames == 8


def test_a_page_holds_every_frame_itself(tmp_path: Path) -> None:
    write_animation(QUESTION, motion(), 8, tmp_path / "chain.html")
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
    ],
)
def test_wrong_input_is_refused_before_any_work(
    option: str, value: str, named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(app, ["animate", option, value]) == 2
    assert named in capsys.readouterr().err
