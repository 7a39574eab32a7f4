"""Numbers of scenarios as people read them: what was asked, tables, reasons."""

import math
from collections.abc import Iterator, Sequence

import pandas as pd

from multibody_xval.reports.formatting import number_text, numbered, significant, size_text
from multibody_xval.scenarios.catalogue.finding import WORST_FIRST, counts, over_allowed, worst_cases
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import Case, Config, Run
from multibody_xval.scenarios.result_tables import rows_of
from multibody_xval.scenarios.ruler.judge import AGREES, AT_EQUAL_STEPS

MOST_CONFIGURATIONS, MOST_NUMBERS = 3, 8
"""Configurations that have a table each, and numbers in these tables, which fit one screen; of more, a row each."""

MOST_ROWS = 60
"""Rows of the table of several scenarios: with more, a scenario has one row for all configurations."""

MOST_CASES = 4
"""Cases that the first lines name; of more, the first and the last."""

MOST_REASONS = 6
"""Reasons why there are no numbers that are printed; `--details` prints all."""

OWN_VALUE = r"^(\w+) = [^:]+: "
"""How a reason begins that names the value of its case: many that differ in this alone have one line."""


def asked(scenario: Scenario, rows: pd.DataFrame) -> list[str]:
    """Say what a scenario asks: question, source, expected values, cases and steps, parameters of the cases."""
    names = list(scenario.cases)
    many = len(names) > MOST_CASES
    listed = f"from {names[0]} to {names[-1]}" if many else "; ".join(names)
    cases = f"{len(names)} cases" if len(names) > 1 else "Case"
    configs = [Config(*own) for own in rows[["engine", "formulation", "preset"]].drop_duplicates().to_numpy().tolist()]
    runs = [list(scenario.own_runs(config).values()) for config in configs]
    most = max(map(len, runs), default=0)
    at_each = f", {most // len(names)} time steps each" if most > len(names) and most % len(names) == 0 else ""
    return [
        scenario.question,
        f"Source: {scenario.source}",
        f"Expected: {scenario.expects}.",
        f"{cases}{at_each}: {listed}. {_steps([run for own in runs for run in own])}.",
        *scenario.details,
    ]


def _steps(runs: Sequence[Run]) -> str:
    """Give time steps: of steady states, their number per period."""
    if all(isinstance(run.case, Case) for run in runs):
        return f"{_span([run.steps for run in runs])} time steps per period"
    return (
        f"Time steps of {_span([1e3 * run.case.time / run.steps for run in runs if not isinstance(run.case, Case)])} ms"
    )


def _span(values: Sequence[float]) -> str:
    texts = [f"{own:.4g}" for own in (min(values, default=math.nan), max(values, default=math.nan))]
    return " to ".join(dict.fromkeys(texts))


def number_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Give numbers of one configuration as texts: each with its case below, and the verdict."""
    expected = rows.exact.where(
        rows.expected != AT_EQUAL_STEPS, rows.reference.where(rows.reference.notna(), rows.exact)
    )
    texts = {
        "number, case": [numbered(*own) for own in rows[["quantity", "unit", "case"]].to_numpy()],
        "value": rows.value.map(number_text),
        "expected": expected.map(number_text),
        "off by": rows.distance.astype(float).map(size_text),
        "allowed": rows.allowed.astype(float).map(size_text),
        "result": rows.verdict,
    }
    return pd.DataFrame(texts, rows.index, dtype=object)


def worst_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Give the worst case of every number of one configuration as texts; it is named where not all cases agree."""
    worst = worst_cases(rows)
    texts = number_table(worst)
    sound = (worst.verdict == AGREES) & (worst.alike == worst.cases)
    alike = [f"\n{count} of {cases} cases" if cases > 1 else "" for count, cases in rows_of(worst, "alike", "cases")]
    return texts.assign(
        **{
            "number, case": texts["number, case"].where(~sound, texts["number, case"].str.partition("\n")[0]),
            "result": texts.result + pd.Series(alike, texts.index).where(~sound, ""),
        }
    ).rename(columns={"number, case": "number, worst case"})


def title(rows: pd.DataFrame) -> str:
    """Name a configuration, and say whether it is judged."""
    first = rows.iloc[0]
    version = f" (version {first.version})" if first.version else ""
    return f"{first.configuration}{version}, {'judged' if first.judged else 'measured, not judged'}"


