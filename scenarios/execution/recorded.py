"""One period of a steady state in full: what answers leave out, at the few places where it is drawn."""

import io
import os
import sqlite3
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from queue import SimpleQueue

import numpy as np
from numpy.typing import NDArray

from engines.interface.variant import Variant
from reference_lcp.observables.stick_slip import contact_modes
from reference_lcp.steady.orbits import PeriodicOrbit, periodic_orbits
from reference_lcp.validation import FloatArray, checked_count, checked_scalar
from scenarios.execution.evaluator import unavailable_reason
from scenarios.execution.local_processes import TIME_LIMIT, Batch, ProcessWorker, WorkerDied
from scenarios.tasks.task import SteadyStateTask

_EMPTY = np.empty((0, 0))


@dataclass(frozen=True)
class RecordedPeriod:
    """One period, non-dimensional, or the reason why there is none.

    Row k belongs to the time (k + 1) / steps of the period.

    Parameters
    ----------
    reason
        Why there is no steady state to be drawn; empty if there is one.
    outer, inner
        Displacements over the displacement scale U0, shape (steps, n).
    friction
        λ_T over the bound μ λ_N of each contact, over k_c U0 where that is zero; shape (steps, n).
    modes
        −1 backward slip, 0 stick, +1 forward slip; shape (steps, n).
    """

    reason: str = ""
    outer: FloatArray = field(default_factory=_EMPTY.copy)
    inner: FloatArray = field(default_factory=_EMPTY.copy)
    friction: FloatArray = field(default_factory=_EMPTY.copy)
    modes: NDArray[np.int8] = field(default_factory=lambda: _EMPTY.astype(np.int8))

    @property
    def known(self) -> bool:
        """Whether there is a steady state."""
        return not self.reason

    @property
    def relative(self) -> FloatArray:
        """Displacement of the inner mass relative to the outer one, over U0; shape (steps, n)."""
        return self.inner - self.outer

    @property
    def phase(self) -> FloatArray:
        """Time over the period, shape (steps,)."""
        steps = self.outer.shape[0]
        return np.arange(1, steps + 1) / steps

    @classmethod
    def of(cls, orbit: PeriodicOrbit, stick_margin: float) -> "RecordedPeriod":
        """Read an orbit; for `stick_margin` see `contact_modes`."""
        if not orbit.converged:
            return cls(f"{orbit.status} after {orbit.periods} periods, residual {orbit.residual:.1e}")
        chain, trajectory = orbit.lane.chain, orbit.trajectory
        scale = orbit.lane.drive.displacement_scale(chain)
        bound = np.where(chain.friction_bound > 0, chain.friction_bound, chain.chain_stiffness * scale)
        return cls(
            outer=trajectory.outer_positions / scale,
            inner=trajectory.inner_positions / scale,
            friction=trajectory.friction / bound,
            modes=contact_modes(orbit, stick_margin),
        )

    def to_bytes(self) -> bytes:
        """Give the arrays of a known motion as a compressed archive."""
        file = io.BytesIO()
        np.savez_compressed(file, outer=self.outer, inner=self.inner, friction=self.friction, modes=self.modes)
        return file.getvalue()

    @classmethod
    def from_bytes(cls, content: bytes) -> "RecordedPeriod":
        """Read what `to_bytes` wrote."""
        with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
            return cls(**{name: arrays[name] for name in ("outer", "inner", "friction", "modes")})


class PeriodStore:
    """Motions in the same file as the answers, by the hash of their questions.

    Parameters
    ----------
    file
        A store of answers, see `ResultStore`.
    """

    def __init__(self, file: Path):
        self._file = file

    def find(self, question: SteadyStateTask) -> RecordedPeriod | None:
        """Give the motion of an equal question, or ``None``."""
        with closing(sqlite3.connect(self._file)) as connection:
            if not connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'motions'").fetchone():
                return None
            row = connection.execute("SELECT motion FROM motions WHERE key = ?", (question.key(),)).fetchone()
        return None if row is None else RecordedPeriod.from_bytes(row[0])

    def keep(self, question: SteadyStateTask, motion: RecordedPeriod) -> None:
        """Write one motion; those that are not known are not kept, so that they are tried again."""
        if not motion.known:
            return
        with closing(sqlite3.connect(self._file)) as connection, connection:
            connection.execute("CREATE TABLE IF NOT EXISTS motions (key TEXT PRIMARY KEY, motion BLOB NOT NULL)")
            connection.execute("INSERT OR REPLACE INTO motions VALUES (?, ?)", (question.key(), motion.to_bytes()))


