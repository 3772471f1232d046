"""Welch's test of two means over replicates, and what it would have seen. Needs numpy alone."""

import math

import numpy


def _fraction(a, b, x):
    """Continued fraction of the incomplete beta function, by Lentz's method (NIST DLMF 8.17.22)."""
    tiny = 1e-300
    c, d = 1.0, 1 / max(1 - (a + b) * x / (a + 1), tiny)
    value = d
    for m in range(1, 400):
        for term in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d = 1 + term * d
            c = 1 + term / c
            d = 1 / (d if abs(d) > tiny else tiny)
            c = c if abs(c) > tiny else tiny
            value *= c * d
        if abs(c * d - 1) < 1e-15:
            break
    return value


def _incomplete_beta(a, b, x):
    """I_x(a, b), regularised."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x))
    if x < (a + 1) / (a + b + 2):
        return front * _fraction(a, b, x) / a
    return 1 - front * _fraction(b, a, 1 - x) / b


def student_p(t, dof):
    """Two-sided p-value of Student's t."""
    return _incomplete_beta(dof / 2, 0.5, dof / (dof + t * t))


def student_quantile(p, dof):
    """The t whose two-sided p-value is p, by bisection."""
    low, high = 0.0, 1.0
    while student_p(high, dof) > p:
        high *= 2
    for _ in range(48):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if student_p(middle, dof) > p else (low, middle)
    return 0.5 * (low + high)


def sidak(level, tests):
    """The level of each of so many tests of which one or more fail by chance with probability `level`."""
    return -math.expm1(math.log1p(-level) / tests)


POWER = 0.9


def differences(ours, theirs):
    """Per channel: both means, standard error of their difference, t, degrees of freedom."""
    with numpy.errstate(divide="ignore", invalid="ignore"):
        mean_a, mean_b = ours.mean(axis=0), theirs.mean(axis=0)
        part_a, part_b = ours.var(axis=0, ddof=1) / len(ours), theirs.var(axis=0, ddof=1) / len(theirs)
        error = numpy.sqrt(part_a + part_b)
        dof = error**4 / (part_a**2 / (len(ours) - 1) + part_b**2 / (len(theirs) - 1))
        return mean_a, mean_b, error, (mean_a - mean_b) / error, dof


def channel_p(difference, error, t, dof):
    """Of one channel. Without any error it is equal or not; what is not finite is a difference."""
    if not (math.isfinite(difference) and math.isfinite(error)):
        return 0.0
    if error == 0:
        return float(difference == 0)
    return student_p(abs(t), dof)


def sidak_p(each):
    """From p-values of channels to one over all (Šidák, which bounds two-sided tests of any correlation)."""
    smallest = float(numpy.min(each))
    return -math.expm1(len(each) * math.log1p(-smallest)) if smallest < 1 else 1.0


def largest_difference(mean_a, mean_b):
    """Relative difference of largest size and its channel; NaN if no channel has one (0/0)."""
    with numpy.errstate(divide="ignore", invalid="ignore"):
        relative = mean_a / mean_b - 1
    worst = int(numpy.argmax(numpy.where(numpy.isnan(relative), -1, numpy.abs(relative))))
    return float(relative[worst]), worst


def detectable(mean, error, dof, each):
    """Biases relative to the mean that are found with probability POWER at the level `each`, of channels that vary."""
    seen = [
        (student_quantile(each, d) + student_quantile(2 * (1 - POWER), d)) * e / abs(m)
        for m, e, d in zip(mean, error, dof)
        if math.isfinite(e) and e > 0 and math.isfinite(m) and m != 0
    ]
    if not seen:
        return {"typical": math.nan, "largest": math.nan, "power": POWER}
    return {"typical": float(numpy.median(seen)), "largest": float(max(seen)), "power": POWER}


def compare(ours, theirs, level):
    """ours, theirs: [replicate][channel], image means. level: of all channels together.

    Returns what differences() does, the p-value over the channels (0 where a mean is not finite), and the biases relative to the
    mean that are found with probability POWER: of the median channel and of the worst.
    """
    mean_a, mean_b, error, t, dof = differences(ours, theirs)
    p = sidak_p([channel_p(*channel) for channel in zip(mean_a - mean_b, error, t, dof)])
    largest, worst = largest_difference(mean_a, mean_b)
    with numpy.errstate(divide="ignore", invalid="ignore"):
        difference_all = float(mean_a.sum() / mean_b.sum() - 1)
    return {
        "ours": mean_a.tolist(),
        "theirs": mean_b.tolist(),
        "error": error.tolist(),
        "t": t.tolist(),
        "dof": dof.tolist(),
        "p": p,
        "level": level,
        "passed": bool(p >= level),
        "largest_difference": largest,
        "largest_difference_channel": worst,
        "difference_all": difference_all,
        "detectable": detectable(mean_b, error, dof, sidak(level, len(t))),
    }