def distances(rows: pd.DataFrame) -> pd.DataFrame:
    """Give a row a configuration, as texts: how far each number is off in its worst case, and how many agree.

    An engine has a row of its own above those of its configurations, which keeps the table narrow. How many numbers
    agree is in brackets where they are not judged.
    """
    worst = worst_cases(rows)
    far = worst.assign(
        name=[numbered(*own).rstrip() for own in rows_of(worst.assign(case=""), "quantity", "unit", "case")],
        text=worst.distance.astype(float).map(size_text),
    )
    wide = far.pivot_table(index="configuration", columns="name", values="text", aggfunc="first", sort=False)
    agree = {name: _agreeing(own) for name, own in rows.groupby("configuration", sort=False)}
    whole = wide.fillna("–").assign(agree=pd.Series(agree)).rename_axis(columns=None)
    texts: list[list[str]] = []
    for engine, own in whole.groupby(whole.index.str.partition(":").get_level_values(0), sort=False):
        texts.append([str(engine), *[""] * len(whole.columns)])
        texts += [[f"  {name.partition(':')[2]}", *values] for name, *values in own.itertuples(name=None)]
    return pd.DataFrame(texts, columns=["configuration", *whole.columns], dtype=object)


def _agreeing(rows: pd.DataFrame) -> str:
    text = f"{(rows.verdict == AGREES).sum()}/{len(rows)}"
    return text if rows.judged.any() else f"({text})"


def overview(rows: pd.DataFrame) -> pd.DataFrame:
    """Give a row a configuration, or scenario and configuration, as texts: what its numbers are, and the worst one."""
    by = [name for name in ("scenario", "configuration") if rows[name].nunique() > 1 or name == "configuration"]
    if "scenario" in by and len(rows[by].drop_duplicates()) > MOST_ROWS:
        by = ["scenario"]
    texts = []
    for names, own in rows.groupby(by, sort=False):
        judged = "" if own.judged.any() else " (not judged)"
        texts.append(["\n  ".join(map(str, names)), f"{counts(own)}{judged}{_worst(own)}"])
    return pd.DataFrame(texts, columns=[", ".join(by), "numbers"], dtype=object)


def _worst(rows: pd.DataFrame) -> str:
    """Name the number that is farthest from what is expected, over what is allowed, in a line below."""
    times = over_allowed(rows)
    if times.isna().all():
        return ""
    (name, case) = rows[["quantity", "case"]].to_numpy()[times.argmax()]
    size = significant(times.max()) if math.isfinite(times.max()) else "∞"
    return f"\nat most {size} times what is allowed: {name}; {case}"


def why(rows: pd.DataFrame) -> list[str]:
    """Say why numbers are not there, a line a reason and the configurations that share it."""
    own = rows[(rows.reason != "") & ~rows.verdict.isin([AGREES])]
    alike = own.reason.astype(str).str.replace(OWN_VALUE, r"\1: ", regex=True)
    lines: dict[str, list[str]] = {}
    for (name, verdict, shared), each in own.groupby([own.configuration, own.verdict, alike], sort=False):
        said = verdict if verdict in WORST_FIRST[1:] else "note"
        reason = each.reason.iloc[0] if each.reason.nunique() == 1 else shared
        line = f"{said} in {_cases(each.case.iloc[0], each.case.nunique())}: {reason}"
        lines.setdefault(line, []).append(str(name))
    return [f"{', '.join(names)}: {line}" for line, names in lines.items()]


def _cases(first: str, count: int) -> str:
    return first if count == 1 else f"{count} cases"


def meanings(scenario: Scenario) -> str:
    """Say what the numbers of a scenario are."""
    by_meaning = {
        own.meaning: [each.name for each in scenario.quantities if each.meaning == own.meaning]
        for own in scenario.quantities
    }
    return " ".join(f"{', '.join(names)}: {text[0].lower()}{text[1:]}" for text, names in by_meaning.items())


def errors(rows: pd.DataFrame) -> list[str]:
    """Give the largest errors to the exact values of what is compared at equal steps, in a line."""
    own = rows[(rows.expected == AT_EQUAL_STEPS) & rows.error.notna()]
    sizes = own.assign(size=own.error.map(abs).astype(float)).sort_values("size", ascending=False, kind="stable")
    largest = rows_of(sizes.drop_duplicates("quantity").sort_index(), "quantity", "unit", "size")
    parts = [f"{name} {significant(size)} {unit}".strip() for name, unit, size in largest if size > 0]
    if not parts:
        return []
    return [
        f"Expected is the reference at equal time steps; those alone are off the exact values by: {', '.join(parts)}."
    ]


def tables(rows: pd.DataFrame, *, details: bool) -> Iterator[tuple[str, pd.DataFrame]]:
    """Give the tables of one scenario with their titles."""
    named = [(title(own), own) for _, own in rows.groupby("configuration", sort=False)]
    many = len(named) > MOST_CONFIGURATIONS or len(named) * rows.quantity.nunique() > MOST_NUMBERS
    if len(named) > 1 and many and not details:
        yield "Worst distance from what is expected, and how many agree (in brackets: not judged)", distances(rows)
        return
    for name, own in named:
        there = own[own.verdict != "unsupported"]
        if len(there):
            yield name, number_table(there) if details else worst_table(there)
