"""Small DXF drawings of one feature each.

The tables hold names and functions. A function draws into (document, model space).
"""

from brushsvg.read.dxf.ezdxf_import import ezdxf

ALIGN = ezdxf.enums.TextEntityAlignment
WORDS = "Axp A"
PATH = [(10, 10), (60, 10), (60, 40), (30, 55)]
BOX = [(10, 10), (70, 10), (70, 50), (10, 50)]
INNER = [(20, 20), (40, 20), (40, 40), (20, 40)]
FRONT, BELOW, SLANTED = (0, 0, 1), (0, 0, -1), (0.3, -0.4, 0.8)


# Parts of the feature tables ------------------------------------------------------------------------


def line(msp, a=(10, 10), b=(70, 30), **attributes):
    return msp.add_line(a, b, attributes)


def text(msp, words=WORDS, align=ALIGN.LEFT, at=(50, 50), to=None, **attributes):
    entity = msp.add_text(words, height=attributes.pop("height", 8), dxfattribs={"style": "T"} | attributes)
    return entity.set_placement(at, to, align=align)


def mtext(msp, words=WORDS, **attributes):
    """Add MTEXT wider than its lines, since the add-on guesses a missing width."""
    return msp.add_mtext(words, {"style": "T", "insert": (100, 100), "char_height": 8, "width": 300} | attributes)


def raw(entity, **attributes):
    """Set numbers that ezdxf itself would refuse."""
    for key, value in attributes.items():
        entity.dxf.__dict__[key] = value


def block(document, name="B", **attributes):
    made = document.blocks.new(name)
    made.add_line((0, 0), (20, 0), attributes)
    made.add_line((0, 0), (0, 10), attributes)
    made.add_circle((10, 10), 4, attributes)
    return made


def insert(msp, at=(50, 50), name="B", **attributes):
    return msp.add_blockref(name, at, attributes)


def hatch(msp, *rings, style=0, **attributes):
    made = msp.add_hatch(color=attributes.pop("color", 1), dxfattribs={"hatch_style": style} | attributes)
    for k, ring in enumerate(rings):
        made.paths.add_polyline_path(ring, is_closed=True, flags=1 if k == 0 else 16)
    return made


def spline(msp, points, **attributes):
    made = msp.add_spline()
    for key, value in attributes.items():
        setattr(made, key, value) if key in ("knots", "weights", "closed") else made.dxf.set(key, value)
    made.control_points = points
    return made


# Tables ---------------------------------------------------------------------------------------------


LINES = {
    "line": lambda d, m: line(m),
    "circle": lambda d, m: m.add_circle((50, 50), 20),
    "arc": lambda d, m: m.add_arc((50, 50), 20, 30, 200),
    "arc clockwise over 0": lambda d, m: m.add_arc((50, 50), 20, 300, 60),
    "arc all round": lambda d, m: m.add_arc((50, 50), 20, 0, 360),
    "arc all round from elsewhere": lambda d, m: m.add_arc((50, 50), 20, 45, 405),
    "arc with equal angles": lambda d, m: m.add_arc((50, 50), 20, 45, 45),
    "ellipse": lambda d, m: m.add_ellipse((50, 50), (30, 10), 0.4),
    "ellipse in part": lambda d, m: m.add_ellipse((50, 50), (30, 10), 0.4, 1, 4),
    "ellipse over 0": lambda d, m: m.add_ellipse((50, 50), (30, 10), 0.4, 5, 2),
    "ellipse of ratio above 1": lambda d, m: m.add_ellipse((50, 50), (10, 3), 1.0).dxf.set("ratio", 2.0),
    "ellipse of negative ratio": lambda d, m: m.add_ellipse((50, 50), (30, 10), 0.4, 1, 4).dxf.set("ratio", -0.4),
    "lwpolyline": lambda d, m: m.add_lwpolyline(PATH),
    "lwpolyline closed": lambda d, m: m.add_lwpolyline(PATH, close=True),
    "lwpolyline bulges": lambda d, m: m.add_lwpolyline(
        [(*p, b) for p, b in zip(PATH, (0.5, -1, 0, 2), strict=True)], format="xyb", close=True
    ),
    "lwpolyline width": lambda d, m: m.add_lwpolyline(PATH, dxfattribs={"const_width": 2}),
    "lwpolyline constant width 0 and widths": lambda d, m: m.add_lwpolyline(
        [(*p, 2, 2) for p in PATH], format="xyse", dxfattribs={"const_width": 0}
    ),
    "lwpolyline constant width and widths": lambda d, m: m.add_lwpolyline(
        [(*p, 2, 2) for p in PATH], format="xyse", dxfattribs={"const_width": 3}
    ),
    "lwpolyline widths": lambda d, m: m.add_lwpolyline([(*p, 1, 3) for p in PATH], format="xyse"),
    "lwpolyline widths and bulges": lambda d, m: m.add_lwpolyline([(*p, 1, 2, 0.6) for p in PATH], format="xyseb"),
    "lwpolyline of width closed": lambda d, m: m.add_lwpolyline(PATH, close=True, dxfattribs={"const_width": 2}),
    "polyline": lambda d, m: m.add_polyline2d(PATH),
    "polyline width": lambda d, m: m.add_polyline2d(
        PATH, dxfattribs={"default_start_width": 2, "default_end_width": 2}
    ),
    "polyline vertex widths": lambda d, m: m.add_polyline2d([(*p, 1, 3) for p in PATH], format="xyse"),
    "polyline 3d": lambda d, m: m.add_polyline3d([(*p, 0) for p in PATH]),
    "polyline 3d closed": lambda d, m: m.add_polyline3d([(*p, 0) for p in PATH], close=True),
    "polyline spline fit": lambda d, m: spline_fit(m),
    "polyline 3d spline fit": lambda d, m: spline_fit(m, three=True),
    "polyline curve fit": lambda d, m: curve_fit(m),
    "polyline mesh": lambda d, m: polymesh(m),
    "polyface": lambda d, m: polyface(m),
    "spline": lambda d, m: m.add_open_spline([(10, 10), (20, 50), (50, 0), (70, 40), (90, 10)]),
    "spline rational": lambda d, m: m.add_rational_spline([(10, 10), (20, 50), (50, 0), (70, 40)], [1, 3, 2, 1]),
    "spline closed": lambda d, m: m.add_spline().set_closed(
        [(10, 10, 0), (20, 50, 0), (50, 0, 0), (70, 40, 0), (90, 10, 0)]
    ),
    "spline closed rational": lambda d, m: m.add_spline().set_closed_rational(
        [(10, 10, 0), (20, 50, 0), (50, 0, 0), (70, 40, 0)], [1, 3, 2, 1]
    ),
    "spline of fit points": lambda d, m: m.add_spline([(10, 10), (20, 50), (50, 0), (70, 40)]),
    "spline of fit points closed": lambda d, m: fit_closed(m),
    "spline of fit points with tangents": lambda d, m: fit_tangents(m),
    "spline of both": lambda d, m: both_points(m),
    "spline of degree 2": lambda d, m: m.add_open_spline([(10, 10), (20, 50), (50, 0), (70, 40)], degree=2),
    "helix": lambda d, m: m.add_helix(10, 5, 3).translate(40, 40, 0),
    "ray": lambda d, m: (m.add_ray((50, 50), (1, 0.5)), line(m)),
    "xline": lambda d, m: (m.add_xline((50, 50), (1, 0.5)), line(m)),
    "line with a thickness": lambda d, m: line(m, thickness=5),
    "lwpolyline with a thickness seen from the side": lambda d, m: m.add_lwpolyline(
        PATH, dxfattribs={"thickness": 5, "extrusion": (0, -1, 0)}
    ),
    "line thickness from the side": lambda d, m: line(m, thickness=5, extrusion=(0, 1, 0)),
    "circle with a thickness from the side": lambda d, m: m.add_circle(
        (50, 0, 50), 20, {"thickness": 5, "extrusion": (0, -1, 0)}
    ),
}


