"""Small drawings as text, each of one feature that changes the picture.

test_shown.py checks them. The page has 200 x 200 px. Lines are black, 8 px wide, with round ends and corners,
no fill.
"""

ATTRIBUTES = (
    'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" fill="none" stroke="#000" '
    'stroke-width="8" stroke-linecap="round" stroke-linejoin="round"'
)


def page(body: str, size: str = 'width="200" height="200"') -> str:
    return f"<svg {ATTRIBUTES} {size}>{body}</svg>"


MIDDLE = 'transform="rotate(30)" style="transform-box:fill-box;transform-origin:center"'
LINE = 'd="M40 60H160"'
SHAPE = 'd="M40 50H150V140Z"'
BOX = 'x="60" y="100" width="80" height="40"'
PATTERN = (
    '<pattern id="p" patternUnits="userSpaceOnUse" width="20" height="20"><path d="M0 10H20" stroke-width="2"/>'
    "</pattern>"
)


def paint_servers() -> dict[str, str]:
    servers = {
        "pattern": PATTERN,
        "pattern without content": '<pattern id="p" width="20" height="20" patternUnits="userSpaceOnUse"/>',
        "pattern without size": '<pattern id="p"><rect width="9" height="9" fill="#000"/></pattern>',
        "gradient": '<linearGradient id="p"><stop/><stop offset="1" stop-color="#fff"/></linearGradient>',
        "gradient without stops": '<linearGradient id="p"/>',
        "gradient of one stop": '<linearGradient id="p"><stop/></linearGradient>',
        "gradient of one faint stop": '<linearGradient id="p"><stop stop-opacity=".3"/></linearGradient>',
        "gradient by reference": '<linearGradient id="q"><stop/></linearGradient><radialGradient id="p" href="#q"/>',
        "gradient by old reference": '<linearGradient id="q"><stop/></linearGradient>'
        '<radialGradient id="p" xlink:href="#q"/>',
        "gradient that refers to itself": '<linearGradient id="p" href="#p"/>',
        "no paint server": '<rect id="p"/>',
        "nothing": "",
    }
    return {
        f"{what} is {name}": page(f"{server}<path {SHAPE} {paint}/>")
        for name, server in servers.items()
        for what, paint in {
            "fill": 'fill="url(#p)" stroke="none"',
            "fill with a stroke": 'fill="url(#p)"',
            "stroke": 'stroke="url(#p)"',
            "stroke with a fill": 'stroke="url(#p)" fill="#000"',
            "fill with a fallback": 'fill="url(#p) #000" stroke="none"',
        }.items()
    }


def alphas() -> dict[str, str]:
    colours = (
        "#0003 #00000033 rgba(0,0,0,.2) rgb(0_0_0_/_20%) hsla(0,0%,0%,.2) hsl(0_0%_0%_/_.2) "
        "color(srgb_0_0_0_/_.2) transparent #0000 rgba(0,0,0,0) rgb(0,0,0,1) #000f"
    ).split()
    return {
        f"{what} {colour.replace('_', ' ')}": page(
            f'<path {SHAPE} color="{colour.replace("_", " ")}" {paint.replace("@", colour.replace("_", " "))}/>'
        )
        for colour in colours
        for what, paint in {
            "stroke": 'stroke="@"',
            "fill": 'fill="@" stroke="none"',
            "fill with a stroke": 'fill="@"',
            "stroke with a fill": 'fill="#000" stroke="@"',
            "currentColor": 'stroke="currentColor"',
        }.items()
    }


def opacities() -> dict[str, str]:
    return {
        f"{name} {value!r}": page(f'<path {SHAPE} {fill} {name}="{value}"/>')
        for name in ("opacity", "stroke-opacity", "fill-opacity")
        for fill in ('fill="#000"',)
        for value in ("0", "0%", ".3", "30%", "1", "100%", "2", "-1", "", "x", "1e-9", "calc(.2)")
    }


ORIGINS = (
    "top|bottom|left|right|center|top left|left top|bottom right|right bottom|center top|top center|center left|"
    "left center|10px|10px 20px|10 20|25%|25% 75%|left 20px|20px top|20px bottom|top 20px|10px 20px 5px|"
    "top left 0|center center|1cm 2em|x|20px left||0 0|left left|calc(10px + 5px) 20px|-10px 50%|TOP"
).split("|")


