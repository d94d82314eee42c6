"""Drawings made to hang a reader or to fill the memory: read or refused within bounded address space and time."""

import resource

import pytest
from command import brushsvg

ROOM = 3 << 30  # bytes of address space
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


# name: (what the drawing holds, exit status of import, words of the last line)
CASES = {
    "100 MB of path data": (
        lambda: f'<path d="M30 30{"l1 1-1-1" * 12_500_000}"/>',
        1,
        "more than 10000000 characters of path data",
    ),
    "10,000 nested groups": (lambda: f"{'<g>' * 10_000}{LINE}{'</g>' * 10_000}", 0, ""),
    "10,000 nested svg": (lambda: f"{'<svg>' * 10_000}{LINE}{'</svg>' * 10_000}", 0, ""),
    "use that doubles": (lambda: doubling(60), 1, "use copies more than 100000 elements"),
    "use in a circle": (cycle, 0, "in which it lies itself"),
    "a selector for every ancestor": (
        lambda: f"<style>h {'g ' * 12}path{{stroke:blue}}</style>{'<g>' * 5000}{LINE}{'</g>' * 5000}",
        1,
        "selectors take too long",
    ),
    "CSS without end": (
        lambda: f"<style>{'.a{stroke:red}' * 500_000}</style>{LINE}",
        1,
        "its CSS of 7000000 characters is beyond the limit of 1000000",
    ),
    "nested brackets in a style": (
        lambda: f'<path style="stroke:{"(" * 200_000}" d="M0 0H5"/>{LINE}',
        1,
        "its CSS is nested too deeply",
    ),
    "dashes finer than dust": (
        lambda: '<path stroke-dasharray="1e-9" d="M10 30H90"/>',
        1,
        "strokes where 100000 are left",
    ),
    "gigantic coordinates": (lambda: f'{LINE}<path id="q" d="M10 10H1e300"/>', 0, "leads beyond 1e6 mm"),
    "gigantic arcs": (lambda: f'{LINE}<path id="q" d="M10 10A1e9 1e9 0 1 0 20 10"/>', 0, "beyond 1e6 mm"),
}


def bounded():
    resource.setrlimit(resource.RLIMIT_AS, (ROOM, ROOM))


@pytest.mark.parametrize("name", CASES)
def test_read_or_refused_within_bounds(name, tmp_path):
    body, status, words = CASES[name]
    (tmp_path / "hostile.svg").write_text(f"{HEAD}{body()}</svg>")
    done = brushsvg(
        "import", "hostile.svg", "seen.svg", cwd=tmp_path, status=status, preexec_fn=bounded, timeout_s=120
    )
    assert words in (done.err[-1] if done.err else "")
    assert (tmp_path / "seen.svg").exists() == (status == 0)
