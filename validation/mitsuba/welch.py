"""Welch's test of two means over replicates, and what it would have seen. Needs numpy and SciPy."""

import math

import numpy
import scipy.special


def student_p(t, dof):
    """Two-sided p-value of Student's t."""
    return float(2 * scipy.special.stdtr(dof, -abs(t)))


def student_quantile(p, dof):
    """The t whose two-sided p-value is p."""
    return float(-scipy.special.stdtrit(dof, p / 2))


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
