"""An engine whose law is another."""

from tests.wrong_engines.faulty import Faulty


class Lawless(Faulty):
    """The sound one, with a law beside it."""

    name = "faulty-lawless"
