"""One part per case: images, maps of differences, spectra, QQ plot, tails."""

import pathlib

import cubes
import plots
from markup import DASH, data_uri, is_number, number, percent, picture, plot, row, table, text, verdict_word
from comparisons import comparison_table, in_order, pairing_name


def _shown(case):
    """The pairings drawn in full: every failed one, else the first independent one, else the first."""
    pairings = case.get("pairings") or []
    failed = [p for p in pairings if not p.get("passed")]
    independent = [p for p in pairings if p.get("kind") == "independent"]
    return failed or independent[:1] or pairings[:1]


def _image(directory, case, entry):
    """A cube as a picture; a note where it cannot be read."""
    try:
        cube = cubes.read_cube(directory / pathlib.PurePosixPath(str(entry.get("file"))))
        channels = case.get("channels_nm") or []
        if cube.shape[2] != len(channels):
            raise cubes.CubeError(f"{entry.get('file')}: {cube.shape[2]} bands, the case has {len(channels)} channels")
    except cubes.CubeError as error:
        return f"<figure><figcaption>no image: {text(error)}</figcaption></figure>"
    kind = "" if cubes.is_visible(channels) else ", false colours (long, middle, short third of the channels)"
    return picture(
        plots.png(cubes.colours(cube, channels)),
        cube.shape,
        f"{text(entry.get('side'))}{kind}",
        f"mean image of {entry.get('side')}",
    )


def _maps(pairing, scales):
    """z-maps of the scales that have units, with the share of what was not tested."""
    figures = []
    for scale in scales:
        columns, rows, t = (scale.get(key) for key in ("columns", "rows", "t_map"))
        if not columns or not rows or columns * rows < 2 or len(t or []) != columns * rows:
            continue
        name, edge = ("pixels", 1) if scale is scales[0] else ("8×8 tiles", 8)
        pooled = f"; {text(scale.get('pooled_units'))} pools of thin ones" if scale.get("pooled_units") else ""
        caption = f"z-map of {name}: p {number(scale.get('p'), 2)}; {text(scale.get('units'))} units, {text(scale.get('tested'))} tests{pooled}"
        figures.append(
            picture(plots.z_map(t, columns, rows), (edge * rows, edge * columns), caption, f"z-map of {name}")
        )
    return figures


def _qq_series(case, shown):
    """p-values of all independent comparisons of the case, the shown one last (drawn on top)."""
    series = []
    for pairing in case.get("pairings") or []:
        values = plots.numbers(pairing.get("p_values"))
        values = values[(values >= 0) & (values <= 1)]
        if values.size >= 20:
            series.append((values, pairing is shown))
    return sorted(series, key=lambda s: s[1]) if any(s[1] for s in series) else []


def _pairing_part(case, pairing):
    scales = [s for s in pairing.get("means") or [] if isinstance(s, dict)]
    maps = _maps(pairing, scales)
    qq = _qq_series(case, pairing)
    others = [p for p in case["pairings"] if p is not pairing]
    grey = " Grey: the case's other comparisons." if others else ""
    svg = plots.case_plot(case.get("channels_nm"), pairing, others, qq)
    notes = "".join(f"<p class=soft>Note: {text(note)}</p>" for note in pairing.get("notes") or [])
    title = f"<h4>{verdict_word(pairing.get('passed'))} {pairing_name(pairing)}</h4>"
    return title, maps, plot(svg, f"Spectra, their difference{' and p-values' if qq else ''}.{grey}", "spectra") + notes


def _tail_rows(case, sides):
    rows = []
    for label, tail in sides:
        channels, k = case.get("channels_nm") or [], tail.get("channel")
        where = (
            f"{number(channels[k][0], 5)}–{number(channels[k][1], 5)} nm"
            if isinstance(k, int) and 0 <= k < len(channels)
            else text(k)
        )
        count, effective = tail.get("count"), tail.get("effective")
        share = percent(3 * effective / count) if is_number(count) and is_number(effective) and count else DASH
        hill = tail.get("hill_index")
        heavy = is_number(hill) and hill <= 2
        rows.append(
            [
                text(label),
                where,
                text(count),
                number(effective),
                share,
                percent(tail.get("top_variance")),
                percent(tail.get("top_sum")),
                number(hill) + (" (heavy)" if heavy else ""),
            ]
        )
    return rows


