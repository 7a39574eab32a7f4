"""Speed of the reference."""

from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.studies import bench


def test_the_speed_of_lanes_counts_every_step_of_every_cell(monkeypatch) -> None:
    monkeypatch.setattr(bench.timeit, "repeat", lambda *_, **__: [3.0, 2.0])
    steps = bench.BENCH_LANES * 7 * MINIMUM_STEPS_PER_PERIOD * bench.PERIODS_OF_A_SAMPLE
    assert bench._cell_steps_per_second() == steps / 2
