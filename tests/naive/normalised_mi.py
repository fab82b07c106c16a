"""Normalised mutual information, sample by sample, straight from the equations."""

import math

from naive.mattes import joint


def entropy(shares):
    return -sum(share * math.log(share) for share in shares if share > 0)


def value(fixed, moving, weight, fixed_range, moving_range, bins):
    """Minus the sum of both entropies by the joint one."""
    shares = joint(fixed, moving, weight, fixed_range, moving_range, bins)
    fixed_shares, moving_shares = map(sum, shares), map(sum, zip(*shares, strict=True))
    both = entropy(share for row in shares for share in row)
    return -(entropy(fixed_shares) + entropy(moving_shares)) / both
