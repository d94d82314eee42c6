"""Small drawings as text, each of one feature of SVG. test_resvg.py checks them.

DRAWINGS: the drawings by their names.
ROUND: the names of drawings with arcs, which every reader splits into different curves.
REPORTED_OTHERWISE: for features that resvg 2.6 does not read, an equal drawing with features that it reads.
"""

XLINK = 'xmlns:xlink="http://www.w3.org/1999/xlink"'


def page(body: str, attributes: str = 'width="300" height="200"') -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes} fill="none" stroke="#000">{body}</svg>'


def in_millimetres(body: str) -> str:
    return page(body, 'width="100mm" height="80mm" viewBox="0 0 100 80"')


# One drawing in all nine places, met and sliced.
PLACES = [f"x{x}Y{y}" for y in ("Min", "Mid", "Max") for x in ("Min", "Mid", "Max")]
MARK = '<path d="M2 3L18 4V25Z" stroke-width="2"/>'
BOX = 'viewBox="1 2 20 30" preserveAspectRatio='

PATHS = {
    "absolute commands": page('<path d="M10 20L40 30H60V50C70 60 80 60 90 50S110 40 120 50Q130 70 140 50T160 60Z"/>'),
    "relative commands": page('<path d="m10 20l30 10h20v20c10 10 20 10 30 0s20-10 30 0q10 20 20 0t20 10z"/>'),
    "commands repeat themselves": page(
        '<path d="M10 10 20 20 30 10m5 5 10 10 10-10h5 6 7v5 6L100 50 110 60C120 60 130 70 140 70 150 70 160 60 '
        '170 60s10 10 20 10 10-5 20 0Q210 80 220 70 230 60 240 70t10 10 10 0"/>'
    ),
    "packed numbers": page('<path d="M10-.5.5.5l1e1.5-.5.5E+1-3,4,5-6.25.75.5C1.5.5.5-1.5 3e-1-2 M+4+5+6+7"/>'),
    "smooth without a curve before": page('<path d="M10 10S20 30 40 10M60 10T90 30T120 10M130 10L140 20T160 30"/>'),
    "smooth of the other kind before": page(
        '<path d="M10 10C20 30 30 30 40 10T70 20M90 10Q100 30 110 10S140 40 150 20"/>'
    ),
    "sub-paths": page('<path d="M10 10h20v10zl5 30h9M50 50h20M80 50l10 10zm10 20h20l-5 9z"/>'),
    "closed where it starts": page('<path d="M10 10H40V40H10V10Z"/>'),
    "lone movetos": page('<path d="M1 1M10 10h20M50 50M60 60h20M90 90"/><path d="M5 5"/>'),
    "dots": page('<path stroke-linecap="round" d="M10 10h0M20 20z M30 30L30 30M50 50h10"/>'),
    "arcs": page(
        '<path d="M20 50A25 15 0 0 1 60 60A20 20 0 1 0 90 40a10 20 30 1 1 15 15a20 12-40 0020 10A15 15 0 0 1 150 90"/>'
    ),
    "arcs too small": page('<path d="M10 50A1 2 0 0 1 30 60M100 50a2 2 30 1 0 20 5"/>'),
    "arcs that are lines": page('<path d="M10 50A0 9 0 0 1 50 60A9 0 0 0 1 90 60A5 5 0 1 1 90 60L95 20"/>'),
    "arcs with packed flags": page('<path d="M20 50a9 9 0 0120 0a9 9 0 1110-4a9 9 0 00.5.5"/>'),
    "arcs with negative radii": page('<path d="M20 50A-25 15 0 0 1 60 60"/>'),
    "points break off": page('<polyline points="1,2 30,4 10"/><polyline points="1,2 30,4 10 9 x 5"/>'),
    "a path breaks off": page('<path d="M10 10h20v10x30"/><path d="M10 50L20 60 30"/><path d="M0 90h9"/>'),
    "no path": page('<path d=""/><path d="L5 5"/><path/><path d="M0 90h9"/>'),
}
SHAPES = {
    "lines": page('<line x1="1" y1="2" x2="30" y2="40"/><line x2="9"/><line y1="50%" x2="50%" y2="10%"/>'),
    "polylines": page(
        '<polyline points="1,2 30,4 10 50"/><polyline points="60-5.5.5,7 80 9 11 12"/>'
        '<polygon points="9 99 50 90 30 130"/>'
    ),
    "rectangles": page('<rect x="10" y="20" width="30" height="40"/><rect width="10%" height="10%" x="50%" y="50%"/>'),
    "rounded rectangles": page(
        '<rect x="10" y="20" width="50" height="40" rx="8"/><rect x="70" y="20" width="50" height="40" ry="8"/>'
        '<rect x="130" y="20" width="50" height="40" rx="9" ry="5"/>'
        '<rect x="190" y="20" width="50" height="40" rx="99"/>'
        '<rect x="10" y="80" width="50" height="40" ry="30" rx="4"/>'
        '<rect x="70" y="80" width="50" height="40" rx="5%"/>'
        '<rect x="130" y="80" width="50" height="40" rx="7" ry="auto"/>'
        '<rect x="190" y="80" width="50" height="40" rx="0"/>'
    ),
    "circles and ellipses": page(
        '<circle cx="50" cy="60" r="20"/><circle r="9" cx="50%" cy="50%"/>'
        '<ellipse cx="90" cy="50" rx="25" ry="12"/><circle cx="200" cy="100" r="10%"/>'
        '<ellipse cx="30" cy="150" rx="20" ry="auto"/><ellipse cx="90" cy="150" rx="8"/>'
    ),
    "shapes of a negative size": page('<rect width="-5" height="9"/><circle r="-9"/><line x1="5" x2="9"/>'),
    "shapes without size": page(
        '<rect width="10"/><rect width="0" height="9"/><circle/><circle r="0"/><ellipse rx="5" ry="0"/>'
        '<polyline/><line x1="5" x2="9"/>'
    ),
}
FRAMES = {
    "transform functions": page(
        '<path transform="translate(10)" d="M0 9h20l5 9"/><path transform="translate(10 20)" d="M0 9h20l5 9"/>'
        '<path transform="scale(2)" d="M0 9h20l5 9"/><path transform="scale(2-1.5)" d="M0-9h20l5-9"/>'
        '<path transform="rotate(30)" d="M50 9h20l5 9"/><path transform="rotate(-30,40,50)" d="M0 9h20l5 9"/>'
        '<path transform="skewX(20)" d="M0 90h20l5 9"/><path transform="skewY(-20)" d="M0 90h20l5 9"/>'
        '<path transform="matrix(1 .5-.25 2 50 60)" d="M0 9h20l5 9"/>'
    ),
    "transform lists": page(
        '<path transform="translate(50,60)rotate(20) , scale(2 1.5)\n skewX(10)" d="M0 9h20l5 9"/>'
        '<path transform=" translate( 5 , 6 ) " d="M0 9h20l5 9"/><path transform="" d="M0 9h20l5 9"/>'
    ),
    "nested transforms": page(
        '<g transform="translate(100 50)"><g transform="rotate(30)"><path d="M0 9h20l5 9"/>'
        '<g transform="scale(.5 2)"><path d="M0 9h20l5 9"/></g></g><path d="M0 9h20l5 9"/></g>'
        '<path d="M0 9h20l5 9"/>'
    ),
    "skewed circles": page(
        '<circle r="9" transform="translate(50 50)skewX(30)"/>'
        '<ellipse rx="9" ry="5" transform="matrix(1 .5 -.3 2 150 90)"/>'
    ),
    "mirrored": page('<path transform="matrix(-1 0 0 1 100 0)" d="M10 10C20 40 50 40 60 10z"/>'),
    "flattened by a transform": page('<path transform="scale(0)" d="M0 9h20"/><path d="M0 9h20"/>'),
    "transform-origin": page(
        '<path transform="rotate(30)" transform-origin="50 60" d="M0 9h20l5 9"/>'
        '<path transform="scale(2)" transform-origin="10% 5%" d="M0 9h20l5 9"/>'
        '<g transform="rotate(30)" style="transform-origin: 50px 60px"><path d="M0 29h20l5 9"/></g>'
    ),
    "transform as CSS writes it": page(
        '<path style="transform: rotate(30deg) translate(40px, 5mm)" d="M0 9h20l5 9"/>'
        '<path transform="scale(9)" style="transform: translateX(40px) scale(.5, 2) rotate(.1turn)" d="M0 9h20l5 '
        '9"/>'
    ),
    "millimetres": page(MARK, 'width="100mm" height="80mm" viewBox="0 0 50 40"'),
    "centimetres": page(MARK, 'width="10cm" height="8cm" viewBox="0 0 50 40"'),
    "inches": page(MARK, 'width="4in" height="3.2in" viewBox="0 0 50 40"'),
    "points": page(MARK, 'width="360pt" height="288pt" viewBox="0 0 50 40"'),
    "picas": page(MARK, 'width="30pc" height="24pc" viewBox="0 0 50 40"'),
    "pixels": page(MARK, 'width="300px" height="240px" viewBox="0 0 50 40"'),
    "no viewBox": page(MARK, 'width="50mm" height="40mm"'),
    "no size": page(MARK, 'viewBox="5 6 50 40"'),
    "size in percent": page(MARK, 'width="100%" height="100%" viewBox="5 6 50 40"'),
    "lengths in every unit": page(
        '<path d="M0 10h90" stroke-width="2mm"/><path d="M0 30h90" stroke-width=".2cm"/>'
        '<path d="M0 50h90" stroke-width="4pt"/><path d="M0 70h90" stroke-width=".5pc"/>'
        '<path d="M0 90h90" stroke-width=".1in"/><path d="M0 110h90" stroke-width="5px"/>'
        '<path d="M0 130h90" stroke-width="2%"/><path d="M0 150h90" stroke-width="1e1"/>'
        '<line x1="5mm" y1="1cm" x2="1in" y2="36pt"/><rect x="1pc" y="5%" width="5e1px" height="1cm"/>'
    ),
    "a Q is a quarter of a millimetre": page('<path d="M0 10h90" stroke-width="12Q"/>'),
    "percent of a viewBox": page(
        '<line x1="10%" y1="20%" x2="90%" y2="80%" stroke-width="1%"/>',
        'width="100mm" height="80mm" viewBox="10 20 50 80"',
    ),
}
FRAMES |= {
    f"root {place} {how} {shape}": page(MARK, f'width="{w}" height="{h}" {BOX}"{place} {how}"')
    for place in PLACES
    for how in ("meet", "slice")
    for shape, (w, h) in {"wide": (200, 90), "tall": (90, 200)}.items()
}
FRAMES |= {
    "viewBox with commas": page(MARK, 'width="200" height="90" viewBox="1,2, 20 ,30"'),
    "root with style and transform": page(
        f'{MARK}<path transform="scale(2)" d="M0 9h20"/>',
        'width="200" height="90" style="stroke:red;stroke-width:3" class="a" x="50" y="60"',
    ),
    "prefixed names": '<s:svg xmlns:s="http://www.w3.org/2000/svg" width="90" height="90"><s:g stroke="red">'
    '<s:path d="M2 3L18 4"/></s:g></s:svg>',
    "names without a namespace": '<s:svg xmlns:s="http://www.w3.org/2000/svg" width="90" height="90">'
    '<s:line fill="none" stroke="red" x2="9"/><path d="M2 3L18 9"/></s:svg>',
    "root none": page(MARK, f'width="200" height="90" {BOX}"none"'),
    "root without a word on aspect": page(MARK, 'width="200" height="90" viewBox="1 2 20 30"'),
    "root defer": page(MARK, f'width="200" height="90" {BOX}"defer xMaxYMax meet"'),
}

