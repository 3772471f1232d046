"""Comparisons of cases: their deciding tests, what they would have seen, and tables of them."""

from markup import DASH, is_number, percent, probability, row, table, text, verdict_word

TESTS = {
    "mean/pixel": "means of pixels",
    "mean/tile": "means of 8×8 tiles",
    "mean/image": "mean of the image",
    "variance/pixel": "variances of pixels",
    "variance/tile": "variances of 8×8 tiles",
    "variance/image": "variance, pooled over the image",
    "scatter/image": "scatter, pooled over the image",
    "uniform/pixel": "p-values of the pixels",
    "uniform/tile": "p-values of the tiles",
    "finite": "values that are not finite",
}


def test_name(test):
    return TESTS.get(test.get("name"), text(test.get("name")))


def decisive(pairing):
    """The failed test with the smallest p, else the test with the smallest p; {} without tests."""
    tests = [t for t in pairing.get("tests") or [] if isinstance(t, dict)]
    failed = [t for t in tests if not t.get("passed")]
    return min(failed or tests, key=lambda t: t["p"] if is_number(t.get("p")) else 2, default={})


def pairing_name(pairing):
    if pairing.get("kind") == "closed form":
        return f"{text(pairing.get('a'))} against the closed form"
    return f"{text(pairing.get('a'))} against {text(pairing.get('b'))}" + (
        ", equal seeds" if pairing.get("kind") == "paired" else ""
    )


def detectable(pairing, names):
    """Smallest typical figure of the tests of these names, or None."""
    found = [(t.get("detectable") or {}).get("typical") for t in pairing.get("tests") or [] if t.get("name") in names]
    return min((v for v in found if is_number(v)), default=None)


def in_order(items):
    """Failed ones first, otherwise as they come."""
    return sorted(items, key=lambda item: bool(item.get("passed")))


NUMERIC = {3, 4, 5, 6, 8, 9}  # columns of the table of comparisons
HEADS = [
    "",
    "A",
    "B",
    "replicates × samples",
    "attempts",
    "smallest p",
    "level",
    "test",
    "detectable bias",
    "detectable change of variance",
]
VARIANCES = {"scatter/image", "variance/image"}


def _comparison_row(pairing):
    test = decisive(pairing)
    side_b = text(pairing.get("b")) + (", equal seeds" if pairing.get("kind") == "paired" else "")
    cells = [
        verdict_word(pairing.get("passed")),
        text(pairing.get("a")),
        side_b,
        f"{text(pairing.get('replicates'))} × {text(pairing.get('samples'))}",
        text(pairing.get("attempts")),
        probability(test.get("p")),
        probability(test.get("level")),
        text(test.get("name")),
        percent(detectable(pairing, {"mean/image"})),
        percent(detectable(pairing, VARIANCES)),
    ]
    return row(cells, NUMERIC, mark="" if pairing.get("passed") else "bad")


def comparison_table(case):
    """A row per comparison of the case."""
    return table(HEADS, [_comparison_row(p) for p in in_order(case["pairings"])], NUMERIC)


def _closest(pairings):
    """The deciding test that came closest to its level; {} without tests."""
    tests = [t for t in map(decisive, pairings) if is_number(t.get("p")) and t.get("level")]
    return min(tests, key=lambda t: t["p"] / t["level"], default={})


def _span(values):
    """Smallest and largest in percent."""
    values = [v for v in values if is_number(v)]
    if not values:
        return DASH
    low, high = percent(min(values)), percent(max(values))
    return low if low == high else f"{low.removesuffix(' %')} – {high}"


def _count_text(pairings):
    failed = sum(not p.get("passed") for p in pairings)
    repeated = sum((p.get("attempts") or 0) > 1 for p in pairings)
    return ", ".join(
        [str(len(pairings))] + [f"{n} {what}" for n, what in ((failed, "failed"), (repeated, "repeated")) if n]
    )


def _overview_row(case, anchor):
    test = _closest(case["pairings"])
    paired = [p for p in case["pairings"] if p.get("kind") == "paired"]
    others = [p for p in case["pairings"] if p.get("kind") != "paired"]
    cells = [
        verdict_word(case.get("passed"), case.get("interrupted")),
        f'<a href="#{anchor}">{text(case.get("name"))}</a>',
        text(case.get("what") or ""),
        _count_text(case["pairings"]),
        probability(test.get("p")),
        probability(test.get("level")),
        _span(detectable(p, {"mean/image"}) for p in others),
        _span(detectable(p, {"mean/image"}) for p in paired),
        _span(detectable(p, VARIANCES) for p in case["pairings"]),
    ]
    return row(cells, range(3, 9), mark="" if case.get("passed") else "bad")


def overview(results, anchors):
    """A row per case; the comparisons themselves stand in the cases' parts."""
    heads = [
        "",
        "case",
        "what",
        "comparisons",
        "smallest p",
        "level",
        "detectable bias of image mean",
        "the same, equal seeds",
        "detectable change of variance",
    ]
    intro = (
        "<p class=soft>Each comparison makes several tests: means of pixels, 8×8 tiles and the image over all channels, "
        "variances, and whether the p-values are those of chance. It passes if every test's p is above the test's level; "
        "no pixel is forgiven. Detectable: a bias of the median channel or a change of all variances that is found with "
        "probability 0.9, over the case's comparisons. Equal seeds follow the same paths, so that their differences show "
        "biases far below the noise; variances are compared where both sides are the same estimator. Each case's "
        "comparisons are listed with it.</p>"
    )
    rows = [_overview_row(case, anchors[id(case)]) for case in in_order(results["cases"])]
    return '<h2 id="verdicts">Verdicts</h2>' + intro + table(heads, rows, range(3, 9)) if rows else ""
