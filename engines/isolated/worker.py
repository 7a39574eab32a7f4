"""The other end of the pipe: a loop that runs in another Python and serves one engine.

It is started as ``python3 -I worker.py SERVER``, where SERVER is a file that defines

- ``versions()``: a dictionary of versions, with the engine's own under ``"engine"``;
- ``EngineLane(parameters)``: one chain, with ``run(position, velocity, loads, record)``, which gives a dictionary of
  arrays with one row a step (position and velocity alone where nothing is recorded).
  Where the normal force changes in time, ``run`` gets ``normal_load``, a row a step; where contacts open, also
  ``across``, gaps and their rates at the start, and gives ``gap`` and ``gap_rate``, recorded or not;
- or else ``scene(parameters)``, whose functions are those of `multibody_xval.engines.interface.scene.SteppedWorld`.

A message is a pickled dictionary of the data type, the shape and the bytes of every array: a pickled array would need
the other side's version of NumPy. An ``npz`` file holds the same, and takes as long as a hundred steps of a fast
engine. This file runs in Pythons whose packages are older than the suite's: it needs NumPy only, and never imports the
suite.
"""

import faulthandler
import os
import pickle
import platform
import signal
import sys
import traceback
from collections.abc import Callable, Mapping
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from typing import Any, BinaryIO

import numpy as np

Message = dict[str, Any]
"""Arrays by name."""

MOTION = ("position", "velocity")
"""What is left of the rows of a run of which only the end is requested."""

NORMAL_LOAD, GAPS = ("normal_load", "across"), ("gap", "gap_rate")
"""What a run is given, and what it gives, of a normal force that changes in time."""


class NotAMessage(ValueError):
    """What arrived is no message: something else writes to the pipe."""


def write_message(stream: BinaryIO, message: Mapping[str, Any]) -> None:
    """Write arrays, numbers and texts by name."""
    arrays = {name: np.asarray(value) for name, value in message.items()}
    plain = {name: (array.dtype.str, array.shape, array.tobytes()) for name, array in arrays.items()}
    pickle.dump(plain, stream, protocol=4)
    stream.flush()


def read_message(stream: BinaryIO) -> Message:
    """Read arrays by name; raises `EOFError` at the end of the stream, and `NotAMessage` for anything else."""
    arrays: Message = {}
    try:
        for name, (kind, shape, held) in pickle.load(stream).items():
            assert not np.dtype(kind).hasobject, "addresses of another process are among them"
            arrays[name] = np.ndarray(shape, kind, held).copy()  # which may be written to
    except EOFError:
        raise
    except Exception as problem:  # of whatever other bytes are taken for
        raise NotAMessage(f"what arrived holds no arrays: {problem}") from problem
    return arrays


class Service:
    """Handles the requests for one engine; lanes are known by the numbers that the other side gives them."""

    def __init__(self, load: Callable[[], Any]):
        self._load = load
        self._lanes: dict[int, Any] = {}

    def reply_to(self, request: Message) -> Message:
        """Handle a request; an exception becomes a reply, and the worker lives on."""
        _end_at(float(request["limit"]))
        try:
            for number in request["release"].tolist():
                self._lanes.pop(number, None)
            handler = getattr(self, "_" + str(request["request"]))
            return handler(request)
        except BaseException as problem:  # whatever it is, an end of the program too: the other side has to get it
            return {"error": str(problem), "kind": type(problem).__name__, "traceback": traceback.format_exc()}
        finally:
            sys.stdout.flush()
            _end_at(0.0)

    def _versions(self, _request: Message) -> Message:
        return {"python": platform.python_version(), **self._load().versions()}

    def _build(self, request: Message) -> Message:
        server = self._load()
        build = server.scene if hasattr(server, "scene") else server.EngineLane
        self._lanes[int(request["number"])] = build(request)
        return {}

    def _run(self, request: Message) -> Message:
        lane = self._lanes[int(request["number"])]
        record = bool(request["record"])
        normal_load = {name: request[name] for name in NORMAL_LOAD if name in request}
        rows = lane.run(request["position"], request["velocity"], request["loads"], record, **normal_load)
        if record:
            return dict(rows)
        return {name: rows[name][-1:] for name in (*MOTION, *GAPS) if name in rows}

    def _follow(self, request: Message) -> Message:
        scene, rows = self._lanes[int(request["number"])], []
        if request["launch"].size:
            *velocity, spin = request["launch"].tolist()
            scene.launch(velocity, spin)
        for _ in range(int(request["steps"])):
            for force in request["push"].tolist():
                scene.push(force)
            scene.step()
            rows.append(np.concatenate(scene.state(), axis=None))
        return {"rows": np.array(rows)}


def _end_at(seconds: float) -> None:
    """Let the kernel end this process so late from now, even inside compiled code or without a parent; never, for 0."""
    signal.setitimer(signal.ITIMER_REAL, seconds)


def _server(path: str) -> Any:
    """Load the file of the server, under a name that hides no package."""
    name = "engine_server"
    if name not in sys.modules:
        spec = spec_from_loader(name, SourceFileLoader(name, path))
        assert spec is not None
        assert spec.loader is not None
        module = module_from_spec(spec)
        sys.dont_write_bytecode = True
        spec.loader.exec_module(module)
        sys.modules[name] = module
    return sys.modules[name]


def main() -> None:
    """Serve until the other side closes the pipe, or dies; a crash leaves on the error stream where it was."""
    faulthandler.enable(all_threads=False)
    faulthandler.register(signal.SIGALRM, all_threads=False, chain=True)
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    # What an engine prints goes to the error stream, and it reads nothing: the pipes are the protocol's.
    os.dup2(2, 1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    service = Service(lambda: _server(sys.argv[1]))
    while True:
        try:
            request = read_message(requests)
        except EOFError:
            return
        write_message(replies, service.reply_to(request))


if __name__ == "__main__":
    main()