TAIL_HEADS = [
    "side",
    "heaviest channel",
    "replicate means",
    "effective",
    "of normal noise",
    "largest share of variance",
    "largest share of the sum",
    "Hill index",
]


def tails_of(case):
    """(side, figures) of every side once."""
    sides = {}
    for pairing in case.get("pairings") or []:
        for side in ("a", "b"):
            if isinstance(pairing.get("tails_" + side), dict):
                sides.setdefault(str(pairing.get(side)), pairing["tails_" + side])
    return list(sides.items())


def tails_table(case):
    return table(TAIL_HEADS, [row(cells, range(2, 8)) for cells in _tail_rows(case, tails_of(case))], range(2, 8))


def tails_overview(results):
    """The side with the fewest effective samples of each case."""
    rows = []
    for case in results["cases"]:
        sides = [s for s in tails_of(case) if is_number(s[1].get("effective"))]
        if sides:
            heaviest = min(sides, key=lambda s: s[1]["effective"] / max(s[1].get("count") or 1, 1))
            rows.append(row([text(case.get("name"))] + _tail_rows(case, [heaviest])[0], range(3, 9)))
    if not rows:
        return ""
    return (
        '<h2 id="tails">Tails</h2><p class=soft>On how few samples the images hang: deviations d of the replicate means of each '
        "pixel from their median, for the side and channel with the heaviest tail of each case. Effective: (Σd²)² / Σd⁴, the "
        "number of replicate means that carry the variance (a third of them for normal noise). Hill index: the power with "
        "which large deviations become rare; 2 or less means that no finite variance is in sight, and "
        "the tests of such an image see less than they state. A dash: too few values to say.</p>"
        + table(["case"] + TAIL_HEADS, rows, range(3, 9))
    )


def case_part(case, anchor, directory):
    size = (
        f"{text(case.get('width'))}×{text(case.get('height'))} pixels, {len(case.get('channels_nm') or [])} channels, "
        f"{text(case.get('triangles'))} triangles, {text(case.get('scene'))}"
    )
    passed = bool(case.get("passed"))
    body = [
        f'<section class="case{"" if passed else " bad"}" id="{anchor}">'
        f"<h3>{verdict_word(passed, case.get('interrupted'))} {text(case.get('name'))}</h3>"
        f"<p>{text(case.get('what') or '')} <span class=soft>{size}</span></p>"
    ]
    if case.get("error"):
        body.append(f'<div class="failure">not run: {text(case["error"])}</div>')
    images, seen = [], set()
    for entry in case.get("cubes") or []:
        if entry.get("file") not in seen:
            images.append(_image(directory, case, entry))
            seen.add(entry.get("file"))
    for k, pairing in enumerate(_shown(case)):
        title, maps, drawing = _pairing_part(case, pairing)
        body.append(title + f'<div class="row">{"".join((images if k == 0 else []) + maps)}</div>' + drawing)
    body.append(comparison_table(case))
    if not _shown(case) and images:
        body.append(f'<div class="row">{"".join(images)}</div>')
    tails = tails_table(case)
    if tails:
        body.append(f"<details><summary>tails of every side</summary>{tails}</details>")
    return "".join(body) + "</section>"


def cases(results, anchors, directory):
    if not results["cases"]:
        return ""
    scale = (
        f"<p class=soft>Images: the mean of the first side; equal-energy light is neutral, the 98th percentile of brightness white. z-maps: "
        f"difference A − B of every unit in standard errors, of the channel where it is largest (so that values near "
        f"0 are rare with many channels): −{plots.Z_LIMIT} "
        f'<img class="scale" src="{data_uri(plots.z_scale(), "png")}" alt="blue to red"> +{plots.Z_LIMIT}, grey: not tested. '
        "QQ plots: the band holds 95 % of the values of independent, normally distributed units; the test compares with random "
        "divisions of the replicates instead, so that leaving the band is no failure by itself.</p>"
    )
    return (
        '<h2 id="cases">Cases</h2>'
        + scale
        + "".join(case_part(c, anchors[id(c)], directory) for c in in_order(results["cases"]))
    )