def origins() -> dict[str, str]:
    ways = {
        "attribute": 'transform="rotate(30)" transform-origin="{}"',
        "property": 'style="transform: rotate(30deg); transform-origin: {}"',
    }
    boxes = {
        "": "",
        " fill-box": ' style="transform-box: fill-box"',
    }
    found = {
        f"transform-origin {way} {origin!r}": page(f"<rect {BOX} {text.format(origin)}/>")
        for way, text in ways.items()
        for origin in ORIGINS
    }
    found |= {
        f"transform-box {box} {origin}": page(
            f'<{tag} transform="rotate(30)" style="transform-box:{box};transform-origin:{origin}"'
        )
        for box in ("fill-box", "view-box", "stroke-box", "content-box", "border-box")
        for origin in ("center", "top left", "25% 10px", "0 0")
        for tag in (f"rect {BOX}/>",)
    }
    found |= {
        f"transform-box on {name}": page(body)
        for name, body in {
            "a group": f"<g {MIDDLE}><rect {BOX}/></g>",
            "a use": f'<defs><rect id="a" {BOX}/></defs><use href="#a" {MIDDLE}/>',
            "a path": f"<path {SHAPE} {MIDDLE}/>",
            "a path by attribute": f'<path {SHAPE} transform="rotate(30)" transform-box="fill-box" '
            'transform-origin="center"/>',
            "a path without origin": f'<path {SHAPE} transform="rotate(30)" style="transform-box:fill-box"/>',
            "a circle": '<circle cx="100" cy="80" r="30" style="transform:scale(.5);transform-box:fill-box;'
            'transform-origin:100% 100%"/>',
        }.items()
    }
    found["transform-origin in a viewBox"] = page(
        f'<rect {BOX} transform="rotate(30)" transform-origin="50% 50%"/>',
        'width="200" height="200" viewBox="10 20 190 190"',
    )
    del boxes
    return found


def transforms() -> dict[str, str]:
    attributes = (
        "rotate(20)|rotate(20deg)|rotate(20 100 100)|translate(10px 5px)|translate(10,5)|scale(50%)|translate(10%)|"
        "skewX(10)|rotate(.1turn)|matrix(1 0 0 1 10 5)|none|translate(10)translate(0 9)|rotate(20),translate(9)|"
        "scale(1.2)|translate(|rotate(20) x|ROTATE(20)|translate(1e1)|scale(-1 1)|scale(0)|skew(10)|scaleX(.5)|  |"
        "rotate(20,100)|translateX(10)"
    ).split("|")
    properties = (
        "rotate(20deg)|rotate(20)|rotate(0)|translate(10px, 5px)|translate(10 5)|translate(10px 5px)|translate(0)|"
        "translate(10%, 20%)|scale(50%)|scale(.5, 1.2)|skew(10deg, 5deg)|skew(10deg)|rotate(.05turn)|rotate(20grad)|"
        "rotate(.3rad)|matrix(1, 0, 0, 1, 10, 5)|matrix(1 0 0 1 10 5)|none|translate3d(10px, 5px, 0)|"
        "rotate3d(0,0,1,20deg)|"
        "rotateZ(20deg)|rotateX(40deg)|scale3d(.5,.5,1)|matrix3d(1,0,0,0,0,1,0,0,0,0,1,0,10,5,0,1)|"
        "perspective(100px) translateZ(10px)|"
        "translate(calc(10px + 5px), 5px)|scaleY(.5)|translateY(1cm)|translate(2em)|"
        "rotate(calc(10deg * 2))|rotate(20deg) x|ROTATE(20DEG)|translate( 10px , 5px )|rotate(20deg, 10px, 10px)|"
        "translate(10px)translate(0px,9px)|translate(10px),translate(9px)"
    ).split("|")
    found = {f"transform {text!r}": page(f'<path {SHAPE} transform="{text}"/>') for text in attributes}
    found |= {
        f"CSS transform {text!r}": page(f'<path {SHAPE} transform="translate(3)" style="transform: {text}"/>')
        for text in properties
    }
    found |= {
        f"CSS {text}": page(f'<path {SHAPE} style="{text}"/>')
        for text in (
            "rotate: 20deg",
            "rotate: z 20deg",
            "translate: 10px 5px",
            "translate: 10%",
            "scale: .5",
            "scale: 50% 120%",
            "rotate: 20deg; scale: .5; translate: 10px; transform: translate(5px)",
            "rotate: none",
            "scale: 1",
            "translate: 0",
            "rotate: 20deg; transform-origin: 100px 100px",
            "zoom: .5",
            "offset-path: path('M0 0L90 90'); offset-distance: 50%",
            "offset-path: path('M10 10L90 90'); offset-rotate: 0deg",
        )
    }
    found["rotate property of a group"] = page(f'<g style="rotate:20deg"><path {SHAPE}/></g>')
    found["transform of the root"] = page(f"<path {SHAPE}/>", 'width="200" height="200" transform="rotate(10)"')
    found["CSS transform of the root"] = page(
        f"<path {SHAPE}/>", 'width="200" height="200" style="transform:rotate(10deg)"'
    )
    found["transform of a nested svg"] = page(f'<svg transform="rotate(10)"><path {SHAPE}/></svg>')
    found["x and y of a root"] = page(f"<path {SHAPE}/>", 'width="200" height="200" x="20" y="10"')
    return found


