"""Pages of the documentation that are made by programs, and its pictures, are what these programs make now."""

import re
import runpy
from pathlib import Path

import pytest

from multibody_xval.engines.interface.laws import law_of
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import variants_of

DOCS = Path(__file__).parents[1] / "docs"


def drawn(table: Path, picture: Path) -> list[float]:
    """Draw a table by the documentation's own program, and give the markers."""
    runpy.run_path(str(DOCS / "pictures.py"))["draw_errors"](table, picture)
    return markers(picture)


@pytest.mark.parametrize("file", ["tiny_engine/__init__.py", "pyproject.toml"])
def test_engine_that_is_shown_is_the_one_that_passes_the_contract(file: str) -> None:
    page = (DOCS / "tutorials/own_engine.md").read_text(encoding="utf-8")
    assert f"\n{(DOCS.parent / 'tests/plugin' / file).read_text(encoding='utf-8')}```\n" in page


def markers(picture: Path) -> list[float]:
    """Give the places of all markers along the axis: fonts differ from machine to machine, they do not."""
    return [float(x) for x in re.findall(r'<use xlink:href="#m\w+" x="([\d.]+)"', picture.read_text(encoding="utf-8"))]


def test_picture_is_that_of_the_measured_table_and_of_another_table_another_one(tmp_path: Path) -> None:
    shown, table = markers(DOCS / "_static" / "errors.svg"), (DOCS / "accuracy.md").read_text(encoding="utf-8")
    assert len(shown) > 60
    assert drawn(DOCS / "accuracy.md", tmp_path / "errors.svg") == pytest.approx(shown, abs=0.5)
    row = next(line for line in table.splitlines() if line.startswith("| mujoco | joint | default |"))
    (tmp_path / "accuracy.md").write_text(table.replace(row, row.replace(row.split("|")[6], " 1.000 ", 1)))
    assert drawn(tmp_path / "accuracy.md", tmp_path / "errors.svg") != pytest.approx(shown, abs=0.5)


def test_table_of_engines_has_all_that_were_measured_with_licence_version_precision_and_page() -> None:
    versions = re.search(r"^Versions: (.*);", (DOCS / "accuracy.md").read_text(encoding="utf-8"), re.MULTILINE)
    measured = dict(entry.split(" ") for entry in versions[1].split(", "))
    index = (DOCS / "engines" / "index.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| \[([^]]+)\]\((\w+)\.md\)[^|]*\| ([\d.]+), (\w+) \| ([^|]+) \|", index, re.MULTILINE)
    expected = set()
    for name in measured.keys() - {"reference"}:
        own, page = engine(name).capabilities, "exudyn" if name.startswith("exudyn-") else name.replace("-", "_")
        licence = own.licence.removeprefix("LicenseRef-").replace("A-O", "A O")
        expected.add((re.split(r" \(|,", own.title)[0], page, measured[name], own.precision, licence))
    assert len(rows) == len(measured) - 1
    assert set(rows) == expected
    assert all((DOCS / "engines" / f"{page}.md").is_file() for _, page, *_ in rows)


@pytest.mark.parametrize("name", [name for name in engine_names() if name != "reference"])
def test_table_of_laws_has_every_preset_that_states_how_it_steps_and_no_other(name: str) -> None:
    rows = re.findall(rf"^\| ({name}:\S+) \|", (DOCS / "laws.md").read_text(encoding="utf-8"), re.MULTILINE)
    stating = [
        f"{own.engine}:{own.formulation}:{own.preset_name}"
        for own in variants_of(name, optional=True)
        if own.preset.shares_scheme or law_of(own)
    ]
    assert stating
    assert sorted(rows) == sorted(stating)


def test_table_of_stated_accuracies_is_that_of_the_presets() -> None:
    page = (DOCS / "agreement.md").read_text(encoding="utf-8")
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