NESTED = {
    "nested svg": page(
        '<svg x="20" y="30" width="100" height="80" viewBox="0 0 20 30"><path d="M2 3l15 20"/>'
        '<svg x="5" y="5" width="10" height="10"><path d="M2 3l5 6"/></svg></svg><path d="M2 3l15 20"/>'
    ),
    "nested svg without size": page('<svg x="20" y="30"><path d="M2 3l15 20"/></svg>'),
    "nested svg in percent": page(
        '<svg x="10%" y="20%" width="50%" height="50%">'
        '<line x1="10%" y1="10%" x2="90%" y2="90%" stroke-width="2%"/><svg viewBox="0 0 40 50">'
        '<line x1="10%" y1="10%" x2="90%" y2="90%" stroke-width="2%"/></svg></svg>'
    ),
    "nested svg that shows nothing": page('<svg width="0" height="9"><path d="M2 3l5 6"/></svg><path d="M2 3l5 9"/>'),
    "nested svg in millimetres": in_millimetres(
        '<svg x="10" y="10" width="50mm" height="40" viewBox="0 0 5 4"><path d="M0 0L5 4" stroke-width=".1"/></svg>'
    ),
    "nested svg that shows what is outside": page(
        '<svg x="90" y="90" width="40" height="40" overflow="visible"><path d="M-60-50l15 20"/></svg>'
    ),
    "nested svg with a transform": page(
        '<g transform="rotate(5)"><svg x="10" y="20" width="90" height="60" viewBox="0 0 30 40">'
        '<path d="M2 3l15 20" transform="scale(1.5 1)"/></svg></g>'
    ),
    "nested aspects": page(
        "".join(
            f'<svg x="{i % 6 * 50}" y="{i // 6 * 40}" width="{w}" height="{h}" {BOX}"{aspect}">{MARK}</svg>'
            for i, (aspect, (w, h)) in enumerate(
                (f"{place} {how}", size)
                for place in [*PLACES, "none"]
                for how in ("meet", "slice")
                for size in ((40, 20), (20, 35))
            )
        )
    ),
}
USES = {
    "use": page(
        '<path id="a" d="M2 3l15 20"/><use href="#a" x="30" y="40"/>'
        '<use href="#a" x="10%" transform="rotate(20)"/><use href="#a"/>'
    ),
    "use before what it uses": page('<use href="#a" x="30"/><path id="a" d="M2 3l15 20"/>'),
    "use by xlink": page(
        '<defs><path id="a" d="M2 3l15 20"/></defs><use xlink:href="#a" x="30"/>',
        f'width="300" height="200" {XLINK}',
    ),
    "use of a group": page(
        '<defs><g id="a" transform="scale(2)" stroke-width="3"><path d="M2 3l15 20"/>'
        '<path stroke="red" d="M9 3h9"/></g></defs><use href="#a" y="30"/><use href="#a" x="50" stroke="blue"/>'
    ),
    "use of a use": page(
        '<path id="a" d="M2 3l15 20"/><use id="b" href="#a" x="30"/><use href="#b" y="40" transform="scale(1.5)"/>'
    ),
    "use gives style to what it uses": page(
        '<defs><path id="a" d="M2 3l15 20"/><path id="b" stroke="red" d="M2 30h20"/></defs>'
        '<use href="#a" stroke="#00f" stroke-width="4"/><use href="#b" stroke="#00f" style="stroke-width:2"/>'
        '<g stroke="lime" color="#123456"><use href="#a" x="50" stroke="currentColor"/></g>'
    ),
    "use of a shape": page('<defs><rect id="a" width="20" height="10"/></defs><use href="#a" x="5" y="6" width="99"/>'),
    "use in millimetres and by style": page(
        '<path id="a" d="M2 3l15 20"/><use href="#a" x="5mm" y="1cm" style="stroke:red" class="b"/>'
    ),
    "use of what is in a group": page(
        '<g transform="translate(9 9)" stroke="red"><path id="a" transform="rotate(9)" d="M2 3l15 20"/></g>'
        '<use href="#a" x="50"/>'
    ),
    "use and visibility": page(
        '<g visibility="hidden"><path id="a" d="M2 3l15 20"/></g><use href="#a" x="9"/>'
        '<use href="#a" x="30" visibility="hidden"/>'
    ),
    "use of a use of itself": page('<g id="a"><path d="M0 5h9"/><use href="#a" x="9"/></g><path d="M2 3l15 20"/>'),
    "use of nothing": page('<use href="#none"/><use/><use href="other.svg#a"/><path d="M2 3l15 20"/>'),
    "use of what is hidden": page(
        '<path id="a" display="none" d="M0 5h9"/><use href="#a"/><defs display="none"><path id="b" d="M0 9h9"/>'
        '</defs><use href="#b"/>'
    ),
    "symbol": page(
        '<symbol id="s" viewBox="0 0 20 30"><path d="M2 3l15 20"/></symbol>'
        '<use href="#s" width="80" height="60"/>'
        '<use href="#s" x="100" y="10" width="80" height="60" transform="rotate(5)"/>'
        '<use href="#s" width="50%" height="50%"/>'
    ),
    "symbol without viewBox": page('<symbol id="s"><path d="M2 3l15 20"/></symbol><use href="#s" x="9" y="20"/>'),
    "symbol with an aspect": page(
        f'<symbol id="s" {BOX}"xMinYMax slice"><path d="M2 3l15 28"/></symbol><use href="#s" x="9" y="9" width="80" '
        'height="20"/><use href="#s" x="120" y="9" width="20" height="80"/>'
    ),
    "symbol by its own size": page(
        '<symbol id="s" viewBox="0 0 20 30" width="60" height="60"><path d="M2 3l15 20"/></symbol>'
        '<use href="#s" x="9"/>'
    ),
    "use of an svg": page(
        '<defs><svg id="s" viewBox="0 0 20 30" width="40" height="60"><path d="M2 3l15 20"/></svg></defs>'
        '<use href="#s" x="9"/><use href="#s" x="99" width="80" height="20"/>'
    ),
}
DRAWINGS = PATHS | SHAPES | FRAMES | NESTED | USES
ROUND = {
    "arcs",
    "arcs too small",
    "arcs with packed flags",
    "arcs with negative radii",
    "rounded rectangles",
    "circles and ellipses",
    "skewed circles",
}
REPORTED_OTHERWISE = {
    "transform-origin": page(
        '<path transform="rotate(30 50 60)" d="M0 9h20l5 9"/>'
        '<path transform="translate(-30-10)scale(2)" d="M0 9h20l5 9"/><g transform="rotate(30 50 60)">'
        '<path d="M0 29h20l5 9"/></g>'
    ),
    "transform as CSS writes it": page(
        '<path transform="rotate(30)translate(40 18.897638)" d="M0 9h20l5 9"/>'
        '<path transform="translate(40)scale(.5 2)rotate(36)" d="M0 9h20l5 9"/>'
    ),
    "a Q is a quarter of a millimetre": page('<path d="M0 10h90" stroke-width="3mm"/>'),
    "nested svg that shows nothing": page('<path d="M2 3l5 9"/>'),
    "symbol by its own size": page(
        '<svg x="9" viewBox="0 0 20 30" width="60" height="60"><path d="M2 3l15 20"/></svg>'
    ),
}
