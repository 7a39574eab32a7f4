"""The finding of a report in two sentences: how far engines are off, and what one would conclude with them."""

from collections.abc import Sequence

from multibody_xval.reports.data.options import TITLES, Headline, by_engine, is_unsteady
from multibody_xval.reports.formatting import significant
from multibody_xval.scenarios.studies.claims import CLAIMS, Answer, Conclusions, farthest_edge, sentence
from multibody_xval.scenarios.sweeps.truths import WRONG_DB

MOST_NAMED = 3
"""Engines that the finding names."""

STARTS = dict(zip(TITLES, ("As installed,", "as recommended for any model,", "tuned to this chain,"), strict=True))


def finding(rows: Sequence[Headline], conclusions: Sequence[Conclusions] = ()) -> str:
    """Give the finding; empty where there is none."""
    return " ".join([*_errors(rows), *_claims(conclusions)])


def _errors(rows: Sequence[Headline]) -> list[str]:
    known = {
        name: [(row.size(name), row) for row in rows if name in row.rows and not is_unsteady(row.rows[name])]
        for name in TITLES
    }
    parts = [f"{STARTS[name]} {_wrong(own, named=name == 'default')}" for name, own in known.items() if own]
    if not parts:
        return []
    last = [own for own in known.values() if own][-1]
    return [f"{'; '.join(parts)}, and the largest error is {significant(max(size for size, _ in last))} dB."]


def _wrong(known: Sequence[tuple[float, Headline]], *, named: bool) -> str:
    """Say how many engines are wrong; the first time, which, by how much, and what that means."""
    engines = by_engine([row for _, row in known])
    wrong = sorted(((size, row) for size, row in known if size >= WRONG_DB), key=lambda pair: -pair[0])
    several = len(by_engine([row for _, row in wrong]))
    if not named:
        return f"{several} of {len(engines)}" if several else "none"
    which = "; ".join(f"{row.variant.title} by {significant(size)} dB" for size, row in wrong[:MOST_NAMED])
    count = f"{several or 'none'} of {len(engines)} engines {'is' if several == 1 else 'are'} off by {WRONG_DB:g} dB"
    return f"{count} or more{f' ({which})' if which else ''}"


def _claims(conclusions: Sequence[Conclusions]) -> list[str]:
    """Say which claims of the paper hold, and what one would conclude with the engine that is farthest from that."""
    if not conclusions or any(own.answer is Answer.OPEN for own in conclusions[0].claims):
        return []
    reference, *others = conclusions
    held = [own.name for own in reference.claims if own.answer in (Answer.HOLDS, Answer.READING)]
    start = f"The paper’s claims hold ({len(held)} of {len(CLAIMS)})"
    shown = max(others, key=lambda own: (_differs(own, reference), farthest_edge(own, reference)), default=None)
    if shown is None:
        return [f"{start} with the reference."]
    said = sentence(shown, reference)
    return [f"{start}; {said[:1].lower()}{said[1:]}"]


def _differs(own: Conclusions, reference: Conclusions) -> bool:
    pairs = zip(own.claims, reference.claims, strict=True)
    return any(mine.answer not in (right.answer, Answer.OPEN) for mine, right in pairs)
