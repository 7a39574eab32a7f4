"""Known deviations that several engines share, as `Preset.known_deviation` says them."""

IMPLICIT_SPRINGS = (
    "springs are implicit and damp as dashpots of k dt beside them would, about as strongly as its own: "
    "the error is of first order, but not yet in proportion to the step"
)
