"""HTML from values: everything that comes from a file is escaped here, missing values become a dash."""

import base64
import html
import math

DASH = "–"

STYLE = """
:root { --ink: #1d2530; --soft: #5d6977; --line: #d9dee5; --pale: #f5f7f9; --good: #1c7a45; --bad: #b3261e; --blue: #1f5fa8; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: #fff; font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 0 28px 60px; }
h1 { font-size: 28px; margin: 34px 0 4px; letter-spacing: -.01em; }
h2 { font-size: 21px; margin: 46px 0 10px; padding-bottom: 5px; border-bottom: 2px solid var(--ink); }
h3 { font-size: 16.5px; margin: 30px 0 4px; }
h4 { font-size: 14px; margin: 16px 0 4px; }
p { margin: 6px 0; max-width: 92ch; }
.soft, caption, figcaption { color: var(--soft); font-size: 13px; }
nav { font-size: 14px; margin: 14px 0; } nav a { margin-right: 18px; } a { color: var(--blue); text-decoration: none; }
.verdict { margin: 18px 0; padding: 14px 18px; border-left: 7px solid; background: var(--pale); font-size: 17px; }
.verdict.good { border-color: var(--good); } .verdict.bad { border-color: var(--bad); background: #fdf2f1; }
.verdict.open { border-color: #b7791f; background: #fdf8ec; }
.verdict b { font-size: 21px; margin-right: 8px; }
.good b, .good.word { color: var(--good); } .bad b, .bad.word { color: var(--bad); } .open.word { color: #8a5a12; } .word { font-weight: 600; }
.failure { border-left: 7px solid var(--bad); background: #fdf2f1; padding: 8px 14px; margin: 8px 0; }
dl.facts { display: grid; grid-template-columns: max-content 1fr; gap: 2px 20px; margin: 12px 0; font-size: 14px; }
dl.facts dt { color: var(--soft); } dl.facts dd { margin: 0; overflow-wrap: anywhere; }
.scroll { overflow-x: auto; margin: 10px 0; }
table { border-collapse: collapse; font-size: 13px; width: 100%; font-variant-numeric: tabular-nums; }
caption { text-align: left; padding: 4px 0; }
th { text-align: left; font-weight: 600; border-bottom: 1.5px solid var(--ink); padding: 4px 9px; vertical-align: bottom; }
td { padding: 3px 9px; border-bottom: 1px solid var(--line); vertical-align: top; overflow-wrap: break-word; }
td.n, th.n { text-align: right; } td.n, td .word { white-space: nowrap; }
tr.group td { background: var(--pale); font-weight: 600; padding-top: 6px; } tr.bad td { background: #fdf2f1; }
tr.group .soft { font-weight: 400; margin-left: 8px; }
.row { display: flex; flex-wrap: wrap; gap: 20px; align-items: flex-start; margin: 10px 0; }
figure { margin: 0; } figcaption { max-width: 300px; padding-top: 3px; line-height: 1.35; }
section.case table { font-size: 12.5px; } section.case td { white-space: nowrap; padding: 3px 7px; } section.case th { padding: 4px 7px; }
sup, sub { line-height: 0; }
figure.wide { margin: 10px 0; } figure.wide img { max-width: 100%; } figure.wide figcaption { max-width: 92ch; }
img.pixels { image-rendering: pixelated; border: 1px solid var(--line); display: block; background: #e8e8e8; }
.scale { display: inline-block; width: 130px; height: 11px; vertical-align: -1px; margin: 0 5px; border: 1px solid var(--line); }
section.case { border-top: 1px solid var(--line); padding-top: 2px; margin-top: 26px; }
section.case.bad { border-top: 3px solid var(--bad); }
details { margin: 8px 0; } summary { cursor: pointer; color: var(--blue); font-size: 14px; }
ul { margin: 6px 0; padding-left: 22px; } li { max-width: 92ch; margin: 3px 0; }
@media print { section.case, figure, tr { break-inside: avoid; } main { max-width: none; } nav { display: none; } }
"""


def text(value):
    """Escaped; anything that is not text in its plain form, None as a dash."""
    return DASH if value is None else html.escape(str(value), quote=True)


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def number(value, digits=3):
    """Like %g, with a proper power of ten."""
    if not is_number(value):
        return DASH
    shown = f"{value:.{digits}g}"
    mantissa, e, exponent = shown.partition("e")
    if not e:
        return shown.replace("-", "−")
    power = f"10<sup>{str(int(exponent)).replace('-', '−')}</sup>"
    return power if mantissa == "1" else f"{mantissa.replace('-', '−')}·{power}"


def percent(value, digits=2):
    return DASH if not is_number(value) else f"{number(100 * value, digits)} %"


def probability(value):
    return "&lt; 10<sup>−300</sup>" if is_number(value) and value <= 1e-300 else number(value, 2)


def duration(seconds):
    if not is_number(seconds):
        return DASH
    if seconds < 120:
        return f"{seconds:.3g} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def verdict_word(passed, interrupted=False):
    if not passed:
        return '<span class="word bad">FAILED</span>'
    return '<span class="word open">stopped</span>' if interrupted else '<span class="word good">passed</span>'


def row(cells, numeric=(), mark=""):
    """cells are HTML; numeric: the columns aligned to the right; mark: class of the row."""
    inner = "".join(f'<td{" class=n" if i in numeric else ""}>{cell}</td>' for i, cell in enumerate(cells))
    return f'<tr class="{mark}">{inner}</tr>' if mark else f"<tr>{inner}</tr>"


def group_row(content, columns, anchor=""):
    identity = f' id="{text(anchor)}"' if anchor else ""
    return f'<tr class="group"{identity}><td colspan="{columns}">{content}</td></tr>'


def table(heads, rows, numeric=(), caption=""):
    """heads are HTML, rows come from row() and group_row(). No rows, no table."""
    if not rows:
        return ""
    head = "".join(f'<th{" class=n" if i in numeric else ""}>{cell}</th>' for i, cell in enumerate(heads))
    title = f"<caption>{caption}</caption>" if caption else ""
    return (
        f'<div class="scroll"><table>{title}<thead><tr>{head}</tr></thead><tbody>{"".join(rows)}'
        "</tbody></table></div>"
    )


def data_uri(data, kind):
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


def plot(svg, caption="", alt="plot"):
    """A drawing of plots.py over the whole width; nothing where there was nothing to draw."""
    if not svg:
        return ""
    legend = f"<figcaption>{caption}</figcaption>" if caption else ""
    return f'<figure class="wide"><img src="{data_uri(svg, "svg+xml")}" alt="{text(alt)}">{legend}</figure>'


def picture(png, shape, caption, alt):
    """An image of shape (height, width) pixels, enlarged to at most 300 x 260, a pixel to at most 16."""
    height, width = shape[:2]
    factor = min(300 / width, 260 / height, 16)
    size = f'width="{max(1, round(factor * width))}" height="{max(1, round(factor * height))}"'
    return (
        f'<figure><img class="pixels" src="{data_uri(png, "png")}" {size} alt="{text(alt)}">'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def page(title, body):
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{text(title)}</title><style>{STYLE}</style></head>\n<body><main>\n{body}\n</main></body></html>\n"
    )