def looks() -> dict[str, str]:
    clip = '<clipPath id="c"><rect width="100" height="100"/></clipPath>'
    mask = '<mask id="m"><rect width="100" height="100" fill="#fff"/></mask>'
    filters = '<filter id="f"><feOffset dx="20"/></filter>'
    dot = '<circle cx="2" cy="2" r="2" fill="#000" stroke="none"/>'
    marker = f'<marker id="k" markerWidth="4" markerHeight="4" refX="2" refY="2">{dot}</marker>'
    return {
        "clip-path": page(f'{clip}<path {SHAPE} clip-path="url(#c)"/>'),
        "clip-path by shape": page(f'<path {SHAPE} style="clip-path:inset(10px 30px)"/>'),
        "clip-path by shape in an attribute": page(f'<path {SHAPE} clip-path="circle(30px)"/>'),
        "clip-path of nothing": page(f'<path {SHAPE} clip-path="url(#none)"/>'),
        "clip": page(f'<svg width="200" height="200" style="clip:rect(0px,100px,100px,0px)"><path {SHAPE}/></svg>'),
        "clip-path on a group": page(f'{clip}<g clip-path="url(#c)"><path {SHAPE}/></g>'),
        "mask": page(f'{mask}<path {SHAPE} mask="url(#m)"/>'),
        "mask-image": page(f'<path {SHAPE} style="mask-image:linear-gradient(90deg,#000,transparent)"/>'),
        "-webkit-mask": page(f'{mask}<path {SHAPE} style="-webkit-mask:url(#m)"/>'),
        "-webkit-mask-image": page(f'{mask}<path {SHAPE} style="-webkit-mask-image:url(#m)"/>'),
        "-webkit-clip-path": page(f'<path {SHAPE} style="-webkit-clip-path:inset(10px 30px)"/>'),
        "-webkit-filter": page(f'<path {SHAPE} style="-webkit-filter:opacity(.3)"/>'),
        "-webkit-transform": page(f'<path {SHAPE} style="-webkit-transform:rotate(20deg)"/>'),
        "-webkit-transform-origin": page(
            f'<path {SHAPE} style="-webkit-transform:rotate(20deg);-webkit-transform-origin:50% 50%"/>'
        ),
        "filter": page(f'{filters}<path {SHAPE} filter="url(#f)"/>'),
        "filter function": page(f'<path {SHAPE} style="filter:opacity(.3)"/>'),
        "filter of nothing": page(f'<path {SHAPE} filter="url(#none)"/>'),
        "marker": page(f'{marker}<path {SHAPE} marker-end="url(#k)"/>'),
        "marker shorthand": page(f'{marker}<path {SHAPE} style="marker:url(#k)"/>'),
        "marker on a group": page(f'{marker}<g marker-mid="url(#k)"><path {SHAPE}/></g>'),
        "marker on a circle": page(f'{marker}<circle cx="90" cy="90" r="40" marker-start="url(#k)"/>'),
        "mix-blend-mode": page(
            f'<rect width="200" height="200" fill="#000" stroke="none"/>'
            f'<path {SHAPE} stroke="#fff" style="mix-blend-mode:difference"/>'
        ),
        "paint-order": page(f'<path {SHAPE} fill="#fff" paint-order="stroke"/>'),
        "white fill": page(f'<path {SHAPE} fill="#fff"/>'),
        "white stroke": page(f'<path {SHAPE} fill="#000" stroke="#fff"/>'),
        "white over black": page(f'<path {SHAPE} fill="#000"/><rect {BOX} fill="#fff" stroke="none"/>'),
        "vector-effect": page(f'<path {SHAPE} transform="scale(.5)" vector-effect="non-scaling-stroke"/>'),
        "vector-effect non-scaling-size": page(
            f'<path {SHAPE} transform="scale(.5)" vector-effect="non-scaling-size"/>'
        ),
        "vector-effect of dashes": page(
            f'<path {LINE} transform="scale(1 2)" stroke-dasharray="20" vector-effect="non-scaling-stroke"/>'
        ),
        "vector-effect on a group": page(
            f'<g transform="scale(.5)" vector-effect="non-scaling-stroke"><path {SHAPE}/></g>'
        ),
        "vector-effect in a viewBox": page(
            f'<path {SHAPE} vector-effect="non-scaling-stroke"/>',
            'width="200" height="200" viewBox="0 0 400 400"',
        ),
        "shape-inside": page(f'<path {SHAPE} style="shape-rendering:crispEdges"/>'),
        "visibility on use": page(
            f'<defs><path id="a" {LINE}/></defs><use href="#a" visibility="hidden"/><path {SHAPE}/>'
        ),
        "visible in a hidden group": page(
            f'<g visibility="hidden"><path {LINE} visibility="visible"/><path {SHAPE}/></g>'
        ),
        "visibility x": page(f'<path {SHAPE} visibility="x"/>'),
        "display x": page(f'<path {SHAPE} display="x"/>'),
        "display block": page(f'<path {SHAPE} display="block"/>'),
        "display contents": page(f'<g display="contents" transform="translate(20)"><path {SHAPE}/></g>'),
        "display contents of a path": page(f'<path {LINE}/><path {SHAPE} style="display:contents"/>'),
        "content-visibility": page(f'<path {LINE}/><g style="content-visibility:hidden"><path {SHAPE}/></g>'),
        "hidden attribute": page(f'<path {SHAPE} hidden=""/>'),
        "mask-type": page(
            f'<mask id="m" style="mask-type:alpha"><rect width="100" height="100"/></mask>'
            f'<path {SHAPE} mask="url(#m)"/>'
        ),
        "mask of nothing": page(f'<path {SHAPE} mask="url(#none)"/>'),
        "backface-visibility": page(f'<path {SHAPE} style="transform:rotateY(180deg);backface-visibility:hidden"/>'),
        "isolation": page(f'<g style="isolation:isolate"><path {SHAPE}/></g>'),
        "overflow visible": page(
            '<svg x="50" y="50" width="50" height="50" overflow="visible"><path d="M0 0L90 90"/></svg>'
        ),
        "overflow hidden": page('<svg x="50" y="50" width="50" height="50"><path d="M0 0L90 90"/></svg>'),
        "overflow of the root": page('<path d="M-50 0L90 90"/>'),
        "overflow of a marker": page(f'<path {SHAPE} style="overflow:hidden"/>'),
        "rx of a path": page(f'<path {SHAPE} rx="5"/>'),
    }