def spline_fit(m, three=False):
    add = m.add_polyline3d if three else m.add_polyline2d
    made = add([(p[0], p[1], 0) if three else p for p in PATH])
    made.dxf.flags |= 4
    for vertex in made.vertices:
        vertex.dxf.flags |= 16
    for x, y in [(10, 10), (40, 12), (55, 25), (50, 45), (30, 55)]:
        made.append_vertex((x, y, 0), {"flags": 8 | (32 if three else 0)})


def curve_fit(m):
    made = m.add_polyline2d([(p[0], p[1], 0.3) for p in PATH], format="xyb")
    made.dxf.flags |= 2
    made.vertices[1].dxf.flags |= 1


def polymesh(m):
    made = m.add_polymesh((3, 3))
    for i in range(3):
        for k in range(3):
            made.set_mesh_vertex((i, k), (10 + 20 * i, 10 + 15 * k, 0))


def polyface(m):
    made = m.add_polyface()
    made.append_face([(10, 10), (50, 10), (50, 40), (10, 40)])


def fit_closed(m):
    m.add_spline([(10, 10), (20, 50), (50, 0), (70, 40)]).closed = True


def fit_tangents(m):
    made = m.add_spline([(10, 10), (20, 50), (50, 0), (70, 40)])
    made.dxf.start_tangent, made.dxf.end_tangent = (1, 0, 0), (0, 1, 0)


def both_points(m):
    made = m.add_open_spline([(10, 10), (20, 50), (50, 0), (70, 40)])
    made.fit_points = [(10, 10), (40, 24), (70, 40)]


def ocs(draw):
    """Return the drawing functions in other planes: from below and slanted."""
    return {
        f"{name} {where}": (lambda d, m, draw=draw, z=z, name=name: draw[name](d, m, z))
        for name in draw
        for where, z in (("from below", BELOW), ("slanted", SLANTED))
    }


def in_block(d, m, z):
    block(d)
    insert(m, (-50, 30), extrusion=z, xscale=2, rotation=30)


def attributed(d, m, z):
    block(d).add_attdef("T", (5, 5), height=5, dxfattribs={"style": "T"})
    made = insert(m, (-50, 30), extrusion=z, xscale=2, rotation=30)
    made.add_auto_attribs({"T": WORDS})


def arrayed(d, m, z):
    block(d)
    insert(
        m,
        (-150, 30),
        extrusion=z,
        rotation=30,
        row_count=2,
        column_count=3,
        row_spacing=30,
        column_spacing=40,
    )


PLANES = ocs(
    {
        "line": lambda d, m, z: line(m, extrusion=z),
        "point": lambda d, m, z: m.add_point((50, 50), {"extrusion": z}),
        "arc": lambda d, m, z: m.add_arc((50, 50), 20, 30, 200, dxfattribs={"extrusion": z}),
        "circle": lambda d, m, z: m.add_circle((50, 50), 20, {"extrusion": z}),
        "ellipse": lambda d, m, z: m.add_ellipse(
            (50, 50), (10, 20) if z == BELOW else (20, 15, 0), 0.5, 0.5, 4, {"extrusion": z}
        ),
        "lwpolyline": lambda d, m, z: m.add_lwpolyline(
            [(*p, 0.4) for p in PATH], format="xyb", dxfattribs={"extrusion": z, "elevation": 7}
        ),
        "lwpolyline width": lambda d, m, z: m.add_lwpolyline(
            [(*p, 0.4) for p in PATH], format="xyb", dxfattribs={"extrusion": z, "const_width": 2}
        ),
        "polyline": lambda d, m, z: m.add_polyline2d(
            [(*p, 0.4) for p in PATH], format="xyb", dxfattribs={"extrusion": z, "elevation": (0, 0, 7)}
        ),
        "solid": lambda d, m, z: m.add_solid([(10, 10), (50, 10), (10, 40), (50, 50)], {"extrusion": z}),
        "trace": lambda d, m, z: m.add_trace([(10, 10), (50, 10), (10, 40), (50, 50)], {"extrusion": z}),
        "hatch": lambda d, m, z: hatch(m, BOX, INNER, extrusion=z, elevation=(0, 0, 7)),
        "hatch of edges": lambda d, m, z: edges(m, extrusion=z),
        "text": lambda d, m, z: text(m, extrusion=z, rotation=20),
        "text right": lambda d, m, z: text(m, align=ALIGN.TOP_RIGHT, extrusion=z, rotation=20),
        "mtext": lambda d, m, z: mtext(m, extrusion=z, text_direction=(1, 0.3, 0) if z == BELOW else (1, 0, -0.375)),
        "mtext rotation": lambda d, m, z: mtext(m, extrusion=z, rotation=30),
        "mtext formatted": lambda d, m, z: mtext(m, r"Ax\C1;p A", extrusion=z, rotation=30),
        "insert": in_block,
        "attribute": attributed,
        "array": arrayed,
        "shape": lambda d, m, z: m.add_shape("A", (50, 50), 5, {"extrusion": z}),
        "mline": lambda d, m, z: m.add_mline(PATH, dxfattribs={"extrusion": z}),
    }
)


