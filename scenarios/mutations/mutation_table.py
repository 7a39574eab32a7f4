"""Mutants × gates: the smallest error that each gate detects, as a table and a document."""

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from engines.mutants.mutant import Mutant
from scenarios.mutations.gates import FREQUENCY_RATIOS, FRICTION_RATIOS, SCENARIO_NAMES
from scenarios.mutations.search import Detection
from scenarios.tables import Column, csv_text, full_table, markdown_lines, text_table
from scenarios.tasks.versions import versions_of


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
        Column("silent", lambda row: row.silent, "stopped without the error, too"),
    ]


def _detected(gate: str) -> Column[MutationRow]:
    return Column(gate, lambda row: row.detections[gate].smallest, pattern="{:g}")


MUTATION_LEGEND = f"""\
What would the suite find out? Every *mutant* is a copy of an engine's own steps, of the reference's scheme or of the
law of a preset, with exactly one error of a size s. It is held to the gates that every engine has to pass, and the
table has the smallest size, of those from the *largest* to the *smallest*, a decade apart, that each gate detects; a
dash where even the largest passes. That a larger error is caught wherever a smaller one is, is taken for granted.

- *contract*: `pytest --pyargs engines.contract --engine NAME` is red.
- *scenarios*: one of {", ".join(SCENARIO_NAMES)} fails, as for its exit code: a
  disagreement that no law predicts, or too little that is certified.
- *report*: its exit code is 1: a point or a band edge disagrees, and not as a law predicts, or too little is certified,
  friction {", ".join(map(str, FRICTION_RATIOS))} × η_r {", ".join(map(str, FREQUENCY_RATIOS))}.

Every mutant is run without its error, too, through the same code. A gate that stops it then cannot speak of its error,
and is named in the last column. Errors whose only size is 1 are there or not. `python -m scenarios run unit-cell
--engine mutant@bound@0.01` judges a single one.
"""


def gates_of(rows: Sequence[MutationRow]) -> list[str]:
    """Give the gates that rows are of."""
    return list(rows[0].detections)


def mutation_document(rows: Sequence[MutationRow], command: str) -> str:
    """Give the table as a document, with how it was made."""
    passing = [row.mutant.name for row in rows if row.passes]
    lines = ["# Mutants and gates", "", MUTATION_LEGEND, f"Made by `{command}`.", ""]
    lines += markdown_lines(text_table(mutation_columns(gates_of(rows)), rows))
    lines += ["", f"Passing these gates with the largest error: {', '.join(passing) or 'none'}."]
    versions = versions_of(["reference"])
    return "\n".join([*lines, "", f"Versions: {versions}; Python {platform.python_version()}.", ""])


def mutation_csv(rows: Sequence[MutationRow]) -> str:
    """Give the table as CSV, with full precision."""
    return csv_text(full_table(mutation_columns(gates_of(rows)), rows), missing="")
