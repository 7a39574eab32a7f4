"""The smallest error of every mutant that a gate detects, by bisection over its sizes; as a table and a document."""

import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from engines.interface.variant import Variant
from scenarios.runs.task import versions_of
from scenarios.tables import Column, csv_text, full_table, markdown_lines, text_table
from tests.mutations.gates import FREQUENCY_RATIOS, FRICTION_RATIOS, LEFT_OUT, NEEDED, SCENARIO_NAMES, Gate
from tests.mutations.mutant import Mutant
from tests.mutations.scenes import SCENE_COLUMNS, SCENE_LEGEND, SceneRow


@dataclass(frozen=True)
class Detection:
    """What a gate detects of a mutant."""

    smallest: float | None
    """The smallest of its sizes that the gate detects; ``None`` for none of them."""
    twin_caught: bool = False
    """The gate stops the mutant without its error too: it can say nothing of it then."""


class _Bisection:
    """The search of one mutant: sizes up to `low` are caught, those from `high` on are not.

    The smallest one is tried first, since most gates detect it.
    """

    def __init__(self, mutant: Mutant):
        self.mutant, self.low, self.high = mutant, -1, len(mutant.sizes)

    @property
    def open(self) -> bool:
        return self.high - self.low > 1

    @property
    def middle(self) -> int:
        last = len(self.mutant.sizes) - 1
        return last if self.high > last else (self.low + self.high) // 2

    @property
    def tried(self) -> Variant:
        return self.mutant.variant(self.mutant.sizes[self.middle])

    def narrow(self, caught: bool) -> None:
        if caught:
            self.low = self.middle
        else:
            self.high = self.middle

    @property
    def detection(self) -> Detection:
        return Detection(None if self.low < 0 else self.mutant.sizes[self.low])


def detections(gate: Gate, mutants: Sequence[Mutant], done: Callable[[], None] = lambda: None) -> list[Detection]:
    """Give what a gate detects of every mutant.

    That a larger error is caught wherever a smaller one is, is taken for granted.
    """
    twins = gate.caught([mutant.variant(0) for mutant in mutants])
    done()
    searches = [_Bisection(mutant) for mutant in mutants]
    said = [search for search in searches if search.mutant.variant(0) not in twins]
    while tried := [search for search in said if search.open]:
        caught = gate.caught([search.tried for search in tried])
        done()
        for search in tried:
            search.narrow(search.tried in caught)
    return [
        search.detection if search.mutant.variant(0) not in twins else Detection(None, twin_caught=True)
        for search in searches
    ]


def rounds(mutants: Sequence[Mutant]) -> int:
    """Give how often `detections` asks a gate at most: for twins, for the smallest sizes, and once a halving."""
    return 2 + max(((len(mutant.sizes) - 1).bit_length() for mutant in mutants), default=0)


@dataclass(frozen=True)
class MutationRow:
    """A mutant, and what each gate detects of it, by the gate's name."""

    mutant: Mutant
    detections: Mapping[str, Detection]

    @property
    def silent(self) -> str:
        """The gates that stop it without its error too, and so say nothing of it."""
        return ", ".join(name for name, detection in self.detections.items() if detection.twin_caught)

    @property
    def alone(self) -> str:
        """The gate that detects it with any size, where no other does."""
        detecting = [name for name, detection in self.detections.items() if detection.smallest is not None]
        return detecting[0] if len(detecting) == 1 and len(self.detections) > 1 else ""

    @property
    def passes(self) -> bool:
        """Whether it passes all gates with its largest error."""
        return all(detection.smallest is None for detection in self.detections.values())


def mutation_columns(gates: Sequence[str]) -> list[Column[MutationRow]]:
    """Give the columns of a table with these gates."""
    return [
        Column("mutant", lambda row: row.mutant.name),
        Column("error", lambda row: row.mutant.error),
        Column("claims", lambda row: row.mutant.excuse or str(row.mutant.of), "claims to be"),
        Column("largest", lambda row: row.mutant.sizes[0], "largest s", "{:g}"),
        Column("smallest", lambda row: row.mutant.sizes[-1], "smallest s", "{:g}"),
        *(_detected(gate) for gate in gates),
        Column("alone", lambda row: row.alone, "detected by this alone"),
        Column("silent", lambda row: row.silent, "stopped without the error, too"),
    ]


def _detected(gate: str) -> Column[MutationRow]:
    return Column(gate, lambda row: row.detections[gate].smallest, pattern="{:g}")


LEFT_OUT_LINES = "\n".join(
    f"- {', '.join(names)}: {reason}"
    for reason, names in {
        reason: [name for name, own in LEFT_OUT.items() if own == reason] for reason in LEFT_OUT.values()
    }.items()
)

MUTATION_LEGEND = f"""\
Which errors would the suite detect? A *mutant* is a copy of an engine's steps, of the reference's scheme or of the law
of a preset, with exactly one error of size s. Each mutant is run through three *gates* that every engine has to pass:

- *contract*: detected if `pytest --pyargs engines.contract --xval-engine NAME` fails;
- *scenarios*: detected if a scenario of the catalogue fails (a disagreement that no law predicts, or too few certified
  numbers): {", ".join(SCENARIO_NAMES)};
- *report*: detected if its exit code is 1 (the same, for a point or a band edge), with friction
  {", ".join(map(str, FRICTION_RATIOS))} × η_r {", ".join(map(str, FREQUENCY_RATIOS))}.

Scenarios of contacts that are inclined, or hold more at rest, are for the mutants that can do so: {", ".join(NEEDED)}.
Left out of the second gate:

{LEFT_OUT_LINES}

The column of a gate has the smallest error that it detects. Errors are tried from the *largest* to the *smallest* s, in
steps of ten; a dash means that even the largest passes. It is assumed that a larger error is detected wherever a
smaller one is. An error whose only size is 1 is either there or not.

Every mutant is also run without its error, through the same code. A gate that stops it then says nothing about the
error; the last column names it. The column before names a gate that alone detects a mutant.
"""


def gates_of(rows: Sequence[MutationRow]) -> list[str]:
    """Give the gates that rows are of."""
    return list(rows[0].detections)


def mutation_document(rows: Sequence[MutationRow], scenes: Sequence[SceneRow], command: str) -> str:
    """Give the tables of mutants and of scenes as a document, with how it was made."""
    passing = [row.mutant.name for row in rows if row.passes]
    lines = ["# Mutants and gates", "", MUTATION_LEGEND, f"Made by `{command}`.", ""]
    lines += markdown_lines(text_table(mutation_columns(gates_of(rows)), rows))
    lines += ["", f"Passing these gates with the largest error: {', '.join(passing) or 'none'}."]
    lines += ["", SCENE_LEGEND, *markdown_lines(text_table(SCENE_COLUMNS, scenes))]
    versions = versions_of(["reference"])
    return "\n".join([*lines, "", f"Versions: {versions}; Python {platform.python_version()}.", ""])


def mutation_csv(rows: Sequence[MutationRow]) -> str:
    """Give the table as CSV, with full precision."""
    return csv_text(full_table(mutation_columns(gates_of(rows)), rows), missing="")
