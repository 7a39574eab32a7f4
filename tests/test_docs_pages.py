"""Pages of the documentation that are made by programs, and its pictures, are what these programs make now."""

import re
from importlib import metadata
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.engines.interface.laws import law_of
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import variants_of

from .programs import program

DOCS = Path(__file__).parents[1] / "docs"


PAGES = sorted([DOCS.parent / "README.md", *DOCS.rglob("*.md")])
NAMES = [str(path.relative_to(DOCS.parent)) for path in PAGES]


def test_there_are_few_pages_and_the_first_one_leads_to_each() -> None:
    first, *others = ("index.md", *(str(path.relative_to(DOCS).with_suffix("")) for path in DOCS.rglob("*.md")))
    listed = re.findall(r"^[\w/]+$", (DOCS / first).read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(["index", *listed]) == sorted(others)
    assert len(others) <= 25


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_made_parts_of_a_page_are_what_the_data_give_now(page: Path) -> None:
    """Tables, recipes, options of commands: `python docs/tables.py` writes them anew."""
    text = page.read_text(encoding="utf-8")
    assert program("tables").made(text) == text


@pytest.mark.parametrize("cell", ["| MuJoCo | 7,294 |", "| Drake | 9,281 | 63 |"])
def test_another_number_in_a_made_part_is_put_right(cell: str) -> None:
    text = (DOCS.parent / "README.md").read_text(encoding="utf-8")
    assert cell in text
    assert program("tables").made(text.replace(cell, cell.replace("2", "1"))) == text


def headings(page: Path) -> list[str]:
    """Give the names under which GitHub links to the headings of a page."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return [
        re.sub(r"[^\w\- ]", "", own.lower()).replace(" ", "-") for own in re.findall(r"^#+ (.*)", text, re.MULTILINE)
    ]


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_every_link_has_a_text_and_leads_to_a_file_of_the_source(page: Path) -> None:
    """So that GitHub shows what the built pages show."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    links = re.findall(r"\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)", text)
    for label, place in links:
        assert label.strip(), place
        path, _, heading = place.partition("#")
        if "://" not in place:
            file = page.parent / path if path else page
            assert file.is_file(), place
            assert not heading or heading in headings(file), place


@pytest.mark.parametrize("file", ["tiny_engine/__init__.py", "pyproject.toml"])
def test_engine_that_is_shown_is_the_one_that_passes_the_contract(file: str) -> None:
    page = (DOCS / "how_to/add_engine.md").read_text(encoding="utf-8")
    assert f"\n{(DOCS.parent / 'tests/plugin' / file).read_text(encoding='utf-8')}```\n" in page


def markers(picture: Path) -> list[float]:
    """Give the places of all markers along the axis: fonts differ from machine to machine, they do not."""
    return [float(x) for x in re.findall(r'<use xlink:href="#m\w+" x="([\d.]+)"', picture.read_text(encoding="utf-8"))]


def test_picture_is_that_of_the_measured_table_and_of_another_table_another_one(tmp_path: Path) -> None:
    shown, table = markers(DOCS / "_static" / "errors.svg"), pd.read_csv(DOCS / "results/accuracy.csv")
    program("pictures").draw_errors(DOCS / "results/accuracy.csv", tmp_path / "errors.svg")
    assert len(shown) > 60
    assert markers(tmp_path / "errors.svg") == pytest.approx(shown, abs=0.5)
    other = (table.engine == "mujoco") & (table.formulation == "joint") & (table.preset == "default")
    table.assign(**{"map, 800 [dB]": table["map, 800 [dB]"].mask(other, 1.0)}).to_csv(tmp_path / "accuracy.csv")
    program("pictures").draw_errors(tmp_path / "accuracy.csv", tmp_path / "errors.svg")
    assert markers(tmp_path / "errors.svg") != pytest.approx(shown, abs=0.5)


ENGINES = pd.read_csv(DOCS / "engines/table.csv", dtype=str).set_index("engine")


def test_table_of_engines_has_the_versions_that_were_measured() -> None:
    versions = re.search(r"\bVersions: (.*);", (DOCS / "results/chain.md").read_text(encoding="utf-8"), re.MULTILINE)
    measured = dict(entry.split(" ") for entry in versions[1].split(", "))
    assert ENGINES.version.to_dict() == {name: own for name, own in measured.items() if name != "reference"}


