"""One period of an engine beside that of its law, from the same state."""

from dataclasses import dataclass
from typing import Any, Self

from scenarios.tasks.task import SteadyStateTask, law_identity


@dataclass(frozen=True, kw_only=True)
class LawPeriodTask(SteadyStateTask):
    """A period of the engine and of its law from the same state, to which the law leads from rest.

    The result's series has ``distance``, the largest difference of positions, and ``reference``, that of the engine
    from the reference, both over the displacement scale. The parameters are those of `SteadyStateTask`.
    """

    @classmethod
    def of(cls, task: SteadyStateTask) -> Self:
        """Compare the period of a task."""
        return cls(**vars(task))

    def as_data(self) -> dict[str, Any]:
        """Give the task as plain data, distinguished from the steady state."""
        return super().as_data() | {"recorded": "law"}

    def content(self) -> dict[str, Any]:
        """Everything that the result depends on: the law, too."""
        return super().content() | law_identity(self.variant)
