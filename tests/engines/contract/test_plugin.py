"""An engine in an installable package of its own: found, listed and held to the contract, with nothing edited."""

import json
from pathlib import Path


def test_installed_engine_is_listed(install) -> None:
    rows = {row["engine"]: row for row in json.loads(install("plugin").run("-m", "engines", "--json"))}
    assert rows["tiny"]["version"] == "1.2.3"
    assert rows["tiny"]["missing"] is None


def test_installed_engine_is_held_to_the_contract(install) -> None:
    command = "-m pytest -q -n 0 -p no:cacheprovider --pyargs engines.contract --engine tiny"
    printed = install("plugin").run(*command.split())
    assert int(printed.rsplit(" passed", 1)[0].split()[-1]) >= 20


def test_contract_refuses_an_engine_that_is_not_there(install) -> None:
    command = "-m pytest -q -n 0 -p no:cacheprovider --pyargs engines.contract --engine tinny"
    install("plugin").run(*command.split(), code=4)


def test_installed_engine_is_compared_in_the_report(install, tmp_path: Path) -> None:
    script = (
        "from pathlib import Path\n"
        "from scenarios.execution.evaluator import Evaluator\n"
        "from scenarios.execution.local_processes import LocalExecutor\n"
        "from scenarios.studies.figure3 import figure3\n"
        "from scenarios.sweeps.compared import compare_sweep\n"
        "from engines.interface.variant import Variant\n"
        "from scenarios.execution.store import ResultStore\n"
        "if __name__ == '__main__':\n"
        "    sweep = figure3((Variant('tiny'),), (0.3,), (0.9, 1.3))\n"
        f"    file = Path({str(tmp_path / 'store.sqlite')!r})\n"
        "    with ResultStore(file) as store, Evaluator(store, LocalExecutor(1)) as evaluator:\n"
        "        points = compare_sweep(sweep, evaluator).curve(Variant('tiny'), sweep.cases[0])\n"
        "    print([str(point.comparison.verdict) for point in points])\n"
    )
    file = tmp_path / "compare.py"
    file.write_text(script)
    assert install("plugin").run(str(file)).strip() == "['agree', 'agree']"
