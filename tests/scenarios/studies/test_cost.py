"""Points of which the cost of an engine is measured: as many as fill the time, spread over friction and frequency."""

import numpy as np
import pytest

from engines.interface.variant import Variant
from scenarios.studies.cost import LEAST_BATCHES, MOST_BATCHES, _batches


@pytest.mark.parametrize(
    ("point", "seconds", "batches", "lanes"),
    [
        (0.01, 100.0, MOST_BATCHES, 64),
        (0.1, 100.0, 16, 64),
        (1.0, 1.0, LEAST_BATCHES, 1),
        (1.0, 32.0, LEAST_BATCHES, 8),
    ],
)
def test_points_fill_the_time_in_batches_of_64_at_most(point, seconds, batches, lanes) -> None:
    chosen = _batches(Variant("reference"), point, seconds)
    assert [len(batch) for batch in chosen] == [lanes] * batches
    tasks = [task for batch in chosen for task in batch]
    assert 0.1 < min(task.friction_ratio for task in tasks) < max(task.friction_ratio for task in tasks) < 1.0
    etas = np.array([task.frequency_ratio for task in tasks])
    assert np.all((etas >= 0.3) & (etas < 1.6))
