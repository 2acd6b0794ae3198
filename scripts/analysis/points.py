"""Pictures inside a page: SVG in the page's own colours, whose data points say what they stand for.

A transparent shape lies over each point. The page's script (pages/page.js) shows its text where the mouse or the keyboard is.
"""
import io
import re
from html import escape
from typing import NamedTuple

from matplotlib.container import BarContainer, ErrorbarContainer
from matplotlib.ticker import FixedLocator, FuncFormatter

from .drawing import plt, remember

MOST_POINTS_OF_A_CURVE = 400  # of a line without markers: more of them no hand can tell apart
RADIUS = 6

# What must be another colour in the dark; the style sheet knows both.
COLOURS = {"#000000": "currentColor", "#ffffff": "var(--paper)", "#dddddd": "var(--grid)", "#d9d9d9": "var(--ground)",
           "#eeeeee": "var(--ground)", "#333333": "var(--soft)", "#555555": "var(--soft)", "#888888": "var(--mid)",
           "#999999": "var(--mid)", "#b0b0b0": "var(--grid)", "#0072b2": "var(--blue)", "#004c78": "var(--deep-blue)",
           "#f0e442": "var(--yellow)"}


class Point(NamedTuple):
    """Where it lies on the axes, and its text: a line each for the series, the place and the value."""
    x: float
    y: float
    text: str
    box: tuple = ()  # of a bar: its corners, in the display's units


def number_text(value):
    value = float(value)
    return f"{value:.0f}" if value.is_integer() and abs(value) < 1e15 else f"{value:.4g}"


def told_by(ruler, value):
    """As the labels of an axis say it, where those are words or units of ours."""
    formatter, locator = ruler.get_major_formatter(), ruler.get_major_locator()
    if isinstance(formatter, FuncFormatter):
        ticks = locator.locs if isinstance(locator, FixedLocator) else []
        nearest = min(ticks, key=lambda tick: abs(tick - value), default=value)
        told = formatter(value, None) or (formatter(nearest, None) if abs(nearest - value) < 0.5 else "")
        if told:
            return " ".join(told.split())
    return number_text(value)


def value_text(ruler, value, spread):
    if spread is None:
        return told_by(ruler, value)
    middle, low, high = (told_by(ruler, number) for number in spread[:3])
    return middle + (f" ({low} to {high})" if low != high else "") + (f", n\u00a0{spread[3]}" if len(spread) > 3 else "")


def ruler_name(figure, axis, which):
    """The label of an axis; panels that share one have it at the edge alone."""
    own = getattr(axis, f"get_{which}label")()
    if own:
        return own
    shared = getattr(axis, f"get_shared_{which}_axes")().get_siblings(axis)
    names = [getattr(other, f"get_{which}label")() for other in figure.axes if other in shared]
    return next((name for name in names if name), "")


def point_text(figure, axis, label, x, y, spread, along):
    lines = [label] if label and not label.startswith("_") else []
    title = axis.get_title() or axis.get_title("left")
    if title and len(figure.axes) > 1:
        lines.insert(0, re.sub(r"\$\\bf\{(.*?)\}\$", r"\1", " ".join(title.split())))
    for which, ruler, value in (("x", axis.xaxis, x), ("y", axis.yaxis, y)):
        told = value_text(ruler, value, spread if which == along else None)
        name = ruler_name(figure, axis, which)
        lines.append(f"{name}: {told}" if name else told)
    return "\n".join(lines)


def of_line(figure, axis, artist):
    if artist.get_transform() != axis.transData or not artist.get_visible():
        return  # a rule across the axes
    has_marker = artist.get_marker() not in ("", " ", "None", None)
    label, xs, ys = getattr(artist, "name", "") or artist.get_label(), artist.get_xdata(), artist.get_ydata()
    if not has_marker and (label.startswith("_") or len(xs) > MOST_POINTS_OF_A_CURVE):
        return
    spreads = getattr(artist, "spreads", [None] * len(xs))
    along = getattr(artist, "along", "y")
    for x, y, spread in zip(xs, ys, spreads):
        yield Point(x, y, point_text(figure, axis, label, x, y, spread, along))


def of_bars(figure, axis, container):
    along = "y" if container.orientation == "vertical" else "x"
    spreads = getattr(container, "spreads", [None] * len(container.patches))
    for patch, value, spread in zip(container.patches, container.datavalues, spreads):
        box = patch.get_window_extent().intersection(patch.get_window_extent(), axis.bbox)
        if box is None:
            continue
        x, y = patch.get_x() + patch.get_width() / 2, patch.get_y() + patch.get_height() / 2
        told = (x, value) if along == "y" else (value, y)
        yield Point(x, y, point_text(figure, axis, container.get_label(), *told, spread, along), tuple(box.extents))


