"""Hostile drawings are read or refused within bounded address space and time.

They are made to hang a reader or to fill the memory.
"""

import math
import resource

from command import brushsvg
from diagnostics import is_reported
from sampling import sample

ROOM = 3 << 30  # bytes of address space
BUSY_S = 60  # of processor time
HEAD = (
    '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="100mm" '
    'height="60mm" viewBox="0 0 100 60" fill="none" stroke="red" stroke-width="3">'
)
LINE = '<path id="p" d="M30 30H70"/>'


def doubling(depth):
    group = '<g id="a{0}"><use href="#a{1}"/><use href="#a{1}"/></g>'
    links = "".join(group.format(k, k + 1) for k in range(depth))
    return f'<defs>{links}<path id="a{depth}" d="M30 30H70"/></defs><use href="#a0"/>'


def cycle():
    return f'{LINE}<g id="a"><use id="u" href="#b"/></g><defs><g id="b"><use href="#a"/></g></defs>'


# {name: (content of the drawing, exit status of import, notice)}
CASES = {
    "100 MB of path data": (
        lambda: f'<path d="M30 30{"l1 1-1-1" * 12_500_000}"/>',
        1,
        "drawing-too-large 10000000 path",
    ),
    "10,000 nested groups": (lambda: f"{'<g>' * 10_000}{LINE}{'</g>' * 10_000}", 0, ""),
    "10,000 nested svg": (lambda: f"{'<svg>' * 10_000}{LINE}{'</svg>' * 10_000}", 0, ""),
    "use that doubles": (lambda: doubling(60), 1, "drawing-too-large use 100000"),
    "use in a circle": (cycle, 0, "use-of-itself"),
    "a selector for every ancestor": (
        lambda: f"<style>h {'g ' * 12}path{{stroke:blue}}</style>{'<g>' * 5000}{LINE}{'</g>' * 5000}",
        1,
        "css-too-complex",
    ),
    "CSS without end": (
        lambda: f"<style>{'.a{stroke:red}' * 500_000}</style>{LINE}",
        1,
        "css-too-complex 7000000 1000000",
    ),
    "nested brackets in a style": (
        lambda: f'<path style="stroke:{"(" * 200_000}" d="M0 0H5"/>{LINE}',
        1,
        "css-too-complex",
    ),
    "dashes finer than dust": (
        lambda: '<path stroke-dasharray="1e-9" d="M10 30H90"/>',
        1,
        "drawing-too-large 100000",
    ),
    "gigantic coordinates": (
        lambda: f'{LINE}<path id="q" d="M10 10H1e300"/>',
        0,
        "geometry-out-of-range 1e6",
    ),
    "gigantic arcs": (
        lambda: f'{LINE}<path id="q" d="M10 10A1e9 1e9 0 1 0 20 10"/>',
        0,
        "geometry-out-of-range 1e6",
    ),
}


def filled(data, rule="nonzero"):
    return f'<path id="p" fill="red" stroke="none" fill-rule="{rule}" d="{data}"/>'


def ring(points):
    return "M" + "L".join(f"{x:.5f} {y:.5f}" for x, y in points) + "Z"


def around(count, radius, turns=1):
    """Return points around the sheet's middle; radius is by number."""
    for k in range(count):
        angle = 2 * math.pi * turns * k / count
        yield 50 + radius(k) * math.cos(angle), 30 + radius(k) * math.sin(angle)


def boxes(count, side):
    """Return small squares all over the sheet."""
    across = math.isqrt(count)
    return "".join(
        f"M{5 + 90 * (k % across) / across:.4f} {3 + 54 * (k // across) / across:.4f}h{side}v{side}h-{side}Z"
        for k in range(count)
    )


def nested(count):
    step = 29 / count
    return "".join(
        f"M{k * step:.4f} {k * step:.4f}H{100 - k * step:.4f}V{60 - k * step:.4f}H{k * step:.4f}Z" for k in range(count)
    )


def comb(teeth):
    step = 90 / teeth
    return "M5 50" + f"v-30h{step / 2:.6f}v30h{step / 2:.6f}" * teeth + "v5H5Z"


def zigzag(count, floor):
    return ring([(5 + 90 * k / count, 10 + 30 * (k % 2)) for k in range(count)] + floor)


def ribbon(count):
    there = [(5 + 90 * k / count, 10 + 30 * (k % 2)) for k in range(count)]
    return ring(there + [(x, y + 0.2) for x, y in reversed(there)])


