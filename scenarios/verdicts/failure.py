"""What fails a run: disagreements that no law predicts, and presets about which too little is known.

A finding *says nothing* where there is no certified steady state, or where the own step is too coarse. Without a limit
on them, an engine that is never certified would pass every comparison. Not counted are findings of which the law of the
preset says the same, and steps that are too coarse for the reference's scheme as well, which the preset shares.
"""

from collections.abc import Sequence

from engines.interface.variant import Variant
from scenarios.verdicts.finding import Finding
from scenarios.verdicts.verdict import Verdict

MOST_SILENT = 0.25
"""Largest share of a preset's findings that may say nothing: a case of the four that most scenarios have."""


def unexplained(findings: Sequence[Finding]) -> list[Finding]:
    """Give the disagreements that no law predicts; so is a step that is too coarse, and not as the law has it."""
    return [finding for finding in findings if _departs(finding) and not finding.as_predicted]


def silent(findings: Sequence[Finding]) -> list[Finding]:
    """Give the findings that say nothing."""
    return [finding for finding in findings if _says_nothing(finding)]


def failing(findings: Sequence[Finding]) -> list[Finding]:
    """Give the findings of a scenario why it fails: unexplained ones, and silent ones of a preset with many."""
    fails = {id(finding) for finding in unexplained(findings)}
    for variant in dict.fromkeys(finding.variant for finding in findings):
        fails |= {id(finding) for finding in _too_silent([own for own in findings if own.variant == variant])}
    return [finding for finding in findings if id(finding) in fails]


def failures(findings: Sequence[Finding]) -> list[str]:
    """Say in a line each why the findings of a scenario are a failure; none where they are not."""
    lines = []
    wrong = unexplained(findings)
    if wrong:
        what = "disagreement" if len(wrong) == 1 else "disagreements"
        lines.append(f"unexplained: {len(wrong)} {what}, of {_names([finding.variant for finding in wrong])}")
    for variant in dict.fromkeys(finding.variant for finding in findings):
        own = [finding for finding in findings if finding.variant == variant]
        nothing = len(_too_silent(own))
        if nothing:
            lines.append(
                f"{variant}: {nothing} of {len(own)} numbers without a certified steady state, or with too coarse a "
                f"step; allowed: {MOST_SILENT:.0%}"
            )
    return lines


def _too_silent(own: Sequence[Finding]) -> list[Finding]:
    """Give the findings of a preset that say nothing, where they are more than `MOST_SILENT` of all; none otherwise."""
    nothing = silent(own)
    return nothing if len(nothing) > MOST_SILENT * len(own) else []


def _departs(finding: Finding) -> bool:
    verdict = finding.comparison.verdict
    return verdict is Verdict.DISAGREE or (verdict is Verdict.TOO_COARSE and finding.prediction is not None)


def _says_nothing(finding: Finding) -> bool:
    prediction = finding.prediction
    if not finding.comparison.certified:
        return prediction is None or prediction.certified or not prediction.holds
    if finding.comparison.verdict is not Verdict.TOO_COARSE or finding.variant.preset.shares_scheme:
        return False
    return prediction is None


def _names(variants: Sequence[Variant]) -> str:
    return ", ".join(dict.fromkeys(map(str, variants)))