def edges(m, **attributes):
    path = hatch(m, **attributes).paths.add_edge_path()
    path.add_line((10, 10), (50, 10))
    path.add_arc((50, 30), 20, -90, 90, ccw=True)
    path.add_ellipse((30, 50), (20, 0), 0.5, 0, 180, ccw=True)
    path.add_line((10, 50), (10, 10))


TEXTS = {
    **{
        f"text {align.name}": lambda d, m, a=align: text(
            m, align=a, to=(120, 70) if a.name in ("FIT", "ALIGNED") else None
        )
        for align in ALIGN
    },
    **{
        f"text {align.name} backward and turned": lambda d, m, a=align: text(
            m,
            align=a,
            to=(120, 70) if a.name in ("FIT", "ALIGNED") else None,
            text_generation_flag=2,
            rotation=25,
        )
        for align in ALIGN
    },
    **{
        f"text {align.name} wide": lambda d, m, a=align: text(
            m, align=a, to=(120, 70) if a.name in ("FIT", "ALIGNED") else None, width=1.7
        )
        for align in ALIGN
    },
    "text upside down": lambda d, m: text(m, text_generation_flag=4),
    "text upside down top": lambda d, m: text(m, text_generation_flag=4, align=ALIGN.TOP_LEFT),
    "text both ways": lambda d, m: text(m, text_generation_flag=6, rotation=40),
    "text rotated": lambda d, m: text(m, rotation=70),
    "text oblique": lambda d, m: text(m, oblique=20),
    "text oblique to the left": lambda d, m: text(m, oblique=-20),
    "text oblique 340": lambda d, m: text(m, oblique=340),
    "text oblique right": lambda d, m: text(m, oblique=20, align=ALIGN.TOP_RIGHT),
    "text oblique wide turned": lambda d, m: text(m, oblique=20, width=2, rotation=30),
    "text of height 0": lambda d, m: raw(text(m), height=0),
    "text of negative height": lambda d, m: raw(text(m), height=-8),
    "text of negative width": lambda d, m: raw(text(m), width=-1.5),
    "text of width 0": lambda d, m: raw(text(m), width=0),
    "text %%u": lambda d, m: text(m, "A%%uxp%%u A"),
    "text %%o": lambda d, m: text(m, "A%%oxp%%o A"),
    "text %%k": lambda d, m: text(m, "A%%kxp%%k A"),
    "text %%c": lambda d, m: text(m, "A%%cA"),
    "text %%065": lambda d, m: text(m, "A%%065x"),
    "text with ends of blanks": lambda d, m: text(m, "  Ax  ", align=ALIGN.RIGHT),
    "text with blanks centred": lambda d, m: text(m, "    Ax", align=ALIGN.CENTER),
    "text unicode": lambda d, m: text(m, r"\U+0041x"),
    "text thickness": lambda d, m: text(m, thickness=3),
    "style backward": lambda d, m: styled(d, m, text, generation_flags=2),
    "style upside down": lambda d, m: styled(d, m, text, generation_flags=4),
    "style oblique": lambda d, m: styled(d, m, text, oblique=25),
    "style of width": lambda d, m: styled(d, m, text, width=2),
    "style of height": lambda d, m: styled(d, m, text, height=20),
    "style vertical": lambda d, m: styled(d, m, text, flags=4),
    "text of no style": lambda d, m: text(m, style="nowhere"),
    "text in a stretched block": lambda d, m: stretched(d, m, 2, 0.7),
    "text in a mirrored block": lambda d, m: stretched(d, m, -1, 1),
    "text in a sheared block": lambda d, m: stretched(d, m, 2, 1, turned=40),
    "mtext in a stretched block": lambda d, m: stretched(d, m, 2, 0.7, words=mtext),
    "mtext in a mirrored block": lambda d, m: stretched(d, m, -1, 1, words=mtext),
    "mtext in a block mirrored up": lambda d, m: stretched(d, m, 1, -1, words=mtext),
    "mtext in a sheared block": lambda d, m: stretched(d, m, 2, 1, turned=40, words=mtext),
    "attribute": lambda d, m: attribute(d, m),
    "attribute invisible": lambda d, m: attribute(d, m, flags=1),
    "attribute constant": lambda d, m: constant(d, m),
    "attribute definition": lambda d, m: (
        m.add_attdef("AxA", (10, 10), "x", height=8, dxfattribs={"style": "T"}),
        line(m),
    ),
    "attribute definition alone": lambda d, m: m.add_attdef("AxA", (10, 10), "x", height=8, dxfattribs={"style": "T"}),
    "attribute definition invisible": lambda d, m: (
        m.add_attdef("AxA", (10, 10), "x", height=8, dxfattribs={"style": "T", "flags": 1}),
        line(m),
    ),
    "attribute of lines": lambda d, m: many_lines(d, m),
    "attributes shown by nobody": lambda d, m: attribute(d, m, shown=0),
    "attributes shown all": lambda d, m: attribute(d, m, shown=2, flags=1),
    "attribute on a hidden layer": lambda d, m: attribute(d, m, layer=hidden(d)),
}


def styled(d, m, add, generation_flags=None, **attributes):
    style = d.styles.get("T")
    if generation_flags is not None:
        style.dxf.generation_flags = generation_flags
    for key, value in attributes.items():
        style.dxf.set(key, value)
    add(m)


def stretched(d, m, sx, sy, turned=0, words=text):
    entity = words(d.blocks.new("B"))
    if turned:
        entity.dxf.rotation = turned
    insert(m, (50, 60), xscale=sx, yscale=sy, rotation=15)


def attribute(d, m, shown=None, **attributes):
    block(d)
    made = insert(m, (50, 30), xscale=2, rotation=30)
    made.add_attrib("T", WORDS, (20, 30), {"height": 6, "style": "T"} | attributes)
    if shown is not None:
        d.header["$ATTMODE"] = shown


def constant(d, m):
    block(d).add_attdef("T", (5, 5), WORDS, height=6, dxfattribs={"style": "T", "flags": 2})
    insert(m, (50, 30), xscale=2, rotation=30)


def many_lines(d, m):
    block(d)
    made = insert(m, (50, 30)).add_attrib("T", "", (20, 30), {"height": 6, "style": "T"})
    made.set_mtext(mtext(m, r"Ax\PpA"))


def hidden(d):
    d.layers.add("hidden").freeze()
    return "hidden"


