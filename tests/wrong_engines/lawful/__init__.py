"""An engine whose default stops a contact in four steps, as its law says."""

from tests.wrong_engines.faulty import Faulty


class Lawful(Faulty):
    """The sound one, with a law beside it."""

    name = "faulty-lawful"