BAR = "M10 20H60V26H10Z"
# Filled outlines. Parts that are left out are named, and the picture has the rest.
OUTLINES = {
    "a star that crosses itself 4000 times": (
        lambda: filled(ring(around(91, lambda k: 25, 45)), "evenodd"),
        0,
        "nothing-to-paint 32",
    ),
    "a star that crosses itself a million times": (
        lambda: filled(ring(around(2001, lambda k: 25, 1000))),
        0,
        "nothing-to-paint 2e+06 10000",
    ),
    "no area": (lambda: filled("M10 10H50H10ZM5 5L9 9Z" * 1000), 0, "nothing-to-paint 'no area'"),
    "2,000 slivers": (
        lambda: filled("".join(f"M10 {10 + k / 50:.2f}h40v.01h-40Z" for k in range(2000))),
        0,
        "",
    ),
    "a circle of 100,000 edges": (lambda: filled(ring(around(100_000, lambda k: 25))), 0, ""),
    "a comb of 78,000 edges": (lambda: filled(comb(19_500)), 0, ""),
    "a zigzag of 100,000 edges": (
        lambda: filled(zigzag(100_000, [(95, 55), (5, 55)])),
        0,
        "nothing-to-paint dense",
    ),
    "a ribbon of 40,000 edges": (
        lambda: filled(ribbon(20_000)),
        0,
        "nothing-to-paint 20000",
    ),
    "300,000 edges": (lambda: filled(ring(around(300_000, lambda k: 25))), 0, "nothing-to-paint 200000"),
    "a rough disc of 40,000 edges": (
        lambda: filled(ring(around(40_000, lambda k: 20 + (k * 7919 % 1000) / 1000))),
        0,
        "",
    ),
    "500 nested contours": (lambda: filled(nested(500), "evenodd"), 0, ""),
    "10,000 nested contours": (
        lambda: filled(nested(10_000), "evenodd"),
        0,
        "nothing-to-paint dense",
    ),
    "one contour 1,001 times": (lambda: filled(BAR * 1001, "evenodd"), 0, ""),
    "one contour 1,000 times": (lambda: filled(BAR * 1000, "evenodd"), 0, "nothing-to-paint 'no area'"),
    "one contour 20,000 times": (lambda: filled(BAR * 20_000), 0, "nothing-to-paint dense"),
    "10,000 contours": (lambda: filled(boxes(10_000, 0.4)), 0, ""),
    "a sieve of 4,900 holes": (lambda: filled("M0 0H100V60H0Z" + boxes(4900, 0.4), "evenodd"), 0, ""),
    "open": (lambda: filled("M10 20H60V26H10M10 40Q40 60 60 40"), 0, ""),
    "not a number": (lambda: filled("M10 20H60V26H10ZM10 40LNaN 50H20Z"), 0, "geometry-damaged"),
    "infinite": (lambda: filled("M10 20H60V26H10ZM10 40L1e999 50H20Z"), 0, "geometry-out-of-range 1e6"),
    "30 m": (lambda: filled("M10 20H30000V26H10Z"), 0, "nothing-to-paint '20 m'"),
    "a nanometre": (lambda: filled("M10 20h1e-6v1e-6h-1e-6Z"), 0, "nothing-to-paint 'no area'"),
    "a star of 3,000 rays": (
        lambda: filled(ring(around(6000, lambda k: 25 if k % 2 else 1.0))),
        0,
        "",
    ),
}


def bounded():
    resource.setrlimit(resource.RLIMIT_AS, (ROOM, ROOM))
    resource.setrlimit(resource.RLIMIT_CPU, (BUSY_S, BUSY_S))


@sample("name", [*CASES, *OUTLINES], keep=10)
def test_hostile_drawings_are_read_or_refused_within_bounds(name, tmp_path):
    body, status, expected = {**CASES, **OUTLINES}[name]
    (tmp_path / "hostile.svg").write_text(f"{HEAD}{body()}</svg>")
    words = ("--messages", "json", "preview", "hostile.svg", "-o", "seen.svg", "--show", "strokes")
    done = brushsvg(*words, cwd=tmp_path, status=status, preexec_fn=bounded, timeout_s=300)
    assert not expected or is_reported(done.reported, expected), done.err
    assert (tmp_path / "seen.svg").exists() == (status == 0)


@sample("edges", [1500, 6000, 100_000], keep=1)
def test_rough_discs_are_filled_within_bounds(edges, tmp_path):
    """Rough discs are filled within bounds.

    If an outline has many teeth, a line moved inward of it crosses itself very often.
    """
    body = filled(ring(around(edges, lambda k: 24 + (k * 7919 % 1000) / 1000 * (edges < 1e5))))
    (tmp_path / "rough.svg").write_text(f"{HEAD}{body}</svg>")
    words = ("--messages", "json", "convert", "rough.svg", "-o", "rough.json", "--wide", "passes")
    done = brushsvg(*words, cwd=tmp_path, preexec_fn=bounded, timeout_s=300)
    assert is_reported(done.reported, "width-out-of-reach passes"), done.err
