"""The parts of pages that are made from data, between the comments ``made NAME ...`` and ``end``.

``python docs/tables.py`` writes them anew in all pages and in the README; a test holds that nothing changes.
"""

import re
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import commands
import pandas as pd
import python_names

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.formatting import significant
from multibody_xval.reports.reproducers.recipe import by_hand, recipe_text
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.worst_numbers import printed_number
from multibody_xval.scenarios.report_plan import PRESETS
from multibody_xval.scenarios.ruler.judge import OTHER_SCHEMES

DOCS = Path(__file__).parent

ACCURACY, SCENES, VERDICTS, STEP_MODELS, ENGINES = (
    DOCS / f"{name}.csv"
    for name in ("results/accuracy", "scenes/answers", "verdicts/verdicts", "theory/step_models", "engines/table")
)

MADE = re.compile(r"(?P<first><!-- made (?P<words>[^>]*?) -->\n).*?(?P<last>^<!-- end -->$)", re.DOTALL | re.MULTILINE)
"""A made part of a page."""

DRIFT = "stack-hold, drift [µm/s]"

README_ENGINES = ("mujoco", "genesis", "drake", "pymunk", "pybullet", "newton")

SIGNS = {
    "deviates": "✗", "failed": "!", "not periodic": "~", "unknown": "?", "time step too large": "Δ",
    "unsupported": "–", "agrees": "✓",
}  # fmt: skip
"""What a cell of verdicts shows: the worst, which comes first."""

NOT_PERIODIC, NOT_ENOUGH, DASH = "not periodic", "not enough", "–"