def periods_of(batch: Batch) -> list[RecordedPeriod]:
    """Find the steady state of each question, one after the other; an engine that fails gives the reason."""
    return [_motion(question) for question in batch if isinstance(question, SteadyStateTask)]


def _motion(question: SteadyStateTask) -> RecordedPeriod:
    variant: Variant = question.variant
    lane, steps = question.lane()
    try:
        simulation = variant.build([lane])
        try:
            (orbit,) = periodic_orbits(simulation, steps, tolerance=variant.capabilities.residual)
        finally:
            simulation.close()
    except Exception as problem:  # whatever an engine raises is its result
        return RecordedPeriod(f"{type(problem).__name__}: {problem}")
    return RecordedPeriod.of(orbit, variant.preset.stick_margin)


def period_of(question: SteadyStateTask, time_limit: float = TIME_LIMIT) -> RecordedPeriod:
    """Compute one motion in a worker process; see `recorded_periods`."""
    missing = unavailable_reason(question.variant)
    if missing is not None:
        return RecordedPeriod(f"not installed: {missing}")
    (found,) = _computed([question], 1, checked_scalar("time_limit", time_limit, "> 0"))
    return found


def recorded_periods(
    questions: Sequence[SteadyStateTask],
    store: PeriodStore,
    *,
    ask: bool = True,
    workers: int | None = None,
    time_limit: float = TIME_LIMIT,
) -> Mapping[SteadyStateTask, RecordedPeriod]:
    """Give the motion of every question: from the store where it is known, from worker processes where not.

    Parameters
    ----------
    questions
        Whose steady states are wanted.
    store
        Where motions are looked up and kept.
    ask
        Whether what the store does not know is computed; without it, it is said to be missing.
    workers
        Worker processes on this machine; one a processor without it.
    time_limit
        Seconds that one motion may take; an engine that hangs is stopped then.

    Raises
    ------
    ParameterError
        If a number is outside its range.
    """
    checked_scalar("time_limit", time_limit, "> 0")
    places = checked_count("workers", workers if workers is not None else (os.cpu_count() or 1))
    found: dict[SteadyStateTask, RecordedPeriod] = {}
    unknown = []
    for question in questions:
        missing = unavailable_reason(question.variant)
        kept = None if missing else store.find(question)
        if missing:
            found[question] = RecordedPeriod(f"not installed: {missing}")
        elif kept is not None:
            found[question] = kept
        elif ask:
            unknown.append(question)
        else:
            found[question] = RecordedPeriod("not answered so far")
    for question, motion in zip(unknown, _computed(unknown, min(places, len(unknown)), time_limit), strict=True):
        store.keep(question, motion)
        found[question] = motion
    return found


def _computed(questions: Sequence[SteadyStateTask], places: int, limit: float) -> Iterator[RecordedPeriod]:
    """Compute motions in as many processes as there are places, in order: who dies takes no other motion along."""
    if not questions:
        return
    idle: SimpleQueue[ProcessWorker] = SimpleQueue()

    def one(question: SteadyStateTask) -> RecordedPeriod:
        worker = idle.get()
        try:
            motion: RecordedPeriod = worker.result(worker.submit([question], limit), limit)[0]
        except WorkerDied as death:
            return RecordedPeriod(str(death))
        finally:
            idle.put(worker)
        return motion

    with tempfile.TemporaryDirectory(prefix="multibody-xval-") as folder, ThreadPoolExecutor(places) as threads:
        workers = [ProcessWorker(Path(folder) / str(place), periods_of) for place in range(places)]
        try:
            for worker in workers:
                idle.put(worker)
            yield from threads.map(one, questions)
        finally:
            for worker in workers:
                worker.close()