LINE_SPACINGS = {
    f"mtext spacing {style} {factor}": lambda d, m, s=style, f=factor: mtext(
        m, r"AAA\Pxp\PAA", line_spacing_style=s, line_spacing_factor=f
    )
    for style in (1, 2)
    for factor in (0.25, 1, 2.5)
}
TALL = {
    f"mtext with a tall word, spacing {style} {factor}": lambda d, m, s=style, f=factor: mtext(
        m, r"AAA\P{\H2x;A} x\PAA", line_spacing_style=s, line_spacing_factor=f
    )
    for style in (1, 2)
    for factor in (1, 2)
}
MTEXTS = {
    **{
        f"mtext attached {k}": lambda d, m, k=k: mtext(m, r"AAA xp A\PAp", width=40, attachment_point=k)
        for k in range(1, 10)
    },
    **{
        f"mtext attached {k} without width": lambda d, m, k=k: mtext(
            m, r"AAA xp A\PAp", attachment_point=k, rotation=33, width=0
        )
        for k in range(1, 10)
    },
    **LINE_SPACINGS,
    **TALL,
    "mtext": lambda d, m: mtext(m),
    "mtext rotated": lambda d, m: mtext(m, rotation=50),
    "mtext direction and rotation": lambda d, m: mtext(m, rotation=50, text_direction=(1, 1, 0)),
    "mtext of height 0": lambda d, m: raw(mtext(m), char_height=0),
    "mtext of height 0 inside": lambda d, m: mtext(m, r"A {\H0;AxA}"),
    "mtext of negative height": lambda d, m: raw(mtext(m), char_height=-8),
    "mtext of height 0 and heights inside": lambda d, m: raw(mtext(m, r"{\H8;AxA}"), char_height=0),
    "mtext of spacing 0": lambda d, m: raw(mtext(m, r"AAA\Pxp"), line_spacing_factor=0),
    "mtext columns": lambda d, m: columns(m),
    "mtext dynamic columns": lambda d, m: dynamic(m),
    "mtext dynamic auto columns": lambda d, m: dynamic(m, auto=True),
    "mtext width factor": lambda d, m: mtext(m, r"{\W2;Axp} A"),
    "mtext oblique": lambda d, m: mtext(m, r"{\Q20;Axp} A"),
    "mtext tracking": lambda d, m: mtext(m, r"{\T2;Axp} A"),
    "mtext stack": lambda d, m: mtext(m, r"A\SA/x;A"),
    "mtext stack coloured": lambda d, m: mtext(m, r"A{\C1;\SA/x;}A"),
    "mtext stack true coloured": lambda d, m: mtext(m, r"A\SA/x;A", true_color=0x305070),
    "mtext stack tolerance": lambda d, m: mtext(m, r"A\SA^ x;A"),
    "mtext stack slanted": lambda d, m: mtext(m, r"A\SA#x;A"),
    "mtext underline": lambda d, m: mtext(m, r"A \Lxp A\l A"),
    "mtext overline": lambda d, m: mtext(m, r"A \Oxp A\o A"),
    "mtext struck": lambda d, m: mtext(m, r"A \Kxp A\k A"),
    "mtext colour": lambda d, m: mtext(m, r"A {\C1;xp} A"),
    "mtext true colour": lambda d, m: mtext(m, r"A {\c255;xp} A"),
    "mtext colour of the layer": lambda d, m: (
        d.layers.add("L", color=3),
        mtext(m, r"A {\C1;xp} A", layer="L"),
    ),
    "mtext coloured": lambda d, m: mtext(m, color=5),
    "mtext true coloured": lambda d, m: mtext(m, true_color=0x102030),
    "mtext colour back to the layer": lambda d, m: mtext(m, r"A {\C256;xp} A", color=5),
    "mtext colour by block": lambda d, m: mtext(m, r"A {\C0;xp} A", color=5),
    "mtext true coloured and colour": lambda d, m: mtext(m, r"A {\C1;xp} A", true_color=0x102030),
    "mtext font": lambda d, m: mtext(m, r"A {\fOther|b0|i0;xp} A"),
    "mtext background": lambda d, m: mtext(m, r"A x", bg_fill=1, bg_fill_color=2, box_fill_scale=1.5),
    "mtext background over a line": lambda d, m: (
        line(m, (90, 97), (150, 97)),
        mtext(m, r"A x", bg_fill=1, bg_fill_color=2, box_fill_scale=1.5),
    ),
    "mtext masks a line": lambda d, m: (
        line(m, (90, 97), (150, 97)),
        mtext(m, r"A x", bg_fill=3, bg_fill_color=2, box_fill_scale=1.5),
    ),
    "mtext frame true colour": lambda d, m: mtext(m, r"A x", bg_fill=16, width=30, true_color=0x305070),
    "mtext frame": lambda d, m: mtext(m, r"A x", bg_fill=16, box_fill_scale=1.5, width=30),
    "mtext tabs": lambda d, m: mtext(m, "A^Ix^IA"),
    "mtext paragraphs": lambda d, m: mtext(m, r"\pi2,l3,r1;AAA xx A A A xp A\P\pqc;A x\P\pqr;p", width=70),
    "mtext justified": lambda d, m: mtext(m, r"\pqj;AAA xx A A A xp A xx A\Px", width=60),
    "mtext distributed": lambda d, m: mtext(m, r"\pqd;AAA xx A\Px", width=60),
    "mtext tab stops": lambda d, m: mtext(m, r"\pt3,c8,r14;A^Ix^IA^Ip", width=200),
    "mtext heights": lambda d, m: mtext(m, r"A{\H2x;A}A x"),
    "mtext aligned middle": lambda d, m: mtext(m, r"\A1;A{\H2x;A} x"),
    "mtext aligned top": lambda d, m: mtext(m, r"\A2;A{\H2x;A} x"),
    "mtext word too long": lambda d, m: mtext(m, "AAAAAAAAAAA A", width=20),
    "mtext vertical": lambda d, m: mtext(m, "Axp", flow_direction=3),
    "mtext of a backward style": lambda d, m: styled(d, m, mtext, generation_flags=2),
    "mtext of an upside down style": lambda d, m: styled(d, m, mtext, generation_flags=4),
    "mtext of an oblique style": lambda d, m: styled(d, m, mtext, oblique=25),
    "mtext of a wide style": lambda d, m: styled(d, m, mtext, width=2),
    "mtext of a wide style wrapped": lambda d, m: styled(d, m, lambda m: mtext(m, "AA xx AA pp", width=60), width=2),
    "mtext of a high style": lambda d, m: styled(d, m, mtext, height=20),
    "mtext of a vertical style": lambda d, m: styled(d, m, mtext, flags=4),
    "mtext of no style": lambda d, m: mtext(m, style="nowhere"),
    "mtext defined height": lambda d, m: mtext(m, r"A\PA\PA", defined_height=10, width=20),
    "mtext empty lines": lambda d, m: mtext(m, r"A\P\PA"),
    "mtext that begins with an empty line": lambda d, m: mtext(m, r"\PA"),
    "mtext that ends with an empty line": lambda d, m: mtext(m, r"A\P\P", attachment_point=7),
    "mtext with blanks at its start": lambda d, m: mtext(m, r"   A x"),
    "mtext with blanks at its end": lambda d, m: mtext(m, r"A x    ", attachment_point=3),
    "mtext with many blanks": lambda d, m: mtext(m, r"A      x"),
}