def widths() -> dict[str, str]:
    values = (
        "0|-3|12|12px|3mm|5%|1em|1rem|3ch|5vw|1vh|nan|inf|1e3|1e400||thin|medium|thick|calc(6px + 6px)|var(--w)|"
        "var(--w, 12)|  12  |12 |12PX|+12|.5e1|min(3px, 9px)|1lh|2vmin|1in/8|12 px|inherit|initial|unset|auto"
    ).split("|")
    return {
        f"{way} stroke-width {value!r}": page(f"<path {SHAPE} {text.format(value)}/>")
        for value in values
        for way, text in {"attribute": 'stroke-width="{}"', "property": 'style="stroke-width:{}"'}.items()
    }


def geometries() -> dict[str, str]:
    values = (
        "0|-30|60|60px|1cm|30%|4em|nan|inf|1e400|||auto|none|calc(20px + 40px)|  60  |60 px|x|1e2|5vw|3ch|"
        "min(30px,60px)"
    ).split("|")
    shapes = {
        "rect width": '<rect x="40" y="40" height="60" {}/>',
        "rect height": '<rect x="40" y="40" width="60" {}/>',
        "rect x": '<rect y="40" width="60" height="60" {}/>',
        "rect rx": '<rect x="40" y="40" width="60" height="60" {}/>',
        "rect ry": '<rect x="40" y="40" width="60" height="60" rx="10" {}/>',
        "circle r": '<circle cx="90" cy="90" {}/>',
        "circle cx": '<circle cy="90" r="30" {}/>',
        "ellipse rx": '<ellipse cx="90" cy="90" ry="30" {}/>',
        "line x1": '<line y1="40" x2="120" y2="100" {}/>',
        "use x": '<defs><path id="a" d="M10 20H100"/></defs><use href="#a" {}/>',
        "svg width": '<svg x="10" y="10" height="150" viewBox="0 0 100 100" {}><path d="M10 10L90 90"/></svg>',
        "svg x": '<svg y="10" width="150" height="150" viewBox="0 0 100 100" {}><path d="M10 10L90 90"/></svg>',
    }
    found = {}
    for name, shape in shapes.items():
        attribute = name.split()[1]
        for value in values:
            found[f"{name} {value!r}"] = page(shape.format(f'{attribute}="{value}"') + '<path d="M5 5h9"/>')
            found[f"CSS {name} {value!r}"] = page(shape.format(f'style="{attribute}:{value}"') + '<path d="M5 5h9"/>')
    found |= {
        f"root {name}": page("<path d='M40 50H150V140Z'/>", size)
        for name, size in {
            "width empty": 'width="" height="200" viewBox="0 0 200 200"',
            "height empty": 'width="200" height="" viewBox="0 0 200 200"',
            "viewBox empty": 'width="200" height="200" viewBox=""',
            "viewBox of three": 'width="200" height="200" viewBox="0 0 200"',
            "viewBox of zero": 'width="200" height="200" viewBox="0 0 0 0"',
            "viewBox of zero width": 'width="200" height="200" viewBox="0 0 0 200"',
            "viewBox negative": 'width="200" height="200" viewBox="0 0 -20 200"',
            "viewBox with units": 'width="200" height="200" viewBox="0 0 100px 100px"',
            "preserveAspectRatio empty": 'width="200" height="200" viewBox="0 0 100 200" preserveAspectRatio=""',
            "preserveAspectRatio x": 'width="200" height="200" viewBox="0 0 100 200" preserveAspectRatio="xmidymin"',
        }.items()
    }
    return found