@pytest.mark.parametrize("name", ENGINES.index)
def test_page_of_an_engine_begins_with_the_version_and_precision_of_the_table(name: str) -> None:
    page, _, _ = ENGINES.page[name].partition("#")
    title = re.split(r" \(|,", engine(name).capabilities.title)[0]
    said = re.search(
        rf"^##? {title}\n+Version ([\d.]+)(?: \(\w+\))?, (\w+) precision",
        (DOCS / "engines" / page).read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    assert said
    assert said.groups() == (ENGINES.version[name], engine(name).capabilities.precision)


LICENCES_BESIDE = {
    "pin": "BSD-3-Clause",  # the licence that is in the wheel has the two clauses
    "exudyn": "LicenseRef-EXUDYN-General-License",  # has the text of the three clauses
    "drake": "Various",  # of what it is built from; its own has three clauses
}
"""What distributions say of their licence, where it is not its name."""


OF_PIP = [name for name in ENGINES.index if not engine(name).capabilities.package.startswith("python3-")]
"""Engines whose distributions state a licence; Debian's are not pip's."""


@pytest.mark.parametrize("name", OF_PIP)
def test_licence_of_an_engine_is_the_one_that_its_installed_distribution_states(name: str) -> None:
    own = engine(name).capabilities
    try:
        stated = metadata.metadata(own.package)
    except metadata.PackageNotFoundError:
        pytest.skip(f"no distribution {own.package} is installed")
    said = stated.get("License-Expression") or stated.get("License") or ""
    expected = LICENCES_BESIDE.get(own.package, own.licence)
    assert said.replace(" ", "-").casefold() == expected.casefold()


@pytest.mark.parametrize("name", [name for name in engine_names() if name != "reference"])
def test_table_of_laws_has_every_preset_that_states_how_it_steps_and_no_other(name: str) -> None:
    rows = re.findall(
        rf"^\| ({name}:\S+) \|", (DOCS / "theory/step_models.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    stating = [
        f"{own.engine}:{own.formulation}:{own.preset_name}"
        for own in variants_of(name, optional=True)
        if own.preset.shares_scheme or law_of(own)
    ]
    assert stating
    assert sorted(rows) == sorted(stating)


def test_table_of_stated_accuracies_is_that_of_the_presets() -> None:
    page = (DOCS / "theory/agreement.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([\w:-]+)` \| ([\d.–]+) \| ([\d.–]+) \| ([\d.–]+) \| (.*) \|$", page, re.MULTILINE)
    shown = {name: (*(float(value.replace("–", "0")) for value in values), why) for name, *values, why in rows}
    every = [own for name in engine_names() for own in variants_of(name, optional=True) if own.preset.accuracy]
    assert every
    assert shown == {
        str(own): (
            pytest.approx(100 * own.preset.accuracy_of("transmittance")),
            own.preset.accuracy_of("drift"),
            pytest.approx(1e7 * own.preset.accuracy_of("creep")),
            own.preset.accuracy_reason,
        )
        for own in every
    }


def test_every_number_of_scenes_is_in_one_table() -> None:
    numbers = pd.read_csv(DOCS / "scenes/answers.csv").number.unique()
    patterns = program("tables").SCENE_TABLES.values()
    often = {number: sum(bool(re.search(own, number)) for own in patterns) for number in numbers}
    assert {number for number, count in often.items() if count != 1} == {
        name for name in often if name.startswith("cost")
    }


def test_no_page_has_a_word_that_readers_should_not_meet() -> None:
    """`python docs/words.py` names them, and what to write."""
    assert not [*program("words").by_hand()]


def test_no_recipe_and_no_help_has_such_a_word() -> None:
    assert not [*program("words").of_the_product()]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a lane of unsteady motion", ["lane", "unsteady"]),
        ("Coulomb's law; `truth list` and the option --store", []),
        ("the engine's own law, 400 steps a period", ["law", "steps a period"]),
        ("```\na lane\n```\nboxes hop", ["hop"]),
    ],
)
def test_words_are_found_in_prose_and_not_in_code(text: str, words: list[str]) -> None:
    assert sorted(hit.word for hit in program("words").found("page", text)) == sorted(words)