def columns(m):
    m.add_mtext_static_columns(
        [r"AAA\Pxx", r"pp\PAA"],
        width=40,
        gutter_width=10,
        height=40,
        dxfattribs={"style": "T", "insert": (50, 100), "char_height": 8},
    )


def dynamic(m, auto=False):
    attributes = {"style": "T", "insert": (50, 100), "char_height": 8}
    if auto:
        words = r"AAA\Pxx\Ppp\PAA"
        m.add_mtext_dynamic_auto_height_columns(
            words, width=40, gutter_width=10, height=28, count=2, dxfattribs=attributes
        )
    else:
        m.add_mtext_dynamic_manual_height_columns(
            r"AAA\Pxx\Ppp\PAA", width=40, gutter_width=10, heights=[28, 28], dxfattribs=attributes
        )


def on_layer(d, m, change, **attributes):
    change(d.layers.add("L"))
    line(m, (10, 60), (60, 60), layer="L", **attributes)
    line(m)


def through_blocks(d, m, inner, outer, layer_of_inner="0", layer_of_outer="L1"):
    """Draw a line in a block in a block."""
    for name, colour, weight in (("L1", 1, 50), ("L2", 3, 100), ("L3", 5, 140)):
        d.layers.add(name, color=colour, lineweight=weight)
    d.blocks.new("I").add_line((0, 0), (20, 0), {"layer": layer_of_inner} | inner)
    d.blocks.new("O").add_blockref("I", (0, 10), {"layer": layer_of_outer} | outer)
    insert(m, name="O", layer="L3", color=4, lineweight=200)


INHERITED = {
    f"{name}, {kind}": lambda d, m, i=i, o=o, li=li, lo=lo: through_blocks(d, m, i, o, li, lo)
    for name, i, o in (
        ("by layer", {}, {}),
        ("by block by layer", {"color": 0, "lineweight": -2}, {}),
        ("by block by block", {"color": 0, "lineweight": -2}, {"color": 0, "lineweight": -2}),
        ("by layer by block", {}, {"color": 0, "lineweight": -2}),
        ("by block with colour", {"color": 0, "lineweight": -2}, {"color": 6, "lineweight": 70}),
        ("true colour", {"color": 0, "lineweight": -2}, {"true_color": 0x405060}),
    )
    for kind, li, lo in (("all on 0", "0", "0"), ("inner on 0", "0", "L2"), ("own layers", "L1", "L2"))
}

LAYERS = {
    "layer off": lambda d, m: on_layer(d, m, lambda layer: layer.off()),
    "layer frozen": lambda d, m: on_layer(d, m, lambda layer: layer.freeze()),
    "layer locked": lambda d, m: on_layer(d, m, lambda layer: layer.lock()),
    "layer not for plotting": lambda d, m: on_layer(d, m, lambda layer: layer.dxf.set("plot", 0)),
    "layer colour": lambda d, m: on_layer(d, m, lambda layer: layer.set_color(1)),
    "layer true colour": lambda d, m: on_layer(d, m, lambda layer: layer.dxf.set("true_color", 0x102030)),
    "layer weight": lambda d, m: on_layer(d, m, lambda layer: layer.dxf.set("lineweight", 100)),
    "layer missing": lambda d, m: line(m, layer="nowhere"),
    "invisible": lambda d, m: (line(m, invisible=1), line(m, (10, 60), (60, 60))),
    "layer name in other letters": lambda d, m: (
        on_layer(d, m, lambda layer: layer.set_color(1), color=256) or line(m, (10, 70), (60, 70), layer="l")
    ),
    "defpoints": lambda d, m: (line(m, layer="Defpoints"), line(m, (10, 60), (60, 60))),
    "insert on a layer that is off": lambda d, m: (
        block(d, layer="K"),
        d.layers.add("off").off(),
        insert(m, layer="off"),
    ),
    "insert on a frozen layer": lambda d, m: (
        block(d, layer="K"),
        d.layers.add("ice").freeze(),
        insert(m, layer="ice"),
        line(m),
    ),
    "insert invisible": lambda d, m: (block(d), insert(m, invisible=1), line(m)),
    "true colour": lambda d, m: line(m, true_color=0x305070),
    "true colour and colour": lambda d, m: line(m, true_color=0x305070, color=1),
    "colour book": lambda d, m: line(m, color=30, color_name="BOOK$NAME"),
    "colour 7": lambda d, m: line(m, color=7),
    "colour 255": lambda d, m: line(m, color=255),
    "colour negative": lambda d, m: line(m, color=-3),
    "colour by object": lambda d, m: line(m, color=257),
    "weight": lambda d, m: line(m, lineweight=80),
    "weight default": lambda d, m: line(m, lineweight=-3),
    "transparent": lambda d, m: setattr(line(m), "transparency", 0.5),
    "transparent all": lambda d, m: (setattr(line(m), "transparency", 1.0), line(m, (10, 60), (60, 60))),
    "layer transparent": lambda d, m: on_layer(d, m, lambda layer: setattr(layer, "transparency", 0.6)),
    "paper space": lambda d, m: (d.paperspace().add_line((0, 0), (50, 50)), line(m)),
    "flagged for paper space": lambda d, m: (line(m), line(m, (10, 60), (60, 60), paperspace=1)),
    "draw order": lambda d, m: (line(m), line(m, (10, 60), (60, 60))),
    **INHERITED,
}


def line_types(d):
    for name, pattern in {
        "DASHED": [15, 10, -5],
        "DASHDOT": [20, 10, -4.8, 0.4, -4.8],
        "GAP": [15, -5, 10],
    }.items():
        d.linetypes.add(name, pattern)
    d.linetypes.add("LETTERS", 'A,10,-5,["A",T,S=3,U=0.0,X=-2,Y=-1],-5', length=20)


def dashed(d, m, ltscale=1, celtscale=1, add=None, **attributes):
    line_types(d)
    d.header["$LTSCALE"], d.header["$CELTSCALE"] = ltscale, celtscale
    attributes = {"linetype": "DASHED"} | attributes
    add(m, attributes) if add else line(m, (10, 10), (90, 10), **attributes)