def dashes() -> dict[str, str]:
    patterns = (
        "20 10|20,10|20|20 10 5|0 20|20 0|0|none||-5 10|x|10%|5mm 3mm|20px 10px|20 , 10|20 10,|calc(10px*2) 10|nan|1em|"
        "inherit|20 10 / 5"
    ).split("|")
    found = {f"dasharray {text!r}": page(f'<path {LINE} stroke-dasharray="{text}"/>') for text in patterns}
    found |= {
        f"dashoffset {text!r}": page(f'<path {LINE} stroke-dasharray="20 30" stroke-dashoffset="{text}"/>')
        for text in "0|10|-10|5%|1em|x||2mm|calc(5px + 5px)|none".split("|")
    }
    found |= {
        f"pathLength {text!r}": page(f'<path {LINE} stroke-dasharray="20 30" pathLength="{text}"/>')
        for text in "100|120|240|0|-5|x||nan|1e400".split("|")
    }
    found["pathLength of a circle"] = page('<circle cx="90" cy="90" r="50" stroke-dasharray="10 15" pathLength="100"/>')
    found["pathLength of a rect with an offset"] = page(
        f'<rect {BOX} stroke-dasharray="10 15" stroke-dashoffset="5" pathLength="100"/>'
    )
    found["pathLength without dashes"] = page(f'<path {SHAPE} pathLength="10"/>')
    return found


def paths() -> dict[str, str]:
    texts = (
        "path('M40 50H150V140Z')|none|path('')|path(evenodd, 'M40 50H150V140Z')|M40 50H150V140Z|url(#a)|"
        "path('M40 50H150V140Z' x)|PATH('M40 50H150V140Z')|circle(50px)|inset(10px)"
    ).split("|")
    found = {f"CSS d: {text}": page(f'<path d="M10 10H60" style="d: {text}"/><path d="M5 5h9"/>') for text in texts}
    attributes = (
        "none| |M40 50H150V140Z x|m40 50H150|M40 50 L|M 1e400 5L50 50|M nan 5L9 9|L5 5|M40,50,150,50|M40 50\tH150"
    ).split("|")
    found |= {f"d {text!r}": page(f'<path d="{text}"/><path d="M5 5h9"/>') for text in attributes}
    found |= {
        f"points {text!r}": page(f'<polyline points="{text}"/><path d="M5 5h9"/>')
        for text in "40,50 150,50|40,50 150|40 50|x|40 50 150 50 x|40,,50 60,60|40px 50px 150px 60px".split("|")
    }
    return found


