"""When results agree: the judge, and what it is applied to."""
