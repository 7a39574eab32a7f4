"""Proofs of band edges: levels on both sides of each, and where no other crossing is left out."""

from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cache
from itertools import pairwise

from multibody_xval.scenarios.report_plan import grid
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.prove import prove

EDGES = (
    (0.0, 0.8526), (0.0, 1.4142), (0.1, 0.7533), (0.3, 0.6373), (0.6, 0.7559), (1.0, 0.9988), (5.0, 1.1725)
)  # fmt: skip
"""Band edges of figure 3, friction and frequency ratio; all but the second are lower ones."""

EDGE_WIDTH = 1e-4
"""In η_r, within which an edge is proven: the last digit that is printed."""


@dataclass(frozen=True)
class EdgeProof:
    """What is proven of a band edge: the levels on both sides of it."""

    friction_ratio: float
    sides: tuple[float, float]
    """In η_r."""
    levels_db: tuple[Decimal, Decimal]
    alone: tuple[float, float] | None
    """Between which frequency ratios the level is nowhere else 0 dB; ``None`` where contacts slip: it is not shown."""

    @property
    def crosses(self) -> bool:
        """Whether the level crosses 0 dB in between: it is continuous, since the steady state is unique."""
        return self.levels_db[0] * self.levels_db[1] < 0

    def __str__(self) -> str:
        where = f"between {self.sides[0]:g} and {self.sides[1]:g}" if self.crosses else f"not at {self.sides}"
        other = (
            f"no other between {self.alone[0]:.5f} and {self.alone[1]:.5f}" if self.alone else "another is not excluded"
        )
        return f"friction {self.friction_ratio:g}: an edge of the band is {where}, proven; {other}"


def edge_proofs() -> list[EdgeProof]:
    """Prove the levels at both sides of every edge in `EDGES`."""
    return [
        EdgeProof(friction, sides, (_level(friction, sides[0]), _level(friction, sides[1])), _alone(friction, sides))
        for friction, edge in EDGES
        for sides in [(round(edge - EDGE_WIDTH / 2, 6), round(edge + EDGE_WIDTH / 2, 6))]
    ]


def _alone(friction_ratio: float, sides: tuple[float, float]) -> tuple[float, float] | None:
    """Give the ratios around both sides between which the linear motion crosses 0 dB once, and no contact slips."""
    for low, high, crossings in _linear(friction_ratio):
        within = [place for place in crossings if sides[0] < place < sides[1]]
        if low < sides[0] and sides[1] < high and len(within) == 1:
            before, after = ([p for p in crossings if p < sides[0]], [p for p in crossings if p > sides[1]])
            return max([low, *before]), min([high, *after])
    return None


def _frequency_ratios() -> list[float]:
    """Give the frequency ratios of the default grid."""
    return sorted({case.frequency_ratio for case in grid(quick=False)})


def known_steps(friction_ratio: float) -> tuple[int, int]:
    """Give in how many steps of the default grid no contact slips, so that all crossings are known; of how many."""
    steps = list(pairwise(_frequency_ratios()))
    ranges = _linear(friction_ratio)
    return sum(any(low <= a and b <= high for low, high, _ in ranges) for a, b in steps), len(steps)


@cache
def _linear(friction_ratio: float) -> list[tuple[float, float, list[float]]]:
    """Give the ranges of the default grid without slip, and the crossings in them, as doubles."""
    from reference_lcp.exact.proof.linear import linear_ranges

    ends = _frequency_ratios()
    exact = ExactChain.from_ratios(friction_ratio=friction_ratio, frequency_ratio=1)
    ranges = linear_ranges(exact, Fraction(str(ends[0])), Fraction(str(ends[-1])))
    return [(float(each.low), float(each.high), [float(place) for place in each.crossings]) for each in ranges]


def _level(friction_ratio: float, frequency_ratio: float) -> Decimal:
    exact = ExactChain.from_ratios(friction_ratio=friction_ratio, frequency_ratio=frequency_ratio)
    return prove(exact).transmittance_db.value