def references() -> dict[str, str]:
    a = f'<defs><path id="a" {LINE}/><path id="b" {SHAPE}/></defs>'
    return {
        "href wins": page(f'{a}<use href="#a" xlink:href="#b"/>'),
        "href empty": page(f'{a}<use href="" xlink:href="#b"/><path d="M5 5h9"/>'),
        "href with blanks": page(f'{a}<use href=" #a "/><path d="M5 5h9"/>'),
        "href escaped": page(f'<defs><path id="ä b" {LINE}/></defs><use href="#%C3%A4%20b"/><path d="M5 5h9"/>'),
        "href to a file": page('<use href="x.svg#a"/><path d="M5 5h9"/>'),
        "href to this file and a name": page(f'{a}<use href="./#a"/><path d="M5 5h9"/>'),
        "two of one id": page(f'<defs><path id="a" {LINE}/><path id="a" {SHAPE}/></defs><use href="#a"/>'),
        "use of a symbol hidden": page(
            f'<symbol id="s" display="none"><path {LINE}/></symbol><use href="#s"/><path {SHAPE}/>'
        ),
        "use of a marker": page(f'<marker id="s"><path {LINE}/></marker><use href="#s"/><path {SHAPE}/>'),
        "use of a clipPath": page(f'<clipPath id="s"><path {LINE}/></clipPath><use href="#s"/><path {SHAPE}/>'),
        "use of a path in a clipPath": page(
            f'<clipPath><path id="s" {LINE}/></clipPath><use href="#s"/><path {SHAPE}/>'
        ),
        "use of the root": page(f'<use href="#r"/><path {SHAPE}/>', 'id="r" width="200" height="200"'),
        "use of text": page(f'<defs><text id="t" y="50">word</text></defs><use href="#t"/><path {SHAPE}/>'),
        "image": page(
            f'<image width="90" height="90" href="data:image/svg+xml,%3Csvg xmlns=%22http://www.w3.org/2000/svg%22 '
            f'width=%2290%22 height=%2290%22%3E%3Crect width=%2290%22 height=%2290%22/%3E%3C/svg%3E"/><path {SHAPE}/>'
        ),
        "image without size or href": page(f"<image/><path {SHAPE}/>"),
        "foreignObject": page(
            '<foreignObject width="100" height="100"><div xmlns="http://www.w3.org/1999/xhtml" '
            f'style="background:#000;height:50px"/></foreignObject><path {SHAPE}/>'
        ),
        "svg in a foreignObject": page(
            f'<foreignObject width="200" height="200"><svg width="200" height="200"><path {LINE}/></svg>'
            f"</foreignObject><path {SHAPE}/>"
        ),
        "text": page(f'<text y="90" font-size="40" fill="#000">word</text><path {SHAPE}/>'),
        "tspan without text": page(f"<tspan>word</tspan><path {SHAPE}/>"),
        "html in svg": page(f'<p xmlns="http://www.w3.org/1999/xhtml">word</p><path {SHAPE}/>'),
        "video": page(f'<video width="90" height="90"/><path {SHAPE}/>'),
        "a path in another namespace": page(f'<x:path xmlns:x="urn:x" {LINE}/><path {SHAPE}/>'),
        "a path in an unknown element": page(f"<unknown><path {LINE}/></unknown><path {SHAPE}/>"),
        "a path in a path": page(f"<path {SHAPE}><path {LINE}/></path>"),
        "a path in a title": page(f"<title><path {LINE}/></title><path {SHAPE}/>"),
        "a path in a text": page(f"<text><path {LINE}/></text><path {SHAPE}/>"),
        "a g in a rect": page(f"<rect {BOX}><g><path {LINE}/></g></rect>"),
        "animate": page(
            f'<path {SHAPE}><animate attributeName="d" to="M5 5h50" begin="0s" dur="1ms" fill="freeze"/></path>'
        ),
        "set": page(f'<path {LINE}/><path {SHAPE}><set attributeName="display" to="none"/></path>'),
        "animateTransform": page(
            f'<path {SHAPE}><animateTransform attributeName="transform" type="rotate" from="20" to="20" '
            'dur="9s"/></path>'
        ),
        "CSS animation": page(
            f"<style>@keyframes k{{from{{transform:translate(20px)}}to{{transform:translate(20px)}}}}"
            f"path{{animation:k 9s infinite}}</style><path {SHAPE}/>"
        ),
        "script": page(f'<path id="a" {LINE}/><script>document.getElementById("a").remove()</script><path {SHAPE}/>'),
        "systemLanguage": page(f'<path {LINE} systemLanguage="de"/><path {SHAPE}/>'),
        "systemLanguage empty": page(f'<path {LINE} systemLanguage=""/><path {SHAPE}/>'),
        "systemLanguage en-US": page(f'<path {LINE} systemLanguage="en-US"/><path {SHAPE}/>'),
        "requiredExtensions empty": page(f'<path {LINE} requiredExtensions=""/><path {SHAPE}/>'),
        "requiredExtensions html": page(
            f'<path {LINE} requiredExtensions="http://www.w3.org/1999/xhtml"/><path {SHAPE}/>'
        ),
        "requiredFeatures": page(f'<path {LINE} requiredFeatures="x"/><path {SHAPE}/>'),
        "switch with a foreignObject": page(
            f'<switch><foreignObject width="50" height="50"/><path {LINE}/></switch><path {SHAPE}/>'
        ),
        "switch with a hidden first": page(
            f'<switch><path {LINE} display="none"/><path {SHAPE}/></switch><path d="M5 5h9"/>'
        ),
        "context-fill": page(f'<path {SHAPE} fill="context-fill"/>'),
        "context-stroke": page(f'<path {LINE}/><path {SHAPE} stroke="context-stroke"/>'),
        "nested a": page(f"<a><a><path {SHAPE}/></a></a>"),
        "view": page(f'<view id="v" viewBox="0 0 9 9"/><path {SHAPE}/>'),
        "mesh": page(f"<mesh><path {LINE}/></mesh><path {SHAPE}/>"),
        "hatch": page(f'<hatch id="h" pitch="5"><hatchpath/></hatch><path {SHAPE} fill="url(#h)"/>'),
        "solidColor": page(f'<solidColor id="h" solid-color="#000"/><path {SHAPE} fill="url(#h)"/>'),
    }


