"""Short questions about one contact: a block that is pressed on a carrier, in SI units and at three scales."""