DASHES = {
    "dashed": lambda d, m: dashed(d, m),
    "dash and dot": lambda d, m: dashed(d, m, linetype="DASHDOT"),
    "begins with a gap": lambda d, m: dashed(d, m, linetype="GAP"),
    "with letters": lambda d, m: dashed(d, m, linetype="LETTERS"),
    "line type missing": lambda d, m: dashed(d, m, linetype="NOWHERE"),
    "continuous": lambda d, m: dashed(d, m, linetype="CONTINUOUS"),
    "ltscale": lambda d, m: dashed(d, m, ltscale=0.5),
    "own scale": lambda d, m: dashed(d, m, linetype="DASHED", ltscale=2, celtscale=3),
    "entity scale": lambda d, m: (dashed(d, m), line(m, (10, 30), (90, 30), linetype="DASHED", ltscale=0.4)),
    "dashed circle": lambda d, m: dashed(d, m, add=lambda m, a: m.add_circle((50, 50), 25, a)),
    "dashed polyline": lambda d, m: dashed(
        d, m, add=lambda m, a: m.add_lwpolyline(PATH, dxfattribs=a | {"flags": 128})
    ),
    "dashed polyline by segments": lambda d, m: dashed(d, m, add=lambda m, a: m.add_lwpolyline(PATH, dxfattribs=a)),
    "dashed wide polyline": lambda d, m: dashed(
        d, m, add=lambda m, a: m.add_lwpolyline(PATH, dxfattribs=a | {"const_width": 2})
    ),
    "dashed layer": lambda d, m: (
        line_types(d),
        d.layers.add("L", linetype="DASHED"),
        line(m, (10, 10), (90, 10), layer="L"),
    ),
    "dashed by block": lambda d, m: (
        line_types(d),
        d.blocks.new("B").add_line((0, 0), (80, 0), {"linetype": "BYBLOCK"}),
        insert(m, (10, 10), linetype="DASHED"),
    ),
    "dashed in a block of scale 2": lambda d, m: (
        line_types(d),
        d.blocks.new("B").add_line((0, 0), (40, 0), {"linetype": "DASHED"}),
        insert(m, (10, 10), xscale=2, yscale=2),
    ),
}

FILLS = {
    "hatch": lambda d, m: hatch(m, BOX),
    "hatch with an island": lambda d, m: hatch(m, BOX, INNER),
    "hatch outermost": lambda d, m: hatch(m, BOX, INNER, [(25, 25), (35, 25), (35, 35)], style=1),
    "hatch nested": lambda d, m: hatch(m, BOX, INNER, [(25, 25), (35, 25), (35, 35)]),
    "hatch ignoring islands": lambda d, m: hatch(m, BOX, INNER, style=2),
    "hatch of edges": lambda d, m: edges(m),
    "hatch of a clockwise arc": lambda d, m: clockwise(m),
    "hatch of a spline": lambda d, m: spline_edge(m),
    "hatch with bulges": lambda d, m: hatch(m, [(*p, 0.4) for p in BOX]),
    "hatch of two that overlap": lambda d, m: two_outer(m),
    "hatch pattern": lambda d, m: hatch(m, BOX).set_pattern_fill("ANSI31", scale=4),
    "hatch gradient": lambda d, m: hatch(m, BOX).set_gradient((255, 0, 0), (0, 0, 255)),
    "hatch gradient of one": lambda d, m: hatch(m, BOX).set_gradient((255, 0, 0), (255, 255, 255), one_color=1),
    "hatch background": lambda d, m: (
        lambda h: (h.set_pattern_fill("ANSI31", scale=4), setattr(h, "bgcolor", (255, 255, 0)))
    )(hatch(m, BOX)),
    "hatch that crosses itself": lambda d, m: hatch(m, [(10, 10), (60, 50), (60, 10), (10, 50)]),
    "mpolygon": lambda d, m: mpolygon(m),
    "mpolygon without filling": lambda d, m: mpolygon(m, fill=False),
    "solid": lambda d, m: m.add_solid([(10, 10), (50, 10), (10, 40), (50, 50)]),
    "solid triangle": lambda d, m: m.add_solid([(10, 10), (50, 10), (10, 40)]),
    "solid bow tie": lambda d, m: m.add_solid([(10, 10), (50, 10), (50, 50), (10, 40)]),
    "trace": lambda d, m: m.add_trace([(10, 10), (50, 10), (10, 40), (50, 50)]),
    "3dface": lambda d, m: m.add_3dface([(10, 10), (50, 10), (50, 40), (10, 50)]),
    "3dface with hidden edges": lambda d, m: m.add_3dface(
        [(10, 10), (50, 10), (50, 40), (10, 50)], {"invisible_edges": 5}
    ),
    "3dface triangle": lambda d, m: m.add_3dface([(10, 10), (50, 10), (50, 40)]),
    "3dface triangle hidden edges": lambda d, m: m.add_3dface([(10, 10), (50, 10), (50, 40)], {"invisible_edges": 2}),
    "3dface all hidden": lambda d, m: (
        m.add_3dface([(10, 10), (50, 10), (50, 40)], {"invisible_edges": 15}),
        line(m, (0, 60), (50, 60)),
    ),
    "no filling": lambda d, m: (
        d.header.__setitem__("$FILLMODE", 0),
        m.add_solid([(10, 10), (50, 10), (10, 40), (50, 50)]),
    ),
    "no filling of a wide line": lambda d, m: (
        d.header.__setitem__("$FILLMODE", 0),
        m.add_lwpolyline(PATH, dxfattribs={"const_width": 4}),
    ),
    "wipeout": lambda d, m: (line(m), m.add_wipeout([(30, 5), (50, 35)]), line(m, (10, 30), (70, 10))),
    "wipeout over nothing": lambda d, m: (m.add_wipeout([(30, 105), (50, 135)]), line(m)),
    "wipeout by draw order": lambda d, m: wipeout_sent_back(d, m),
}


def clockwise(m):
    path = hatch(m).paths.add_edge_path()
    path.add_line((10, 10), (50, 10))
    path.add_line((50, 10), (50, 50))
    path.add_arc((30, 50), 20, 0, 180, ccw=False)
    path.add_line((10, 50), (10, 10))


def spline_edge(m):
    path = hatch(m).paths.add_edge_path()
    path.add_spline(control_points=[(10, 10), (20, 40), (50, 40), (60, 10)], degree=3, knot_values=[0] * 4 + [1] * 4)
    path.add_line((60, 10), (10, 10))