def sheets() -> dict[str, str]:
    def with_rules(rules: str, attributes: str = "") -> str:
        return page(f'<style {attributes}>{rules}</style><path class="a" {LINE}/><path id="b" {SHAPE}/>')

    rules = (
        ".a{display:none}",
        "@media print{.a{display:none}}",
        "@media screen and (min-width:1px){.a{display:none}}",
        "@media (min-width:1px){.a{display:none}}",
        "@media not print{.a{display:none}}",
        "@media (prefers-color-scheme:dark){.a{display:none}}",
        "@media all and (max-width:1px){.a{display:none}}",
        "@supports (fill:red){.a{display:none}}",
        "@supports not (fill:red){.a{display:none}}",
        "@layer x{.a{display:none}}",
        "@layer x;.a{display:none}",
        "@container (min-width:1px){.a{display:none}}",
        "@scope (svg){.a{display:none}}",
        "svg{.a{display:none}}",
        "svg{& .a{display:none}}",
        "svg{stroke-width:20;}",
        ":is(.a){display:none}",
        ":where(.a){display:none}",
        "path:not(#b){display:none}",
        "path:nth-of-type(1){display:none}",
        "svg:has(.a) .a{display:none}",
        ".A{display:none}",
        "PATH.a{display:none}",
        "[class=a]{display:none}",
        ":root .a{display:none}",
        ".a:hover{display:none}",
        ".a:link{display:none}",
        "path:empty{display:none}",
        ".a::before{content:'x'}",
        "*|path.a{display:none}",
        "@namespace s url(http://www.w3.org/2000/svg);s|path.a{display:none}",
        "@namespace s url(urn:x);s|path.a{display:none}",
        "@namespace url(urn:x);path.a{display:none}",
        ".a{all:unset}",
        ".a{all:initial}",
        ".a{stroke:initial}",
        ".a{stroke:none !important}",
        ".a{stroke:none!ie}",
        ".a{stroke-width:20px;stroke-width:x}",
        "&lt;!-- .a{display:none} --&gt;",
        ".a{display:none",
        ".a{stroke:light-dark(#000,#fff)}",
        ".a{stroke:color-mix(in srgb,#000,#fff)}",
        ".a{stroke-width:env(x,20px)}",
        ".a{stroke:CanvasText}",
        ".a{stroke:red;stroke:oklch(0 0 0)}",
        ".a{visibility:hidden}",
        "@import url(x.css);",
        ".a{width:5px}",
        ".a{inset:5px}",
        ".a{position:relative;left:50px}",
        ".a{margin:20px}",
        ".a{opacity:0}",
        ".a{clip-rule:evenodd}",
        ".a{stroke-dasharray:9 5}",
        ".a{cx:5px;d:path('M5 5h9')}",
        ".a{x:50px}",
        "#b{fill:#000;fill-rule:evenodd}",
        "@property --w{syntax:'*';inherits:false;initial-value:20}.a{stroke-width:var(--w)}",
        ".a{-webkit-text-stroke:5px}",
        "@starting-style{.a{display:none}}",
        "@page{size:a4}.a{display:none}",
    )
    found = {f"rule {text}": with_rules(text) for text in rules}
    found |= {
        f"style {attributes}": with_rules(".a{display:none}", attributes)
        for attributes in (
            'media="print"',
            'media="screen"',
            'media=""',
            'media="all"',
            'media="(min-width: 1px)"',
            'media="screen, print"',
            'type="text/css"',
            'type=""',
            'type="text/less"',
            'type="TEXT/CSS"',
            'type="text/css; charset=utf-8"',
            'title="x"',
            'disabled=""',
        )
    }
    found["style in defs"] = page(
        f'<defs><style>.a{{display:none}}</style></defs><path class="a" {LINE}/><path {SHAPE}/>'
    )
    found["style in a group"] = page(f'<g><style>.a{{display:none}}</style></g><path class="a" {LINE}/><path {SHAPE}/>')
    found["html style"] = page(
        f'<style xmlns="http://www.w3.org/1999/xhtml">.a{{display:none}}</style><path class="a" {LINE}/><path {SHAPE}/>'
    )
    found["style attribute with a comment"] = page(f'<path {LINE} style="/* x */display:none"/><path {SHAPE}/>')
    found["style attribute broken"] = page(f'<path {LINE} style="display none; stroke-width:20"/><path {SHAPE}/>')
    found["style attribute with braces"] = page(f'<path {LINE} style="{{display:none}}"/><path {SHAPE}/>')
    found["xml:space and lang"] = page(f'<path {LINE} xml:lang="de"/><path {SHAPE}/>')
    found["lang rule"] = page(f'<style>:lang(de){{display:none}}</style><path {LINE} xml:lang="de"/><path {SHAPE}/>')
    found["fill rule"] = page(
        '<path d="M20 20H150V150H20ZM50 50H120V120H50Z" fill="#000" stroke="none" fill-rule="evenodd"/>'
    )
    found["fill rule x"] = page(
        '<path d="M20 20H150V150H20ZM50 50H120V120H50Z" fill="#000" stroke="none" fill-rule="x"/>'
    )
    return found


