"""Small drawings of features that decide whether and how a shape is painted.

These are conditions, CSS and paint. The tables have the form of svg_features.py.
"""

from svg_features import page


def styled(rules: str, body: str) -> str:
    return page(f"<style>{rules}</style>{body}")


CHOICES = {
    "switch by language": page(
        '<switch><path systemLanguage="de" d="M0 5h2"/><path systemLanguage="fr, en" d="M0 5h3"/>'
        '<path d="M0 5h4"/></switch><switch><path systemLanguage="en-GB" d="M0 9h2"/><path d="M0 9h4"/></switch>'
        '<switch><path systemLanguage="de" d="M0 15h9"/><path d="M0 15h20"/></switch>'
    ),
    "switch as Illustrator writes it": page(
        "<switch>"
        '<foreignObject requiredExtensions="http://ns.adobe.com/AdobeIllustrator/10.0/" x="0" y="0" width="1" '
        'height="1"/><g i:extraneous="self"><path d="M0 5h9"/><path d="M0 9h9"/></g></switch>',
        'width="300" height="200" xmlns:i="http://ns.adobe.com/AdobeIllustrator/10.0/"',
    ),
    "switch without a choice": page('<switch><path requiredExtensions="x" d="M0 5h9"/></switch><path d="M0 9h9"/>'),
    "conditions outside of a switch": page('<path systemLanguage="de" d="M0 5h9"/><path d="M0 9h9"/>'),
    "links": page('<a href="https://example.org"><path d="M0 5h9"/><g><path d="M0 9h9"/></g></a>'),
    "definitions": page(
        '<defs><path d="M0 1h9"/><g><path d="M0 2h9"/></g></defs><clipPath id="c"><path d="M0 3h9v9"/></clipPath>'
        '<mask id="m"><path d="M0 4h9"/></mask><pattern id="p" width="5" height="5"><path d="M0 5h9"/></pattern>'
        '<marker id="k"><path d="M0 6h9"/></marker><symbol><path d="M0 7h9"/></symbol><linearGradient>'
        '<path d="M0 9h5"/></linearGradient><path d="M0 8h9"/>'
    ),
    "clipped and masked": page(
        '<clipPath id="c"><circle cx="9" cy="9" r="9"/></clipPath><mask id="m">'
        '<path d="M0 0h50v50z" fill="#fff"/></mask><path clip-path="url(#c)" d="M0 5h90"/><g mask="url(#m)">'
        '<path d="M0 9h90"/></g>'
    ),
    "other elements": page(
        '<title>t</title><desc>d</desc><metadata><path d="M0 1h9"/></metadata><text x="9" y="9">word</text>'
        '<x:path xmlns:x="urn:x" d="M0 2h9"/><unknown><path d="M0 3h9"/></unknown><foreignObject>'
        '<path d="M0 4h9"/></foreignObject><path d="M0 5h9"/>'
    ),
    "display none": page(
        '<g display="none"><path display="inline" d="M0 5h9"/></g><path style="display:none" d="M0 6h9"/>'
        '<path d="M0 9h9"/>'
    ),
    "visibility": page(
        '<g visibility="hidden"><path d="M0 5h9"/><path visibility="visible" d="M0 6h9"/></g>'
        '<path visibility="collapse" d="M0 7h9"/><path style="visibility:hidden" d="M0 8h9"/><path d="M0 9h9"/>'
    ),
    "opacity": page(
        '<g opacity="0"><path d="M0 5h9"/></g><path opacity="0" d="M0 6h9"/><path stroke-opacity="0" d="M0 7h9"/>'
        '<path style="opacity:0" d="M0 8h9"/><path opacity=".5" d="M0 9h9"/>'
        '<path stroke-opacity="50%" d="M0 10h9"/><path fill="red" fill-opacity="0" d="M0 9h9v9"/>'
        '<path stroke-opacity="0" fill="red" d="M0 9h9v9"/>'
    ),
}
STYLES = {
    "element, class, id": styled(
        "path{stroke:red} .a{stroke-width:3} #i{stroke:#00f} .b.a{stroke:#0f0} *{stroke-width:2}",
        '<path d="M0 5h9"/><path class="a" d="M0 6h9"/><path id="i" class="b" d="M0 7h9"/>'
        '<path class=" b  a " d="M0 8h9"/>',
    ),
    "combinators": styled(
        "g path{stroke:red} g>path{stroke-width:3} path+path{stroke-opacity:.5;stroke:#00f} svg > path{stroke:lime}",
        '<path d="M0 5h9"/><g><path d="M0 6h9"/><path d="M0 7h9"/><a><path d="M0 8h9"/></a></g>',
    ),
    "attributes and first-child": styled(
        'path:first-child{stroke-width:4} [data-a]{stroke:red} [data-a="x"]{stroke:lime} [data-b~="y"]{stroke:blue}'
        '[data-c^="ab"]{stroke:#123} [data-c$="yz"]{stroke:#456} [data-c*="mn"]{stroke:#789}',
        '<g><path data-a="" d="M0 5h9"/><path data-a="x" d="M0 6h9"/><path data-b="x y" d="M0 7h9"/>'
        '<path data-c="abc" d="M0 8h9"/><path data-c="xyz" d="M0 9h9"/><path data-c="lmno" d="M0 10h9"/></g>',
    ),
    "selectors beyond CSS 2": styled(
        "path:not(.a){stroke:red} path:last-child{stroke-width:4} .a~path{stroke-width:3} "
        "path:nth-child(2){stroke:lime}",
        '<g><path class="a" d="M0 5h9"/><path class="a" d="M0 6h9"/><path d="M0 7h9"/><path d="M0 8h9"/></g>',
    ),
    "groups of selectors and comments": styled(
        "/* one */ .a, #i , g line{stroke:red;;stroke-width : 3px /* two */ ;} .none{} .a:hover{stroke:lime}",
        '<path class="a" d="M0 5h9"/><path id="i" d="M0 6h9"/><g><line x2="9"/></g><line y2="9"/>',
    ),
    "specificity and order": styled(
        "#i{stroke:red} .a.b{stroke:lime} .a{stroke:blue} path{stroke:#123} .c{stroke:#456} .d{stroke:#789}",
        '<path id="i" class="a b" d="M0 5h9"/><path class="a b" d="M0 6h9"/><path class="d c" d="M0 7h9"/>'
        '<path d="M0 8h9"/>',
    ),
    "rule, inline style, attribute": styled(
        ".a{stroke:red;stroke-width:3}",
        '<path class="a" stroke="lime" stroke-width="9" d="M0 5h9"/>'
        '<path class="a" style="stroke:blue" d="M0 6h9"/><path style="stroke:blue" stroke="lime" d="M0 7h9"/>',
    ),
    "important": styled(
        ".a{stroke:red!important} #i{stroke:lime} .b{stroke-width:4 ! important}",
        '<path id="i" class="a" d="M0 5h9"/><path class="a" style="stroke:blue" d="M0 6h9"/>'
        '<path class="b" style="stroke-width:2 !important" d="M0 7h9"/>',
    ),
    "CDATA and several sheets": page(
        '<style type="text/css"><![CDATA[ .a > path{stroke:red} ]]></style><g class="a"><path d="M0 5h9"/></g>'
        '<path class="b" d="M0 6h9"/><style>.b{stroke:blue}</style>'
    ),
    "rules of a group are inherited": styled(
        ".a{stroke:red;stroke-width:4} .b{stroke:inherit}",
        '<g class="a"><path d="M0 5h9"/><g stroke="blue"><path class="b" d="M0 6h9"/></g>'
        '<path stroke="lime" d="M0 7h9"/></g>',
    ),
    "rules reach what is used": styled(
        ".a{stroke:red} .u path{stroke:blue}",
        '<defs><path id="p" class="a" d="M0 5h9"/><g id="g"><path class="a" d="M0 9h9"/></g></defs>'
        '<use href="#p"/><use href="#g" x="9"/>',
    ),
    "hidden by a rule": styled(
        ".a{display:none} .b{visibility:hidden}",
        '<path class="a" d="M0 5h9"/><g class="a"><path d="M0 6h9"/></g><g class="b"><path d="M0 7h9"/></g>'
        '<path d="M0 8h9"/>',
    ),
    "a rule with an error": styled(
        ".a{stroke:red} .b{stroke:nonsense;stroke-width:3} .c{bogus} .d{stroke:blue}",
        '<path class="a" d="M0 5h9"/><path class="b" d="M0 6h9"/><path class="c d" d="M0 8h9"/>',
    ),
    "media": styled(
        "@media print{.a{stroke-width:5}} .a{stroke:red} @font-face{font-family:x;src:url(x)} .b{stroke:lime}",
        '<path class="a" d="M0 5h9"/><path class="b" d="M0 6h9"/>',
    ),
    "variables": styled(
        ".a{--ink:#a00000} .a path{stroke:var(--ink);stroke-width:var(--none,3)}",
        '<g class="a"><path d="M0 5h9"/></g>',
    ),
    "geometry in a rule": styled(
        "circle{r:9px;cx:50px;cy:40px} rect{width:30px;height:20px;x:90px}",
        '<circle r="3"/><rect width="5" height="5"/>',
    ),
    "as Illustrator writes classes": page(
        '<style type="text/css">\n\t.st0{fill:none;stroke:#000000;stroke-miterlimit:10;}\n\t'
        ".st1{fill:none;stroke:#E30613;stroke-width:4;stroke-linecap:round;stroke-linejoin:round;}\n\t.st2{fill:#1D1D1B;stroke:none;}\n</style>"
        '<path class="st0" d="M12.5,80.2c0,0,20.3-40.1,51.8-31.7"/>'
        '<line class="st1" x1="10" y1="90" x2="80" y2="95.5"/>'
        '<path class="st2" d="M100,20c5,0,9,4,9,9H91C91,24,95,20,100,20z"/>',
        'version="1.1" id="Layer_1" x="0px" y="0px" width="300px" height="200px" viewBox="0 0 300 200" '
        'style="enable-background:new 0 0 300 200;" xml:space="preserve"',
    ),
    "as Illustrator writes entities": '<?xml version="1.0" encoding="utf-8"?>\n<!DOCTYPE svg PUBLIC '
    '"-//W3C//DTD SVG 1.1//EN"'
    ' "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd" [\n<!ENTITY ns_svg '
    '"http://www.w3.org/2000/svg">\n<!ENTITY st0 '
    '"fill:none;stroke:#E30613;stroke-width:2;">\n]>\n<svg xmlns="&ns_svg;" width="300" height="200"><g><path '
    'style="&st0;" d="M10 20h50"/></g></svg>',
    "as Inkscape writes layers": page(
        '<sodipodi:namedview pagecolor="#fff"/>'
        '<g inkscape:groupmode="layer" inkscape:label="Ink" transform="translate(5 6)">'
        '<path style="fill:none;stroke:#102030;stroke-width:.5;stroke-opacity:1" d="m 10,20 c 5,-9 20,-9 30,0"/>'
        '</g><g inkscape:groupmode="layer" sodipodi:insensitive="true"><path d="M0 5h9"/></g>'
        '<g inkscape:groupmode="layer" style="display:none"><path d="M0 6h9"/></g>'
        '<g inkscape:groupmode="layer" style="display:inline"><path d="M0 7h9"/></g>',
        'width="100mm" height="80mm" viewBox="0 0 100 80" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
        'xmlns:sodipodi="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd"',
    ),
}
COLOURS = """#f00 #00ff7f red ReD rgb(10,20,30) rgb(10%,20%,30%) rgb(300,-5,0) rgba(1,2,3,.5) #12345678 #1234
hsl(120,100%,50%) hsla(240,100%,50%,.5) lightgoldenrodyellow""".split()
PAINTS = {
    "colours": page("".join(f'<path d="M0 5h9" stroke="{colour}"/>' for colour in COLOURS)),
    "currentColor": page(
        '<g color="#a00000"><path stroke="currentColor" d="M0 5h9"/>'
        '<path color="blue" stroke="currentcolor" d="M0 6h9"/></g><path stroke="currentColor" d="M0 7h9"/>'
        '<g color="red" stroke="currentColor"><path color="lime" d="M0 8h9"/></g>'
    ),
    "inherit": page(
        '<g stroke="red" stroke-width="3" fill="lime"><path stroke="inherit" d="M0 5h9v9"/>'
        '<g stroke="blue" fill="none"><path style="stroke:inherit;stroke-width:inherit" d="M0 6h9v9"/></g></g>'
    ),
    "fills": page(
        '<path fill="red" d="M0 5h9v9z"/><path fill="red" stroke="none" d="M0 6h9v9z"/>'
        '<rect fill="#0f0" stroke="none" width="9" height="9"/><g stroke="none">'
        '<polygon fill="blue" points="0 0 9 0 9 9"/><path d="M0 5h5"/></g>'
        '<path stroke="none" fill="red" fill-rule="evenodd" d="M0 0h90v90h-90zM10 10h70v70h-70z"/>'
        '<g fill-rule="evenodd"><path fill="lime" d="M0 0h90v90h-90zM10 10h70v70h-70z"/></g>'
    ),
    "fill when nothing is said": '<svg xmlns="http://www.w3.org/2000/svg" width="90" height="90">'
    '<path d="M0 5h9v9z"/><path fill="" d="M0 6h9v9z"/><path stroke="red" d="M0 7h9v9z"/></svg>',
    "gradients": page(
        '<linearGradient id="g"><stop stop-color="red"/><stop offset="1" stop-color="blue"/></linearGradient>'
        '<path fill="url(#g)" stroke="none" d="M0 5h9v9z"/><path stroke="url(#g)" d="M0 6h9v9z"/>'
    ),
    "paint with a fallback": page(
        '<path stroke="url(#none) red" d="M0 6h9v9z"/><path stroke="url(#none) none" d="M0 9h9v3"/>'
        '<path stroke="url(#none)" d="M0 9h9v5"/><path stroke="none" fill="url(#none)  #00f" d="M0 9h9v6"/>'
    ),
    "stroke widths": page(
        '<path stroke-width="0" d="M0 5h9"/><path stroke-width="10%" d="M0 7h9"/>'
        '<path stroke-width="0" fill="red" d="M0 8h9v9"/><path stroke="none" stroke-width="9" d="M0 9h9"/>'
        '<path d="M0 10h9"/><path style="stroke-width:3px" d="M0 11h9"/><g stroke-width="2">'
        '<path transform="scale(3 2)" d="M0 12h9"/></g>'
    ),
    "invalid values count for nothing": styled(
        "path{stroke-width:3}",
        '<path style="stroke-width:-1" d="M0 6h9"/><path style="stroke:#12" d="M0 7h9"/><g stroke="red">'
        '<path stroke="nonsense" d="M0 9h9"/></g>',
    ),
    "broken style values": page(
        '<path style="stroke:red;;:;stroke-width" d="M0 5h9"/>'
        '<path style="STROKE:lime; Stroke-Width : 2" d="M0 6h9"/><path style="/* c */ stroke: blue" d="M0 7h9"/>'
        '<path style="stroke-width:nonsense" d="M0 8h9"/>'
    ),
    "non-scaling stroke": page(
        '<path vector-effect="non-scaling-stroke" transform="scale(3)" stroke-width="2" d="M0 5h9v9"/>'
    ),
}
DRAWINGS = CHOICES | STYLES | PAINTS
ROUND = {"geometry in a rule"}
REPORTED_OTHERWISE = {
    "attributes and first-child": page(
        '<path stroke-width="4" stroke="red" d="M0 5h9"/><path stroke="lime" d="M0 6h9"/>'
        '<path stroke="blue" d="M0 7h9"/><path stroke="#123" d="M0 8h9"/><path stroke="#456" d="M0 9h9"/>'
        '<path stroke="#789" d="M0 10h9"/>'
    ),
    "selectors beyond CSS 2": page(
        '<path d="M0 5h9"/><path stroke="lime" stroke-width="3" d="M0 6h9"/>'
        '<path stroke="red" stroke-width="3" d="M0 7h9"/><path stroke="red" stroke-width="3" d="M0 8h9"/>'
    ),
    "media": page('<path stroke="red" d="M0 5h9"/><path stroke="lime" d="M0 6h9"/>'),
    "a rule with an error": page(
        '<path stroke="red" d="M0 5h9"/><path stroke-width="3" d="M0 6h9"/><path stroke="blue" d="M0 8h9"/>'
    ),
    "invalid values count for nothing": page(
        '<g stroke-width="3"><path d="M0 6h9"/><path d="M0 7h9"/><path stroke="red" d="M0 9h9"/></g>'
    ),
    "currentColor": page(
        '<path stroke="#a00000" d="M0 5h9"/><path stroke="blue" d="M0 6h9"/><path d="M0 7h9"/>'
        '<path stroke="lime" d="M0 8h9"/>'
    ),
    "broken style values": page(
        '<path stroke="red" d="M0 5h9"/><path stroke="lime" stroke-width="2" d="M0 6h9"/>'
        '<path stroke="blue" d="M0 7h9"/><path d="M0 8h9"/>'
    ),
    "important": page(
        '<path stroke="red" d="M0 5h9"/><path stroke="red" d="M0 6h9"/><path stroke-width="2" d="M0 7h9"/>'
    ),
    "variables": page('<path stroke="#a00000" stroke-width="3" d="M0 5h9"/>'),
    "geometry in a rule": page('<circle r="9" cx="50" cy="40"/><rect width="30" height="20" x="90"/>'),
    "non-scaling stroke": page('<path stroke-width="2" d="M0 15h27v27"/>'),
}
