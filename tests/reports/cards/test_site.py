"""A site of engines by version: what changed is on the pages and in the feed, and strangers' files do no harm."""

import dataclasses
import json
import xml.etree.ElementTree as ET

import pytest

from reference_lcp.errors import ParameterError
from reference_lcp.process import run_command
from reports.cards.site import engine_histories, write_site
from reports.cards.write import write_card
from reports.cli.console_script import app
from tests.reports.cards.test_cards import made_up

CREEP = "contact block-held velocity"
ATOM = "{http://www.w3.org/2005/Atom}"


def written(folder, name, *versions):
    """Write a history: version, date, creep."""
    known = [
        {"version": version, "date": date, "numbers": {CREEP: creep} if creep is not None else {}, "reason": reason}
        for version, date, creep, reason in versions
    ]
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps({"engine": name, "versions": known}))


@pytest.fixture
def results(tmp_path):
    folder = tmp_path / "results"
    written(
        folder, "mujoco", ("3.10.0", "2026-01-02", 1e-3, ""), ("3.9.0", "2026-01-01", 1e-3, ""), ("4.0", "", 2e-3, "")
    )
    written(folder, "rapier", ("0.36.1", "2026-02-01", 1e-6, ""), ("0.35", "2026-01-15", None, "no <wheel>"))
    return folder


def test_versions_are_in_their_order_and_changes_are_on_page_and_feed(results, tmp_path, capsys):
    out = tmp_path / "site"
    assert run_command(app, ["site", str(results), "--out", str(out)]) == 0
    assert capsys.readouterr().out.strip() == str(out / "index.html")
    assert {file.name for file in out.iterdir()} == {"index.html", "mujoco.html", "rapier.html", "feed.xml"}
    page = (out / "mujoco.html").read_text()
    assert "3 versions, 3.9.0 to 4.0" in page
    assert f'<td class="text">{CREEP}</td><td class="n">0.001</td><td class="n">0.002</td><td>worse</td>' in page
    assert "no &lt;wheel&gt;" in (out / "rapier.html").read_text()
    assert '<a href="rapier.html">rapier</a></th><td class="n">2</td><td>0.36.1</td><td class="text">none' in (
        (out / "index.html").read_text()
    )
    (entry,) = ET.parse(out / "feed.xml").getroot().findall(f"{ATOM}entry")
    assert entry.findtext(f"{ATOM}title") == "mujoco 4.0"
    assert entry.findtext(f"{ATOM}content") == f"{CREEP}: 0.001 in 3.10.0, 0.002 in 4.0, worse"


def test_a_line_falls_where_an_error_does(results):
    mujoco = engine_histories(results)[0]
    first, second, third = (float(point.split(",")[1]) for point in mujoco.line(CREEP).split())
    assert first == second > third, "down on the screen is a smaller number"


def test_cards_are_versions_too_and_their_charts_and_badges_are_not(results, tmp_path):
    (results / "cards").mkdir()
    write_card(dataclasses.replace(made_up(), name="mujoco@3.10.0", version="3.10.0"), results / "cards")
    mujoco = engine_histories(results)[0]
    assert [one.version for one in mujoco.versions] == ["3.9.0", "3.10.0", "4.0"]
    numbers = mujoco.versions[1].numbers
    assert numbers[CREEP] == 1e-3
    assert numbers["joint:default: error to truth, largest [dB]"] == 14.7321
    assert numbers["joint:default: error of breakaway, 1 kg, 2 ms"] == pytest.approx(0.1262)
    assert write_site([mujoco], tmp_path / "site")[0].name == "index.html"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "neither a history nor a card"),
        ("[]", "neither a history nor a card"),
        ('{"engine": "a"}', "neither a history nor a card"),
        (
            '{"engine": "a", "versions": [{"version": "new", "date": "", "numbers": {}, "reason": ""}]}',
            "neither a history",
        ),
        (
            '{"engine": "../a", "versions": [{"version": "1", "date": "", "numbers": {}, "reason": ""}]}',
            "engine = '../a'",
        ),
        ('{"engine": "a", "versions": [{"version": "1", "date": "", "numbers": {"x": NaN}, "reason": ""}]}', "finite"),
    ],
)
def test_another_file_is_refused(text, message, tmp_path):
    (tmp_path / "other.json").write_text(text)
    with pytest.raises(ParameterError, match=message):
        engine_histories(tmp_path)


def test_an_empty_folder_is_refused(tmp_path):
    with pytest.raises(ParameterError, match=r"has neither a history nor a card"):
        engine_histories(tmp_path)


def test_texts_of_a_strangers_file_are_no_markup(tmp_path):
    evil = {"version": "1", "date": "", "numbers": {"<script>": 1.0}, "reason": "</p><script>"}
    later = {"version": "2", "date": "", "numbers": {"<script>": 2.0}, "reason": ""}
    (tmp_path / "a.json").write_text(json.dumps({"engine": "a", "versions": [evil, later]}))
    for file in write_site(engine_histories(tmp_path), tmp_path / "site"):
        assert "<script>" not in file.read_text()