def copies() -> dict[str, str]:
    """Return drawings that show which rules apply to copies of `use`."""
    defined = f'<defs><i/><g id="g"><path id="p" {LINE}/><path id="q" {SHAPE}/></g></defs>'
    selectors = (
        "#p|path|g path|svg path|svg > path|defs path|.here path|use path|use > g|g > path:first-child|path + path|"
        "i + g|g:nth-child(2)|g:first-child|g:only-of-type|:root path|*:not(:root) path|path:nth-child(2)|"
        ":is(defs, g) > path"
    )
    return {
        f"{selector} of {name}": page(
            f"<style>{selector.replace('>', '&gt;')}{{stroke-width:20}}</style>{defined}"
            f'<g class="here"><use href="#{name}"/></g>'
        )
        for selector in selectors.split("|")
        for name in "gpq"
    }


TABLES = {
    table.__name__: table()
    for table in (
        *(paint_servers, alphas, opacities, origins, transforms, looks),
        *(widths, geometries, dashes, paths, references, sheets, copies),
    )
}
# Here Chromium differs from SVG 2: auto and empty attributes, CSS on a nested svg, links in links.
CHROMIUMS_OWN = {
    *("rect ry ''", "rect ry 'auto'", "ellipse rx ''", "ellipse rx 'auto'", "pathLength ''"),
    *("requiredExtensions html", "nested a"),
    *(
        "clip-path",
        "clip-path on a group",
        "overflow hidden",
    ),  # lines are cut across at their middle, as brushes end
    *(name for name in TABLES["geometries"] if name.startswith("CSS svg")),
}
# These drawings must be painted as shown and without a notice. Otherwise a reader could report everything.
PLAIN = [
    *("vector-effect of dashes", "#p of g", "use path of g", "path + path of g"),
    "html style",
    *(
        "fill with a stroke is gradient without stops",
        "fill is gradient of one stop",
        "fill with a stroke transparent",
    ),
    *("stroke rgb(0,0,0,1)", "fill-opacity '0'", "stroke-opacity '2'", "opacity '100%'"),
    *(
        "transform-origin attribute 'top'",
        "transform-origin property 'bottom right'",
        "transform-box fill-box center",
    ),
    *("transform-box on a circle", "CSS transform 'rotate(20deg)'", "CSS transform 'translate(10%, 20%)'"),
    *("CSS rotate: 20deg", "CSS translate: 10%", "-webkit-transform-origin", "transform of a nested svg"),
    *("vector-effect on a group", "visible in a hidden group", "visibility x", "overflow visible"),
    *("attribute stroke-width '5%'", "attribute stroke-width ''", "property stroke-width 'inherit'"),
    *("rect rx '60'", "circle r '4em'", "use x '30%'", "svg width '1cm'", "rect rx ''", "CSS rect ry 'auto'"),
    *(
        "dasharray '20 10'",
        "dasharray '20 10 5'",
        "dashoffset '-10'",
        "pathLength '240'",
        "pathLength of a circle",
    ),
    *("CSS d: path('M40 50H150V140Z')", "CSS d: M40 50H150V140Z", "href wins", "switch with a hidden first"),
    *(
        "rule svg:has(.a) .a{display:none}",
        "rule @media print{.a{display:none}}",
        'style media="print"',
        "html style",
    ),
]