def take_whiskers(container):
    """They are the spread of the points between them, where nothing else was said of these."""
    artist, _, whiskers = container
    if artist is None or hasattr(artist, "spreads") or not whiskers:
        return
    values = artist.get_xdata() if container.has_xerr else artist.get_ydata()
    ends = [sorted(end[0 if container.has_xerr else 1] for end in segment) for segment in whiskers[0].get_segments()]
    name = container.get_label()
    remember(artist, [(value, *end) for value, end in zip(values, ends)], "x" if container.has_xerr else "y",
             "" if name.startswith("_") else name)


def points_of(figure):
    """(axis, point) of everything that is drawn of data, series by series."""
    for axis in figure.axes:
        whiskers = [container for container in axis.containers if isinstance(container, ErrorbarContainer)]
        for container in whiskers:
            take_whiskers(container)
        caps = [cap for container in whiskers for cap in container[1]]
        for artist in axis.get_lines():
            if artist not in caps:
                yield from ((axis, point) for point in of_line(figure, axis, artist))
        for container in axis.containers:
            if isinstance(container, BarContainer) and getattr(container, "is_data", True):
                yield from ((axis, point) for point in of_bars(figure, axis, container))


def shapes(figure):
    """The transparent shapes over the points that are to be seen, in the units of the SVG."""
    scale, height = 72 / figure.dpi, figure.get_figheight() * 72
    found = []
    for axis, point in points_of(figure):
        attributes = f'class="point" role="img" tabindex="-1" aria-label="{escape(point.text)}"'
        if point.box:
            x0, y0, x1, y1 = (number * scale for number in point.box)
            if x1 - x0 > 0.1 and y1 - y0 > 0.1:
                found.append(f'<rect {attributes} x="{x0:.1f}" y="{height - y1:.1f}" width="{x1 - x0:.1f}" '
                             f'height="{y1 - y0:.1f}"/>')
            continue
        x, y = axis.transData.transform((point.x, point.y))
        inside = axis.bbox.padded(2)
        if inside.x0 <= x <= inside.x1 and inside.y0 <= y <= inside.y1:
            found.append(f'<circle {attributes} cx="{x * scale:.1f}" cy="{height - y * scale:.1f}" r="{RADIUS}"/>')
    return found


def own_ids(text, name):
    """Ids that something refers to, with the picture's name before them, since pages hold many pictures; no others."""
    used = set(re.findall(r'(?:url\(#|href="#)([^")]+)', text))
    text = re.sub(r' id="([^"]*)"', lambda found: f' id="{name}-{found[1]}"' if found[1] in used else "", text)
    return re.sub(r'(url\(#|href="#)', rf"\g<1>{name}-", text)


def inline_svg(figure, name, title):
    """The figure as SVG for the inside of a page. Closes the figure."""
    figure.patch.set_visible(False)
    for axis in figure.axes:
        axis.patch.set_visible(False)
        if axis.get_legend():
            axis.get_legend().get_frame().set_alpha(None)
    written = io.StringIO()
    with plt.rc_context({"svg.fonttype": "none", "font.family": "sans-serif"}):
        figure.tight_layout()
        figure.savefig(written, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
        over = shapes(figure)
    plt.close(figure)
    text = written.getvalue()
    text = text[text.index("<svg"):]
    view = re.search(r'viewBox="([^"]*)"', text)[1]
    body = text[text.index(">") + 1:text.rindex("</svg>")]
    body = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", body, flags=re.DOTALL).replace("xlink:href", "href")
    body = re.sub(r"font: ([^;\"]*?)'[^;\"]*?sans-serif", r"font: \1sans-serif", body)
    body = re.sub(r"#[0-9a-f]{6}\b", lambda found: COLOURS.get(found[0], found[0]), body)
    body = re.sub(r"\s*\n\s*", "\n", own_ids(body, escape(name)))
    width = round(float(view.split()[2]))
    points = '<g class="points">\n' + "\n".join(over) + "\n</g>\n" if over else ""
    return (f'<svg viewBox="{view}" style="max-width: {round(width * 1.5)}px; min-width: {min(width, 900)}px" role="group" '
            f'aria-label="{escape(title)}">{body}{points}</svg>')
