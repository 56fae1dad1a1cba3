"""95 % intervals of measured figures."""

import math

Z_95 = 1.959964


def wilson(count: int, cases: int) -> tuple[float, float]:
    """Of a rate: Wilson's score interval (1927)."""
    share, square = count / cases, Z_95**2 / cases
    centre = (share + square / 2) / (1 + square)
    half = Z_95 * math.sqrt((share * (1 - share) + square / 4) / cases) / (1 + square)
    return max(0.0, centre - half), min(1.0, centre + half)


def median_of(numbers: list[float]) -> tuple[float, float] | None:
    """Of the median, by order statistics: no assumption about the distribution. None for fewer than six numbers."""
    ordered, cases = sorted(numbers), len(numbers)
    below = 0.0  # probability that at most `rank` numbers lie below the median
    for rank in range(cases // 2):
        below += math.comb(cases, rank) / 2**cases
        if below > 0.025:
            return (ordered[rank - 1], ordered[cases - rank]) if rank > 0 else None
    return None
