"""What a report comes to: a line an engine, how many numbers agree, and the finding in two sentences."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import pandas as pd

from engines.interface.presets import Formulation
from engines.interface.variant import Variant
from reports.data.options import SingleOption
from reports.data.variants import Errors
from reports.formatting import MISSING, two_digits
from scenarios.studies.claims import CLAIMS, Answer, Conclusions, farthest_edge, sentence
from scenarios.studies.one_option import tuned_options
from scenarios.sweeps.truths import WRONG_DB
from scenarios.verdicts.finding import Finding, Verdict, unmodelled
from scenarios.verdicts.steady_case import REFERENCE

TITLES = {"default": "as installed", "recommended": "recommended", "tuned": "tuned"}
"""Presets that README, page and terminal compare, and what they are called there."""

UNSTEADY = "unsteady"
"""Stands for an error where fewer than a third of the points have a steady state."""


def is_unsteady(row: Any) -> bool:
    """Whether there are too few steady states for an error."""
    return bool(3 * row.points_known < row.points)


def error_text(row: Any | None) -> str:
    """Give the largest error of a row of `Errors` in two digits [dB]; with a star where points are not known."""
    if row is None or (not row.points_known and row.blocked):
        return MISSING
    if is_unsteady(row):
        return UNSTEADY
    return two_digits(row.size) + ("*" if row.points_known < row.points else "")


@dataclass(frozen=True)
class EngineLine:
    """One engine and formulation: its errors by preset."""

    variant: Variant
    """The tuned one, which need not be among them."""
    rows: Mapping[str, Any]
    """Rows of `Errors` by preset."""
    decisive: SingleOption | None = None
    """The option that alone takes off more than half of the largest error, and most of it."""

    @property
    def texts(self) -> list[str]:
        """Largest errors [dB] in the order of `TITLES`."""
        return [error_text(self.rows.get(name)) for name in TITLES]

    @property
    def worst(self) -> float:
        """Largest error as installed, or of what there is [dB]; −1 where there is none."""
        known = [row.size for name in TITLES if (row := self.rows.get(name)) is not None and row.points_known]
        return float(known[0]) if known else -1.0

    @property
    def options(self) -> list[str]:
        """What decides: one option where that is known, those of a recommendation, or those tuned to the chain."""
        if self.decisive is not None:
            return [f"{self.decisive.option} = {self.decisive.value}"]
        presets = self.variant.capabilities.presets[Formulation(self.variant.formulation)]
        if "recommended" in presets and "default" in presets:
            changed = presets["recommended"].changed_from(presets["default"])
            if changed:
                return list(changed)
        return list(tuned_options(self.variant.engine, self.variant.formulation)) if "default" in presets else []


def engine_lines(errors: Errors, singles: Sequence[SingleOption] = ()) -> list[EngineLine]:
    """Give a line an engine and formulation, the largest error as installed first."""
    rows: dict[Variant, dict[str, Any]] = {}
    for variant, row in errors.items():
        if variant.engine != REFERENCE.engine and variant.preset_name in TITLES:
            rows.setdefault(variant.tuned, {})[variant.preset_name] = row
    decisive = {single.default.variant.tuned: single for single in reversed(singles) if single.halves}
    lines = [EngineLine(variant, own, decisive.get(variant)) for variant, own in rows.items()]
    return sorted(lines, key=lambda line: -line.worst)


def by_engine(lines: Sequence[EngineLine]) -> dict[str, list[EngineLine]]:
    """Group lines by the title of their engine, joints first."""
    groups: dict[str, list[EngineLine]] = {}
    for line in lines:
        groups.setdefault(line.variant.capabilities.title, []).append(line)
    return {title: sorted(own, key=lambda line: line.variant.formulation != "joint") for title, own in groups.items()}


MOST_LINES = 10
"""Lines of a terminal; the page has all."""

MOST_NAMED = 3
"""Engines that the finding names."""

MOST_OPTIONS = 1
"""Options that a line names."""


def engine_table(lines: Sequence[EngineLine]) -> pd.DataFrame:
    """Give the table that a terminal shows: the engines that are farthest off as installed, and what decides."""
    shown = list(lines[: MOST_LINES if len(lines) <= MOST_LINES else MOST_LINES - 1])
    rows = [(line.variant.title, " → ".join(line.texts), _decisive(line)) for line in shown]
    if len(lines) > len(shown):
        rows.append((f"{len(lines) - len(shown)} more on the page", "", ""))
    return pd.DataFrame(rows, columns=["largest error [dB]", " → ".join(TITLES.values()), "what decides"])


def _decisive(line: EngineLine) -> str:
    more = len(line.options) - MOST_OPTIONS
    return ", ".join(line.options[:MOST_OPTIONS]) + (f" and {more} more" if more > 0 else "")


class Counted(StrEnum):
    """What a number comes to: a transmittance, a phase or a band edge that is compared."""

    AGREE = "agree"
    MODELLED = "differ as the engine’s model predicts"
    UNEXPLAINED = "unexplained"
    OPEN = "without a steady state or with too coarse a step"
    BLOCKED = "of engines that cannot"


def counted(findings: Sequence[Finding]) -> Counter[Counted]:
    """Count numbers by what they come to."""
    wrong = {id(finding) for finding in unmodelled(findings)}
    return Counter(Counted.UNEXPLAINED if id(finding) in wrong else _outcome(finding) for finding in findings)


def _outcome(finding: Finding) -> Counted:
    match finding.comparison.verdict:
        case Verdict.AGREE:
            return Counted.AGREE
        case Verdict.BLOCKED:
            return Counted.BLOCKED
    return Counted.MODELLED if finding.modelled else Counted.OPEN


JUDGED = (Counted.AGREE, Counted.MODELLED, Counted.UNEXPLAINED)


def status(counts: Mapping[Counted, int], failures: Sequence[str], missing: int = 0) -> str:
    """Say whether a comparison passes, and how many numbers come to what."""
    judged = ", ".join(f"{counts.get(what, 0):,} {what}" for what in JUDGED)
    rest = [f"{counts[what]:,} {what}" for what in Counted if what not in JUDGED and counts.get(what)]
    rest += [f"{missing:,} points not run so far"] if missing else []
    return f"{'Fails' if failures else 'Passes'}: {judged}." + (f" Not judged: {'; '.join(rest)}." if rest else "")


def finding(lines: Sequence[EngineLine], conclusions: Sequence[Conclusions]) -> list[str]:
    """Give the finding in at most two sentences: how far engines are off, and what one would conclude with them."""
    return [*_errors(lines), *_claims(conclusions)]


def _errors(lines: Sequence[EngineLine]) -> list[str]:
    starts = ("As installed,", "as recommended for any model,", "tuned to this chain,")
    parts = []
    for name, start in zip(TITLES, starts, strict=True):
        known = [(row.size, own) for own in lines if (row := own.rows.get(name)) is not None and not is_unsteady(row)]
        if known:
            parts.append(f"{start} {_wrong(known, named=name == 'default')}")
    if not parts:
        return []
    largest = f", and the largest error is {two_digits(max(size for size, _ in known))} dB" if known else ""
    return [f"{'; '.join(parts)}{largest}."]


def _wrong(known: Sequence[tuple[float, EngineLine]], *, named: bool) -> str:
    """Say how many engines are wrong; the first time, which, by how much, and what that means."""
    engines = by_engine([own for _, own in known])
    wrong = sorted(((size, own) for size, own in known if size >= WRONG_DB), key=lambda pair: -pair[0])
    several = len(by_engine([own for _, own in wrong]))
    if not named:
        return f"{several} of {len(engines)}" if several else "none"
    which = "; ".join(f"{own.variant.title} by {two_digits(size)} dB" for size, own in wrong[:MOST_NAMED])
    count = f"{several or 'none'} of {len(engines)} engines {'is' if several == 1 else 'are'} off by {WRONG_DB:g} dB"
    return f"{count} or more{f' ({which})' if which else ''}"


def _claims(conclusions: Sequence[Conclusions]) -> list[str]:
    """Say which claims of the paper hold, and what one would conclude with the engine that is farthest from that."""
    if not conclusions:
        return []
    reference, *others = conclusions
    if any(own.answer is Answer.OPEN for own in reference.claims):
        return []
    held = [own.name for own in reference.claims if own.answer in (Answer.HOLDS, Answer.READING)]
    start = f"The paper’s claims hold ({len(held)} of {len(CLAIMS)})"
    shown = max(others, key=lambda own: (_differs(own, reference), farthest_edge(own, reference)), default=None)
    return [f"{start}; {_lowered(sentence(shown, reference))}" if shown else f"{start} with the reference."]


def _differs(own: Conclusions, reference: Conclusions) -> bool:
    pairs = zip(own.claims, reference.claims, strict=True)
    return any(mine.answer not in (right.answer, Answer.OPEN) for mine, right in pairs)


def _lowered(text: str) -> str:
    return text[:1].lower() + text[1:]
