"""The head of the report: verdict, failures, what a pass does not tell."""

from comparisons import decisive, pairing_name, test_name
from markup import DASH, duration, is_number, number, percent, probability, text


def count(number_of, what):
    """1 case, 3 studies, 2 scenes against Mitsuba."""
    noun, against, rest = what.partition(" against")
    plural = noun[:-1] + "ies" if noun.endswith("y") else noun + "s"
    return f"{text(number_of)} {noun if number_of == 1 else plural}{against}{rest}"


def _counts(results):
    pairings = [p for c in results["cases"] for p in c.get("pairings") or []]
    figures = [f for h in results["hard_cases"] for f in h.get("figures") or []]
    return pairings, figures


def _sections(results):
    return (
        ("case", results["cases"]),
        ("hard case", results["hard_cases"]),
        ("convergence study", results["convergence"]),
        ("scene against Mitsuba", results["mitsuba"]["scenes"]),
    )


def failed_parts(results):
    """["2 cases", "1 convergence study"]: of the parts of a run, what has failed."""
    return [
        count(sum(not e.get("passed") for e in entries), what)
        for what, entries in _sections(results)
        if not all(e.get("passed") for e in entries)
    ]


def verdict(results):
    pairings, figures = _counts(results)
    failed = failed_parts(results)
    done = (
        f"{len(pairings)} of {count(results.get('comparisons', len(pairings)), 'comparison')} in "
        f"{count(len(results['cases']), 'case')}, {count(len(figures), 'figure')} of "
        f"{count(len(results['hard_cases']), 'hard case')}, {count(len(results['convergence']), 'convergence study')}"
    )
    if results["mitsuba"]["scenes"]:
        done += f", {count(len(results['mitsuba']['scenes']), 'scene against Mitsuba')}"
    if failed:
        return "bad", "FAILED", f"{', '.join(failed)} failed; {done}"
    if results.get("interrupted"):
        return "open", "Interrupted", f"nothing failed until then; {done}"
    if results.get("passed") is False:
        return "bad", "FAILED", f"something failed; {done}"
    if not any(entries for _, entries in _sections(results)):
        return "open", "Nothing was compared", done
    return "good", "Passed", done


def head(results):
    kind, word, line = verdict(results)
    repeated = sum((p.get("attempts") or 0) > 1 for p in _counts(results)[0])
    facts = [
        ("program", text(results.get("program"))),
        ("machine", text(results.get("processor"))),
        ("backends", "<br>".join(text(b) for b in results.get("backends") or []) or DASH),
        ("date", text(results.get("date"))),
        (
            "effort",
            f"{text(results.get('effort'))}, {duration(results.get('seconds'))}, seed {text(results.get('seed'))}",
        ),
        (
            "false alarms",
            f"a run without faults fails with probability {number(results.get('rate'))} at most: comparisons "
            f"{number(results.get('rate_first'))} for the first attempts of all of them together, and what fails is "
            f"repeated once with fresh seeds and four times the samples at {number(results.get('rate_again'))} "
            f"({repeated} of this run's were); hard cases {number(results.get('rate_hard_cases'))}; slopes "
            f"{number(results.get('rate_convergence'))}; Mitsuba {number(results.get('rate_mitsuba'))}",
        ),
    ]
    interrupted = ' <span class="word bad">The run was interrupted.</span>' if results.get("interrupted") else ""
    return (
        "<h1>Validation of kiloband</h1>"
        f'<div class="verdict {kind}"><b>{word}</b> {line}.{interrupted}</div>'
        '<dl class="facts">' + "".join(f"<dt>{k}</dt><dd>{v}</dd>" for k, v in facts) + "</dl>"
    )


def _worst_place(test, case):
    worst = test.get("worst")
    if not isinstance(worst, dict):
        return ""
    x, y, w, h = (worst.get(key) or 0 for key in ("x", "y", "width", "height"))
    place = f"pixel {x}, {y}" if w == h == 1 else f"pixels {x}–{x + w - 1}, {y}–{y + h - 1}"
    channels, k = case.get("channels_nm") or [], worst.get("channel")
    channel = f"channel {text(k)}"
    if isinstance(k, int) and 0 <= k < len(channels):
        channel += f" ({number(channels[k][0], 6)}–{number(channels[k][1], 6)} nm)"
    pooled = " (thin ones, pooled)" if worst.get("pooled") else ""
    mean = worst.get("a")
    relative = (
        f" ({percent(worst['difference'] / abs(mean))})"
        if is_number(mean) and mean and is_number(worst.get("difference"))
        else ""
    )
    return (
        f"; at {place}{pooled}, {channel}: A {number(mean, 6)}, B {number(worst.get('b'), 6)}, difference "
        f"{number(worst.get('difference'))}{relative} = {number(worst.get('t'))} standard errors"
    )