def two_outer(m):
    made = hatch(m, BOX)
    made.paths.add_polyline_path([(40, 30), (90, 30), (90, 80), (40, 80)], is_closed=True, flags=1)


def mpolygon(m, fill=True):
    made = m.add_mpolygon(color=1, fill_color=5 if fill else None)
    made.paths.add_polyline_path(BOX, is_closed=True)
    made.paths.add_polyline_path(INNER, is_closed=True)


def wipeout_sent_back(d, m):
    line(m)
    wipe = m.add_wipeout([(30, 5), (50, 35)])
    m.set_redraw_order([(wipe.dxf.handle, "1")])


def clipped(d, m, inverted=False, frame=None):
    block(d)
    made = insert(m, xscale=2, rotation=20)
    clip = ezdxf.xclip.XClip(made)
    clip.set_block_clipping_path([(2, -5), (16, 12)])
    if inverted:
        clip.invert_clipping_path([(-10, -10), (30, 20)])


def placed(add=None, **attributes):
    def draw(d, m):
        made = block(d)
        if add is not None:
            add(made)
        insert(m, **attributes)

    return draw


BLOCKS = {
    "insert": placed(),
    "scaled": placed(xscale=2, yscale=2),
    "unequal scale": placed(xscale=2, yscale=0.5, rotation=20),
    "mirrored": placed(xscale=-1, rotation=20),
    "mirrored up": placed(yscale=-2, xscale=2, rotation=20),
    "turned round by scales": placed(xscale=-1, yscale=-1),
    "rows and columns": placed(row_count=2, column_count=3, row_spacing=30, column_spacing=40, rotation=20),
    "rows and columns scaled": placed(
        row_count=2, column_count=3, row_spacing=30, column_spacing=40, xscale=2, yscale=-1
    ),
    "rows without a distance": placed(row_count=3, column_count=2, column_spacing=40),
    "counts of 0": placed(row_count=0, column_count=0, column_spacing=40),
    "scale of 0": placed(xscale=0),
    "z scale": placed(zscale=-2),
    "base point": lambda d, m: (
        d.blocks.new("B", base_point=(5, 7)).add_line((0, 0), (20, 10)),
        insert(m, xscale=2, rotation=30),
    ),
    "arc squeezed": placed(lambda b: b.add_arc((30, 0), 10, 20, 200), xscale=2, yscale=-0.5, rotation=20),
    "bulges squeezed": placed(
        lambda b: b.add_lwpolyline([(0, 20, 0.5), (30, 20, -1), (30, 40, 0)], format="xyb"),
        xscale=2,
        yscale=0.5,
        rotation=20,
    ),
    "width scaled": placed(
        lambda b: b.add_lwpolyline([(0, 20), (30, 20), (30, 40)], dxfattribs={"const_width": 1}),
        xscale=2,
        yscale=2,
    ),
    "width squeezed": placed(
        lambda b: b.add_lwpolyline([(0, 20), (90, 20)], dxfattribs={"const_width": 0.4}), xscale=1, yscale=4
    ),
    "ellipse squeezed": placed(
        lambda b: b.add_ellipse((30, 0), (10, 4), 0.4, 1, 4), xscale=2, yscale=-0.5, rotation=20
    ),
    "hatch squeezed": placed(
        lambda b: hatch(b, [(0, 20, 0.5), (30, 20, 0), (30, 40, 0)]), xscale=2, yscale=-0.5, rotation=20
    ),
    "blocks in blocks": lambda d, m: (
        block(d),
        d.blocks.new("O").add_blockref("B", (10, 0), {"rotation": 40, "yscale": 3}),
        insert(m, name="O", xscale=2, rotation=10),
    ),
    "no block": lambda d, m: (line(m), insert(m, name="NOWHERE")),
    "clipped": clipped,
    "clipped inside out": lambda d, m: clipped(d, m, inverted=True),
    "block in inches": lambda d, m: setattr(block(d), "units", 1) or insert(m),
    "xref": lambda d, m: (d.add_xref_def("other.dxf", "X"), insert(m, name="X"), line(m)),
    "overlay": lambda d, m: (d.add_xref_def("other.dxf", "X", flags=8 | 4), insert(m, name="X"), line(m)),
    "anonymous": lambda d, m: (lambda b: (b.add_line((0, 0), (30, 30)), m.add_blockref(b.name, (20, 20))))(
        d.blocks.new_anonymous_block()
    ),
}


def points(mode, size=0):
    def draw(d, m):
        d.header["$PDMODE"], d.header["$PDSIZE"] = mode, size
        m.add_point((50, 50))

    return draw


def mline(**how):
    def draw(d, m):
        style = d.mline_styles.new("M")
        for offset, colour in how.get("lines", ((0.5, 1), (0, 256), (-0.5, 3))):
            style.elements.append(offset, colour)
        style.dxf.flags = how.get("flags", 0)
        style.dxf.fill_color = 5
        style.dxf.start_angle = style.dxf.end_angle = how.get("angle", 90)
        made = m.add_mline(PATH, close=how.get("close", False), dxfattribs={"style_name": "M"})
        made.set_scale_factor(how.get("scale", 4))
        made.set_justification(how.get("justification", 1))
        if "line_flags" in how:
            made.dxf.flags |= how["line_flags"]

    return draw


def dimension(kind, **how):
    def draw(d, m):
        attributes = {"dimstyle": "EZDXF", "text": "AxA"}
        override = {"dimtxsty": "T", "dimtxt": 5, "dimasz": 3} | how
        match kind:
            case "linear":
                made = m.add_linear_dim((0, 40), (10, 10), (80, 10), override=override, **attributes)
            case "aligned":
                made = m.add_aligned_dim((10, 10), (80, 30), 12, override=override, **attributes)
            case "radius":
                made = m.add_radius_dim((50, 50), radius=20, angle=40, override=override, **attributes)
            case "diameter":
                made = m.add_diameter_dim((50, 50), radius=20, angle=40, override=override, **attributes)
            case "angular":
                made = m.add_angular_dim_cra((50, 50), 40, 20, 80, 5, override=override, **attributes)
            case "ordinate":
                made = m.add_ordinate_x_dim((40, 20), (5, 20), override=override, **attributes)
            case "arc":
                made = m.add_arc_dim_cra((50, 50), 40, 20, 80, 5, override=override, **attributes)
        made.render()

    return draw


def leader(**attributes):
    def draw(d, m):
        m.add_leader(
            [(10, 10), (40, 30), (70, 30)],
            override={"dimasz": 5, "dimldrblk": attributes.pop("block", "")},
            dxfattribs=attributes,
        )

    return draw


