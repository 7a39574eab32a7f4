"""Progress without a terminal: when a line is printed, and what it says of the time that is left."""

import pytest

from reference_lcp import progress_lines
from reference_lcp.progress_lines import ProgressLines, tracked


class Clock:
    """Time as a test sets it."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_a_line_is_printed_each_five_percent_with_the_time_that_is_left(clock: Clock, capsys) -> None:
    lines = ProgressLines("points", clock)
    lines.expect(1200)
    lines.recall(200)
    for _ in range(100):
        clock.now += 6
        lines.advance(1)
    assert capsys.readouterr().err.splitlines() == [
        "50 of 1,000 points (5%), 200 known before; 5 min so far, left: about 1 h 35 min",
        "100 of 1,000 points (10%), 200 known before; 10 min so far, left: about 1 h 30 min",
    ]


def test_work_of_a_second_prints_no_line(clock: Clock, capsys) -> None:
    lines = ProgressLines("points", clock)
    lines.expect(100)
    for _ in range(99):
        clock.now += 0.01
        lines.advance(1)
    assert capsys.readouterr().err == ""


def test_work_that_stands_still_prints_a_line_all_the_same(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    """The subject is time itself: with a hundredth of a second in place of ten, lines come with nothing done."""
    monkeypatch.setattr(progress_lines, "LINE_SECONDS", 0.01)
    lines = ProgressLines("points")
    lines.expect(3)
    printed = []
    monkeypatch.setattr(progress_lines, "print", lambda text, **_: printed.append(text), raising=False)
    with lines:
        while len(printed) < 2:
            lines._end.wait(0.01)
    assert set(printed) == {"0 of 3 points (0%); 0 s so far, left: unknown"}


def test_items_are_all_given_and_no_bar_is_drawn_without_a_terminal(capsys) -> None:
    assert list(tracked(["a", "b"], "letters")) == ["a", "b"]
    assert capsys.readouterr().err == ""