def markdown(header: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """Give a table; bars in cells are escaped."""
    lines = [header, ["---"] * len(header), *rows]
    return ["| " + " | ".join(str(cell).replace("|", r"\|") for cell in line) + " |" for line in lines]


def csv(name: str) -> list[str]:
    """Give a CSV file of this folder as it is; empty cells are dashes."""
    table = pd.read_csv(DOCS / name, dtype=str, keep_default_na=False)
    return markdown(list(table), [[cell or DASH for cell in row] for row in table.to_numpy()])


def engines() -> list[str]:
    """Give the table of engines: names, precisions and licences are the adapters', the rest is `ENGINES`."""
    rows = []
    for own in pd.read_csv(ENGINES, dtype=str).itertuples(index=False):
        name, version, page, *friction = own
        known = engine(name).capabilities
        rows.append((f"[{known.title}]({page})", f"{version}, {known.precision}", known.licence, *friction))
    heads = ("engine", "version, precision", "licence", "friction", "with default options", "tuned to the chain")
    return markdown(heads, rows)


def recipe(name: str) -> list[str]:
    """Give what the recipe of an engine says to write, with notes and alternatives: what is written by hand."""
    title, *lines = by_hand(recipe_text(name)).splitlines()
    return lines[1:] if title.startswith("#") else []


def drift() -> list[str]:
    """Give the README's table: drift of a stack of three boxes with default options and with the recipe [µm/s]."""
    rows = pd.read_csv(SCENES).query("number == @DRIFT").set_index("engine").loc[[*README_ENGINES]]
    cells = [
        (
            engine(str(own.Index)).capabilities.title.partition(" (")[0],
            *map(printed_number, (own.default, own.recommended)),
        )
        for own in rows.itertuples()
    ]
    return markdown(("engine", "default options [µm/s]", "with our recipe [µm/s]"), cells)


SCENE_TABLES = {
    "drift": r"hold.*(?:drift|turning)|shaken|heavy-on-light, drift|grip, drift",
    "moved": r"sag|turned|lift|wander|stop, drift",
    "motion": r"slope-slide|slide-to-stop, (?:distance|path|yaw)|conveyor|pushed|spin, torque|joint-stop",
}
"""Which numbers of scenes a table has."""


def scenes(kind: str) -> list[str]:
    """Give the worst numbers of scenes by engine: default options, and the recipe where it changes them."""
    rows = pd.read_csv(SCENES)
    rows = rows[rows.number.str.contains(SCENE_TABLES[kind]) & ~rows.number.str.startswith("cost")]
    cells = {(own.engine, own.number): _scene_cell(own) for own in rows.itertuples()}
    numbers = sorted(dict.fromkeys(rows.number), key=lambda number: number.startswith(("joint", "arm")))
    titles = {name: _title(name) for name in rows.engine}
    names = sorted(titles, key=lambda name: titles[name].lower())
    return markdown(
        ("engine", *numbers), [[titles[name], *(cells.get((name, number), "") for number in numbers)] for name in names]
    )


def _title(name: str) -> str:
    """Give the title of an engine, or of one of its presets."""
    return Variant.parse(name).title if ":" in name else engine(name).capabilities.title


def _scene_cell(own: object) -> str:
    default, recommended = (printed_number(getattr(own, name)).replace("-", "−") for name in ("default", "recommended"))
    text = default if recommended in (default, DASH) else f"{default} → {recommended}"
    return text if own.cured or text == DASH else f"**{text}**"  # type: ignore[attr-defined]


def accuracies() -> pd.DataFrame:
    """Give the measured table of errors, with texts and empty cells as they are."""
    return pd.read_csv(ACCURACY, dtype=str, keep_default_na=False)


def accuracy() -> list[str]:
    """Give all columns of the table of errors."""
    return csv("results/accuracy.csv")


def errors() -> list[str]:
    """Give the largest error of every engine by formulation: default options, recipe, tuned to the chain [dB]."""
    cells = {
        (own.engine, own.formulation, own.preset): own for own in accuracies().itertuples() if own.engine != "reference"
    }
    rows = []
    for name in dict.fromkeys(key[0] for key in cells):
        texts = [[error_text(cells.get((name, part, preset))) for preset in PRESETS] for part in ("joint", "contact")]
        rows.append((engine(name).capabilities.title, *texts[0], *texts[1]))
    heads = [f"{part}, {preset}" for part in ("joint", "contact") for preset in ("default", "recipe", "tuned")]
    return markdown(("engine", *heads), rows)


def error_text(own: object | None) -> str:
    """Give the largest error in two digits, with a star where points are not periodic; `DASH` without a number."""
    if own is None:
        return DASH
    known, every = map(int, own.periodic.split("/"))  # type: ignore[attr-defined]
    size = own[6]  # type: ignore[index]
    if 0 < 3 * known < every:
        text = NOT_PERIODIC
    elif not known:
        return DASH
    else:
        text = significant(float(size)) + r"\*" * (known < every)
    return text + f" ({NOT_ENOUGH})" * is_not_enough(own, text)


def is_not_enough(own: object, text: str) -> bool:
    """Tell whether a recipe leaves more than twice the error of the reference with as many steps."""
    if own.preset != "recommended" or text == NOT_PERIODIC:  # type: ignore[attr-defined]
        return False
    scheme = float(accuracies().query("engine == 'reference'")["map, 800 [dB]"].iloc[0])
    return float(own[6]) > OTHER_SCHEMES * scheme  # type: ignore[index]


def verdicts(kind: str) -> list[str]:
    """Give a row a scenario and a column an engine and formulation of the presets of this kind, with the worst sign."""
    rows = pd.read_csv(VERDICTS, keep_default_na=False)
    rows = rows[rows.preset == kind]
    columns = list(rows[["engine", "formulation"]].drop_duplicates().itertuples(index=False, name=None))
    counts = rows.groupby(["scenario", "engine", "formulation"])[list(SIGNS)].sum()
    lines = []
    for name in [own for own in SCENARIOS if own in set(rows.scenario)]:
        found = [counts.loc[(name, *column)] if (name, *column) in counts.index else None for column in columns]
        lines.append([f"`{name}`", *map(_verdict_cell, found)])
    return markdown(("scenario", *(f"{engine_name} {part}" for engine_name, part in columns)), lines)


def _verdict_cell(counts: "pd.Series[int] | None") -> str:
    if counts is None:
        return ""
    worst = next(name for name in SIGNS if counts[name])
    return SIGNS[worst] if counts[worst] == counts.sum() else f"{SIGNS[worst]} {counts[worst]}"


def step_models() -> list[str]:
    """Give how far each preset is from what is said of its steps."""
    table = pd.read_csv(STEP_MODELS, keep_default_na=False)
    kinds = table.formula.eq("").map({True: "the reference's scheme", False: "its model"})
    numbers = [
        table[name].map(lambda own, pattern=pattern: pattern.format(float(own)) if own != "" else DASH)
        for name, pattern in (("largest", "{:.1e}"), ("allowed", "{:.0e}"), ("from_reference", "{:.1e}"))
    ]
    headings = ("configuration", "steps by", "largest [U0]", "allowed [U0]", "from Coulomb [U0]")
    return markdown(headings, zip(table.configuration, kinds, *numbers, strict=True))


def formulas() -> list[str]:
    """Give the formula and constants of every step model with the presets that have them."""
    table = pd.read_csv(STEP_MODELS, keep_default_na=False).query("formula != ''")
    groups = table.groupby(["formula", "constants"], sort=False).configuration
    texts = {key: ", ".join(f"`{name}`" for name in own) for key, own in groups}
    return [f"- {own}: `{'; '.join(filter(None, key))}`" for key, own in texts.items()]


def names() -> list[str]:
    """Give every name of `multibody_xval` with what it is."""
    return markdown(("name", "what it is"), python_names.table())


PARTS: dict[str, Callable[..., list[str]]] = {
    "csv": csv, "recipe": recipe, "drift": drift, "scenes": scenes, "accuracy": accuracy, "errors": errors,
    "engines": engines,
    "verdicts": verdicts, "step-models": step_models, "formulas": formulas, "python-names": names,
    "python-reference": lambda: list(python_names.lines()),
    "commands": commands.lines,
}  # fmt: skip


def made(text: str) -> str:
    """Give a page with its made parts as they are now."""

    def part(found: re.Match[str]) -> str:
        name, *arguments = found["words"].split()
        if name not in PARTS:
            return found[0]
        return found["first"] + "\n".join([*PARTS[name](*arguments), "", found["last"]])

    return MADE.sub(part, text)


def pages() -> list[Path]:
    """Give the README and all pages."""
    return [DOCS.parent / "README.md", *sorted(DOCS.rglob("*.md"))]


if __name__ == "__main__":
    for page in pages():
        before = page.read_text(encoding="utf-8")
        if (text := made(before)) != before:
            page.write_text(text, encoding="utf-8")
            print(page.relative_to(DOCS.parent), file=sys.stderr)
