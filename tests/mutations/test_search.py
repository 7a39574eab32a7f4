"""The smallest error that a gate detects, where it is known."""

import re
from collections.abc import Sequence

import pytest

from engines.interface.variant import Variant
from tests.mutations.__main__ import options, write_mutations
from tests.mutations.catalogue import MUTANTS
from tests.mutations.mutant import Mutant
from tests.mutations.scenes import SCENE_ERRORS, SceneRow
from tests.mutations.search import Detection, MutationRow, detections, mutation_csv, mutation_document, rounds
from tests.test_table_widths import WIDTH, widest_rule

MANY = MUTANTS["bound"]
WHOLE = MUTANTS["single"]


class Threshold:
    """Catches errors from a size on, and twins of the mutants that are named."""

    def __init__(self, size: float, twins: Sequence[Mutant] = ()):
        self.size, self.twins, self.rounds = size, [twin.variant(0) for twin in twins], 0

    def caught(self, variants: Sequence[Variant]) -> set[Variant]:
        self.rounds += 1
        return {
            variant
            for variant in variants
            if variant in self.twins or float(variant.engine.rpartition("@")[2]) >= self.size
        }


@pytest.mark.parametrize("size", MANY.sizes)
def test_smallest_error_is_found_by_bisection(size: float) -> None:
    gate = Threshold(size)
    assert detections(gate, [MANY, WHOLE]) == [Detection(size), Detection(1.0)]
    assert gate.rounds <= rounds([MANY, WHOLE]) == 5


def test_error_that_passes_with_its_largest_size_is_not_detected() -> None:
    assert detections(Threshold(100.0), [MANY, WHOLE]) == [Detection(None), Detection(None)]


def test_gate_that_stops_the_sound_twin_says_nothing_of_the_error() -> None:
    gate = Threshold(1e-3, twins=[MANY])
    assert detections(gate, [MANY, WHOLE]) == [Detection(None, twin_caught=True), Detection(1.0)]


def row(mutant: Mutant, *detected: Detection) -> MutationRow:
    return MutationRow(mutant, dict(zip(("contract", "scenarios", "report"), detected, strict=True)))


def rows() -> list[MutationRow]:
    return [
        row(MANY, Detection(1e-7), Detection(1e-3), Detection(None)),
        row(MUTANTS["mujoco-bound"], Detection(1e-3), Detection(0.1), Detection(None, twin_caught=True)),
        row(WHOLE, *[Detection(None)] * 3),
    ]


def test_document_names_the_smallest_errors_and_what_passes() -> None:
    scenes = [SceneRow("slope-hold", {error: "creep" in error for error in SCENE_ERRORS})]
    text = mutation_document(rows(), scenes, "python -m tests.mutations")
    assert "| slope-hold | passes | passes | passes | detected | passes |" in text
    assert "| bound | bound of friction × (1 + s) | reference | 1 | 1e-07 | 1e-07 | 0.001 | – |  |  |" in text
    assert "| 0.001 | 0.1 | – |  | report |" in text
    assert "Passing these gates with the largest error: single." in text
    assert "Made by `python -m tests.mutations`." in text


@pytest.mark.parametrize(
    ("smallest", "alone"),
    [((1e-7, None, None), "contract"), ((None, 0.1, None), "scenarios"), ((1.0, 0.1, None), ""), ((None,) * 3, "")],
)
def test_gate_that_alone_detects_a_mutant_is_named(smallest: tuple[float | None, ...], alone: str) -> None:
    assert row(MANY, *map(Detection, smallest)).alone == alone


def test_csv_has_a_row_a_mutant() -> None:
    lines = mutation_csv(rows()).splitlines()
    assert lines[0] == "mutant,error,claims,largest,smallest,contract,scenarios,report,alone,silent"
    assert len(lines) == 4


def test_table_fits_a_terminal(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    write_mutations([row(mutant, *[Detection(1.25e-13)] * 3) for mutant in MUTANTS.values()], None, "")
    assert widest_rule(capsys.readouterr().out) <= WIDTH


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("--mutant bond", r"invalid choice: 'bond' .*bound"),
        ("--gate garden", r"invalid choice: 'garden' .*contract.*scenarios.*report"),
        ("--out mutations.txt", r"allowed: \.md or \.csv"),
        ("--mutant bound --store kept.csv --out kept.csv", r"kept\.csv is the store"),
    ],
)
def test_wrong_command_line_is_refused_before_anything_runs(line: str, reason: str, capsys) -> None:
    with pytest.raises(SystemExit, match="2"):
        options(line.split())
    assert re.search(reason, capsys.readouterr().err)