def multileader(d, m, words=WORDS, block_of=None):
    if block_of:
        block(d)
        made = m.add_multileader_block("Standard")
        made.set_content("B")
    else:
        made = m.add_multileader_mtext("Standard")
        made.set_content(words, style="T", char_height=6)
    made.add_leader_line(ezdxf.render.mleader.ConnectionSide.left, [ezdxf.math.Vec2(-20, -15)])
    made.build(insert=ezdxf.math.Vec2(50, 50))


def mesh(d, m):
    with m.add_mesh().edit_data() as data:
        data.vertices, data.faces = [(10, 10, 0), (50, 10, 0), (50, 50, 0), (10, 50, 0)], [(0, 1, 2, 3)]


def with_line(kind, **attributes):
    def draw(d, m):
        line(m)
        m.new_entity(kind, attributes)

    return draw


def solid(kind):
    def draw(d, m):
        line(m)
        getattr(m, f"add_{kind}")().sat = ["400 0 1 0", "End-of-ACIS-data"]

    return draw


def image(d, m):
    line(m)
    m.add_image(d.add_image_def("picture.png", (100, 100)), (50, 50), (40, 40))


def underlay(d, m):
    line(m)
    m.add_underlay(d.add_underlay_def("page.pdf"), (50, 50))


OTHERS = {
    **{f"point mode {mode}": points(mode, 6) for mode in (0, 1, 2, 3, 4, 32, 33, 34, 35, 36, 64, 66, 67, 96, 98, 99)},
    "point mode 3 of relative size": points(3, -5),
    "point mode 3 of size 0": points(3, 0),
    "mline": mline(),
    "mline closed": mline(close=True),
    "mline top": mline(justification=0),
    "mline bottom": mline(justification=2),
    "mline caps": mline(flags=16 | 256),
    "mline round caps": mline(flags=64 | 1024),
    "mline inner arcs": mline(flags=32 | 512, lines=((1, 1), (0.5, 2), (-0.5, 2), (-1, 1))),
    "mline slanted caps": mline(flags=16 | 256, angle=45),
    "mline joints": mline(flags=2),
    "mline filled": mline(flags=1),
    "mline filled with caps": mline(flags=1 | 16 | 256 | 2),
    "mline without caps of its own": mline(flags=16 | 256, line_flags=4 | 8),
    "mline mirrored by its scale": mline(scale=-4),
    **{
        f"dimension {kind}": dimension(kind)
        for kind in ("linear", "aligned", "radius", "diameter", "angular", "ordinate", "arc")
    },
    "dimension ticks": dimension("linear", dimtsz=2),
    "dimension with text masked": dimension("linear", dimtfill=1),
    "dimension without a block": lambda d, m: (m.add_linear_dim((0, 40), (10, 10), (80, 10)), line(m)),
    "leader": leader(),
    "leader without an arrow": leader(has_arrowhead=0),
    "leader spline": leader(path_type=1),
    "leader dot": leader(block="DOT"),
    "leader hook": leader(has_hookline=1, hookline_direction=1, text_width=10),
    "multileader": multileader,
    "multileader of a block": lambda d, m: multileader(d, m, block_of="B"),
    "mesh": mesh,
    **{kind: solid(kind) for kind in ("region", "body", "3dsolid", "surface")},
    "image": image,
    "underlay": underlay,
    "ole": with_line("OLE2FRAME"),
    "tolerance": with_line("TOLERANCE", content="{\\Fgdt;j}%%vA", insert=(50, 50)),
    "light": with_line("LIGHT"),
    "shape": with_line("SHAPE", name="A", insert=(50, 50), size=5),
    "viewport": with_line("VIEWPORT"),
    "proxy": with_line("ACAD_PROXY_ENTITY"),
}

# Features where the add-on contradicts the DXF reference or itself -----------------------------------------

OWN = {
    "ellipse of negative ratio": "the arc goes another way: the minor axis is the turned major one times the ratio",
    "spline closed": "it goes on beyond the knots between which there is a curve",
    "spline closed rational": "as above",
    "mtext stack coloured": "its line has the colour of the text around",
    "polyline spline fit": "it joins the control points too, which are marked as a frame (70 = 16)",
    "polyline 3d spline fit": "as above",
    "lwpolyline constant width and widths": "43 is not used where vertices have widths of their own",
    **{
        f"text {k}": "it does not slant TEXT (51)"
        for k in ("oblique", "oblique to the left", "oblique 340", "oblique right", "oblique wide turned")
    },
    "text %%065": "it shows the code: the number of a character",
    "text unicode": "it shows the code, unless it repairs the file",
    "mtext heights": "letters of several heights in one word hang from one line with it, and stand on one in CAD",
    "mtext aligned middle": "as above",
    "defpoints": "this layer is never plotted",
    "text in a sheared block": "it splits blocks into TEXT, which cannot be sheared",
    "mtext in a stretched block": "as above, stretched",
    "mtext in a sheared block": "as above",
    "blocks in blocks": "it splits blocks into blocks, which cannot be sheared",
    "attribute constant": "it does not show them: there is no ATTRIB in their place",
    "layer missing": "it hides what is on a layer that no table names",
    "insert on a layer that is off": "only a frozen layer hides what a block holds on other layers",
    "colour 255": "white ink on white paper: ours is black",
    "dashed circle": "it goes another way round",
    "dashed polyline by segments": "it dashes on over the corners, with any flag of the polyline",
    "dashed wide polyline": "it does not dash them",
}

# CAD shows these features, and neither the add-on nor brushsvg does. brushsvg must report them.
NAMED = [
    *(f"text %%{letter}" for letter in "uok"),
    *("style vertical", "mtext vertical", "mtext of a vertical style", "mtext tracking"),
    *("mtext with a tall word, spacing 2 1", "mtext with a tall word, spacing 2 2", "mtext of no style"),
    *(
        "line thickness from the side",
        "transparent",
        "layer transparent",
        "no filling",
        "no filling of a wide line",
    ),
    *("region", "body", "3dsolid", "surface", "underlay", "ole", "tolerance", "light", "shape", "proxy"),
    *(
        "xref",
        "overlay",
        "no block",
        "dimension without a block",
        "paper space",
        "text of height 0",
        "wipeout",
    ),
    *("hatch gradient", "dimension with text masked", "with letters", "clipped", "attribute definition"),
]

TABLES = {
    "lines": LINES,
    "planes": PLANES,
    "texts": TEXTS,
    "mtexts": MTEXTS,
    "layers": LAYERS,
    "dashes": DASHES,
    "fills": FILLS,
    "blocks": BLOCKS,
    "others": OTHERS,
}