def _pairing_failure(case, pairing):
    test = decisive(pairing)
    parts = (
        [
            f"{test_name(test)}: p {probability(test.get('p'))}, level {probability(test.get('level'))}"
            + _worst_place(test, case)
        ]
        if test and not test.get("passed")
        else []
    )
    if pairing.get("invalid_samples"):
        parts.insert(0, f"{text(pairing['invalid_samples'])} invalid samples")
    others = [test_name(t) for t in pairing.get("tests") or [] if not t.get("passed") and t is not test]
    if others:
        parts.append("failed too: " + ", ".join(others))
    return f"<b>{text(case.get('name'))}</b>: {pairing_name(pairing)}: " + ("; ".join(parts or map(text, pairing.get("notes") or [])) or "not finished")


def _hard_failure(hard):
    wrong = [f for f in hard.get("figures") or [] if not f.get("passed")]
    why = "; ".join(
        f"{text(f.get('name'))}: {number(f.get('value'), 6)} {text(f.get('unit') or '')} instead of "
        f"{number(f.get('reference'), 6)}, error {number(f.get('error'))}, limit {number(f.get('limit'))}"
        for f in wrong
    )
    return f"<b>hard case {text(hard.get('name'))}</b> on {text(hard.get('backend'))}: {text(hard['error']) if hard.get('error') else why}"


def on_backend(scene):
    """ " on opencl:pt"; nothing where the backend was not recorded."""
    return f" on {text(scene['backend'])}" if scene.get("backend") else ""


def _mitsuba_failure(scene):
    pixels = scene.get("pixels")
    place = f"<b>{text(scene.get('name'))}</b>{on_backend(scene)} against Mitsuba: "
    if not is_number(scene.get("p")):
        return place + text(scene.get("failure") or "not finished")
    where = f"; {test_name(pixels)}: p {probability(pixels.get('p'))}" if isinstance(pixels, dict) else ""
    return (
        f"{place}channel means p {probability(scene.get('p'))}, level "
        f"{probability(scene.get('level'))}, largest difference {percent(scene.get('largest_difference'))}{where}"
    )


def failures(results):
    lines = []
    for case in results["cases"]:
        if case.get("error"):
            lines.append(f"<b>{text(case.get('name'))}</b> was not run: {text(case['error'])}")
        lines += [_pairing_failure(case, p) for p in case.get("pairings") or [] if not p.get("passed")]
    lines += [_hard_failure(h) for h in results["hard_cases"] if not h.get("passed")]
    lines += [
        f"<b>{text(c.get('name'))}</b>: {text(c.get('note'))}" for c in results["convergence"] if not c.get("passed")
    ]
    lines += [_mitsuba_failure(s) for s in results["mitsuba"]["scenes"] if not s.get("passed")]
    if not lines:
        return ""
    return '<h2 id="failures">Failures</h2>' + "".join(f'<div class="failure">{line}</div>' for line in lines)


def limits(results):
    """What a pass leaves open; depends on what took part."""
    backends = results.get("backends") or []
    closed = any(p.get("kind") == "closed form" for p in _counts(results)[0])
    items = [
        "What the backends share is invisible to comparisons between them: reading and flattening scenes, spectra and their "
        "tables, random numbers, warps, the record formats. It is held against closed forms"
        + (" (cases of the kind “closed form”)" if closed else ", <b>of which this run has none</b>")
        + " and against an independent renderer where that section is there.",
        "A bias below the detectable one stays unseen. Detectable: found with probability 0.9 at the levels of this run; "
        "each table states it, for the median channel.",
        "A bright path that no replicate met is missing on every side. The section on tails says where images hang on few "
        "samples.",
        "Materials, lights and media that no case contains, and sizes beyond those of the hard cases.",
    ]
    if len(backends) < 2:
        items.insert(0, "<b>Only one backend took part: nothing was compared between backends.</b>")
    else:
        items.append("Other devices and drivers than those named above.")
    return "<h2>What a pass does not tell</h2><ul>" + "".join(f"<li>{item}</li>" for item in items) + "</ul>"
