"""
The brush: simulation, inverse, marks. Millimetres, radians, paper frame.
"""

from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import typing
from ..errors import Notice
from . import lag

__all__: list[str] = [
    "Arc",
    "AxisBranch",
    "Brush",
    "CommonArea",
    "Compensated",
    "Footprint",
    "FootprintTable",
    "LawFit",
    "LawPrior",
    "LawShape",
    "Lines",
    "MOST_ENTRIES",
    "Machine",
    "MarkFit",
    "MarkLaws",
    "MarkOptions",
    "MarkResidual",
    "Marks",
    "Norm",
    "Paint",
    "PaintedMark",
    "Pass",
    "PassMarks",
    "Plan",
    "Prior",
    "Profile",
    "Settings",
    "Stroke",
    "StrokeId",
    "TrackingError",
    "Verdict",
    "WorstPlace",
    "area",
    "as_normal",
    "bristle_coefficients",
    "bristle_deflection",
    "check",
    "clearance",
    "common_area",
    "common_areas",
    "compensate",
    "convex_hull",
    "coverage",
    "coverage_of_pieces",
    "deviations_of_95",
    "excess_turning",
    "fill",
    "first_crossings",
    "fit_curve",
    "fit_law",
    "fit_marks",
    "flatten",
    "follow_lags",
    "footprint_at",
    "from_angles",
    "interrupted",
    "intersect",
    "lag",
    "medial_axis",
    "narrow",
    "overlap",
    "painted_bounds",
    "read_brush",
    "read_marks",
    "read_plan",
    "refuse_tilted",
    "remarks",
    "search_strokes",
    "simulate",
    "thin_out",
    "thorns",
    "touching",
    "trace_outlines",
    "tracking_error_of",
    "tracking_errors_of",
    "uncovered_areas",
    "unite",
    "verdicts",
    "wanted_coverage",
    "wanted_outline",
    "wanted_pieces",
    "widest_points",
    "write_brush",
    "write_marks",
    "write_plan",
]

class Profile:
    """
    A law of a brush: one parameter [mm] against press depth d [mm], max(floor + floor_slope d, c0 + c1 d + ...).

    Profile([3.1, 0.86])(2.0) is 3.1 + 0.86 * 2 mm; depths may be an array. coefficients: at most 11, in ascending powers of
    d. calibrated_mm: (least, greatest) depth that was measured, None where nobody says; source: where it comes from, in words;
    assumed: nobody measured it. half_interval_95, rmse_mm: how sure it is, by degrees_of_freedom values to spare. extra:
    unknown keys of its file, as JSON. A value: it is not changed, but another one made.
    """
    @typing.overload
    def __call__(self, depth_mm: float) -> float: ...  # type: ignore[overload-overlap]
    @typing.overload
    def __call__(
        self, depth_mm: numpy.typing.ArrayLike
    ) -> numpy.typing.NDArray[numpy.float64]: ...
    def __copy__(self) -> Profile: ...
    def __deepcopy__(self, memo: dict) -> Profile: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        coefficients: collections.abc.Sequence[float] = [],
        *,
        floor: float = ...,
        floor_slope: float = 0.0,
        calibrated_mm: collections.abc.Sequence[float] | None = None,
        source: str = "",
        assumed: bool = False,
        half_interval_95: collections.abc.Sequence[float] = [],
        rmse_mm: float | None = None,
        degrees_of_freedom: float | None = None,
        extra: str = "{}",
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @typing.overload
    def extrapolated(self, depth_mm: float) -> float: ...  # type: ignore[overload-overlap]
    @typing.overload
    def extrapolated(
        self, depth_mm: numpy.typing.ArrayLike
    ) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def assumed(self) -> bool: ...
    @property
    def calibrated_mm(self) -> tuple[float, float] | None: ...
    @property
    def coefficients(self) -> tuple[float, ...]: ...
    @property
    def degrees_of_freedom(self) -> float | None: ...
    @property
    def depth_range_mm(self) -> tuple[float, float] | None:
        """
        Depths [mm] at which it is defined, of a law of a Brush: its depth_range_mm. None: any.
        """
    @property
    def extra(self) -> str: ...
    @property
    def floor(self) -> float: ...
    @property
    def floor_slope(self) -> float: ...
    @property
    def half_interval_95(self) -> tuple[float, ...]: ...
    @property
    def rmse_mm(self) -> float | None: ...
    @property
    def source(self) -> str: ...

class Paint:
    """
    What the way [mm] painted since the last dip does: marks are exp(-narrows_per_m way / 1000) times as wide.

    Paint(0.4).width_share(500) is exp(-0.2). The way is the TCP's on the paper. lasts_mm: the way after which hairs run dry,
    None where nobody knows. calibrated_mm: (least, greatest) way that was measured; source: where it comes from, in words;
    assumed: nobody measured it. covariance: of narrows_per_m, and lasts_mm where it is known, or empty, by
    degrees_of_freedom values to spare. extra: unknown keys of its file, as JSON. A value: it is not changed, but another
    one made.
    """
    def __copy__(self) -> Paint: ...
    def __deepcopy__(self, memo: dict) -> Paint: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        narrows_per_m: float = 0.0,
        *,
        lasts_mm: float | None = None,
        calibrated_mm: collections.abc.Sequence[float] | None = None,
        source: str = "",
        assumed: bool = False,
        covariance: collections.abc.Sequence[collections.abc.Sequence[float]] = [],
        degrees_of_freedom: float | None = None,
        extra: str = "{}",
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def way_to_share_mm(self, share: float) -> float:
        """
        The way [mm] after which the width is that share of a freshly dipped brush's; infinite where it never is.
        """
    def width_share(self, way_mm: float) -> float:
        """
        Width over that of a freshly dipped brush, after a way [mm].
        """
    @property
    def assumed(self) -> bool: ...
    @property
    def calibrated_mm(self) -> tuple[float, float] | None: ...
    @property
    def covariance(self) -> tuple[tuple[float, ...], ...]: ...
    @property
    def degrees_of_freedom(self) -> float | None: ...
    @property
    def extra(self) -> str: ...
    @property
    def lasts_mm(self) -> float | None: ...
    @property
    def narrows_per_m(self) -> float: ...
    @property
    def source(self) -> str: ...

class Footprint:
    """
    The outline (n, 2) [mm] of the contact patch at one depth [mm].

    outline_mm, at depth_mm: a simple ring, counter-clockwise, unclosed, whose first point is the tip at (0, 0); x points
    towards the TCP.
    """
    def __copy__(self) -> Footprint: ...
    def __deepcopy__(self, memo: dict) -> Footprint: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(self, depth_mm: float, outline_mm: numpy.typing.ArrayLike) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def depth_mm(self) -> float: ...
    @property
    def outline_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...

class FootprintTable:
    """
    The outlines of a brush at several depths, in tuples, depths ascending.

    dragged: while the brush is drawn along; pressed: straight down, () where that is the same. All have equally many points,
    between which outlines of other depths are blended one by one.
    """
    def __copy__(self) -> FootprintTable: ...
    def __deepcopy__(self, memo: dict) -> FootprintTable: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        dragged: collections.abc.Sequence[Footprint] = [],
        pressed: collections.abc.Sequence[Footprint] = [],
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def dragged(self) -> tuple[Footprint, ...]: ...
    @property
    def pressed(self) -> tuple[Footprint, ...]: ...

class Brush:
    """
    Four laws against depth and the footprints; all lengths in mm, depths in mm from first contact down.

    lag, tip_gap, tip_to_widest, half_width: the laws, each a Profile that refuses depths at which the brush cannot be; footprints: a FootprintTable. Outlines rule what is
    painted, laws where the tool goes: they may differ by 0.5 mm. Begin with Brush() and set all of them, name and
    depth_range_mm, or with the copy of a known one. Set each as a whole: it is a value that cannot be changed.
    save_brush, simulate, compensate and convert refuse what no brush can be.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __copy__(self) -> Brush: ...
    def __deepcopy__(self, memo: dict) -> Brush: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __init__(self) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def depth_for_half_width(self, half_width_mm: float, where: str = "") -> float:
        """
        Depth [mm] that paints a half width [mm]; Error with the reachable range when there is none.
        """
    def half_width_range_mm(self) -> list[float]:
        """
        (least, greatest) half width [mm] within depth_range_mm.
        """
    def is_rigid(self) -> bool:
        """
        Whether the lag is 0 everywhere: a pen.
        """
    def lever_to_widest(self, depth_mm: float) -> float:
        """
        e(d) = x_w(d) - b(d) [mm], signed.
        """
    def width_follows_depth(self) -> bool:
        """
        Whether half_width depends on depth.
        """
    @property
    def covariance(self) -> tuple[tuple[float, ...], ...]:
        """
        Of all coefficients, in the order of the four laws, or empty.
        """
    @covariance.setter
    def covariance(
        self, arg1: collections.abc.Sequence[collections.abc.Sequence[float]]
    ) -> None: ...
    @property
    def depth_range_mm(self) -> tuple[float, float]:
        """
        (least, greatest) depth [mm] to which it may be pressed.
        """
    @depth_range_mm.setter
    def depth_range_mm(self, arg1: collections.abc.Sequence[float]) -> None: ...
    @property
    def extra(self) -> str:
        """
        JSON object of the keys of its file that are not known, written back as read.
        """
    @extra.setter
    def extra(self, arg0: str) -> None: ...
    @property
    def footprints(self) -> FootprintTable:
        """
        Outlines by depth: a FootprintTable.
        """
    @footprints.setter
    def footprints(self, arg1: FootprintTable) -> None: ...
    @property
    def half_width(self) -> Profile:
        """
        h(d): half of the footprint's greatest width. A Profile that never falls.
        """
    @half_width.setter
    def half_width(self, arg1: Profile) -> None: ...
    @property
    def kind(self) -> str:
        """
        round, liner (a round brush of long bristles), pen, or empty: round. Another one is refused.
        """
    @kind.setter
    def kind(self, arg0: str) -> None: ...
    @property
    def lag(self) -> Profile:
        """
        r(d): how far the centre of friction trails the TCP, bristles taut. A Profile, 0 everywhere for a pen.
        """
    @lag.setter
    def lag(self, arg1: Profile) -> None: ...
    @property
    def max_speed_mm_s(self) -> float:
        """
        The greatest speed [mm/s] at which the model holds; it has no inertia.
        """
    @max_speed_mm_s.setter
    def max_speed_mm_s(self, arg0: float) -> None: ...
    @property
    def name(self) -> str:
        """
        What plans and messages call it.
        """
    @name.setter
    def name(self, arg0: str) -> None: ...
    @property
    def paint(self) -> Paint | None:
        """
        How its mark narrows from dip to dip: a Paint, or None.
        """
    @paint.setter
    def paint(self, arg1: Paint | None) -> None: ...
    @property
    def paint_depth_mm(self) -> float:
        """
        Depth [mm] to paint at where half_width does not depend on depth.
        """
    @paint_depth_mm.setter
    def paint_depth_mm(self, arg0: float) -> None: ...
    @property
    def sha256(self) -> str:
        """
        Of the bytes of the file it was read from, or empty.
        """
    @sha256.setter
    def sha256(self, arg0: str) -> None: ...
    @property
    def tip_gap(self) -> Profile:
        """
        b(d): from the tip of the footprint to the centre of friction. A Profile.
        """
    @tip_gap.setter
    def tip_gap(self, arg1: Profile) -> None: ...
    @property
    def tip_to_widest(self) -> Profile:
        """
        x_w(d): from the tip of the footprint to its widest section. A Profile.
        """
    @tip_to_widest.setter
    def tip_to_widest(self, arg1: Profile) -> None: ...

class Settings:
    """
    What a drawing says of an element to brushsvg itself; None where it says nothing.

    brush, end, order, passes, reload, skip, speed_mm_s, start, width_mm: see docs/reference/drawings.md; kind: of a stroke of the calibration
    chart; extra: unknown keys of a plan.json, as JSON. A value that cannot be changed.
    """
    def __copy__(self) -> Settings: ...
    def __deepcopy__(self, memo: dict) -> Settings: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        *,
        brush: str | None = None,
        end: str | None = None,
        kind: str | None = None,
        order: int | None = None,
        passes: int | None = None,
        reload: bool | None = None,
        skip: bool | None = None,
        speed_mm_s: float | None = None,
        start: str | None = None,
        width_mm: float | None = None,
        extra: str = "{}",
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def replaced(self, **fields: object) -> Settings:
        """
        A copy in which the fields that are given are these.
        """
    @property
    def brush(self) -> str | None: ...
    @property
    def end(self) -> str | None: ...
    @property
    def extra(self) -> str: ...
    @property
    def kind(self) -> str | None: ...
    @property
    def order(self) -> int | None: ...
    @property
    def passes(self) -> int | None: ...
    @property
    def reload(self) -> bool | None: ...
    @property
    def skip(self) -> bool | None: ...
    @property
    def speed_mm_s(self) -> float | None: ...
    @property
    def start(self) -> str | None: ...
    @property
    def width_mm(self) -> float | None: ...

class StrokeId:
    """
    Where in a drawing a stroke comes from.

    element: its id; part: which of its sub-paths, 0 for the only one; repeat: which of the times that it is painted; lane:
    which of the passes that fill a shape wider than the brush; load: which of the loads of paint. name: element/part#repeat
    ~lane+load, each where it says something; nobody takes it apart again.
    """
    def __copy__(self) -> StrokeId: ...
    def __deepcopy__(self, memo: dict) -> StrokeId: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self, element: str, part: int = 0, repeat: int = 1, lane: int = 1, load: int = 1
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def element(self) -> str: ...
    @property
    def lane(self) -> int: ...
    @property
    def load(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def part(self) -> int: ...
    @property
    def repeat(self) -> int: ...

class Stroke:
    """
    A middle line of cubics (n, 8) [mm] with half widths [(fraction of arc length, mm)].

    id: its name, made of origin, a StrokeId, and set by a name or one. middle_mm, half_width, wanted_mm, settings: to be
    set as a whole. start_covered, end_covered: where it meets others of its shape, whose paint covers that end.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    closed: bool
    colour: str
    end_covered: bool
    layer: str
    settings: Settings
    start_covered: bool
    @staticmethod
    def from_points(
        points_mm: numpy.typing.ArrayLike,
        width_mm: numpy.typing.ArrayLike,
        name: str = "stroke1",
        *,
        tolerance_mm: float | None = None,
    ) -> Stroke:
        """
        A stroke through points (n, 2) [mm], y up, in painting direction; closed where the last is the first again.

        width_mm: one for all, or (n,), one at each point and linear in between. tolerance_mm: None for straight lines from
        point to point; else cubics that pass each point within it, smooth but for corners that no smooth line follows; lines
        where the points are too far apart for it.

        Error, naming the stroke: fewer than two points that differ, a number that is not finite or beyond 1e6 mm, a width that
        is not positive.
        """
    def __copy__(self) -> Stroke: ...
    def __deepcopy__(self, memo: dict) -> Stroke: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __init__(
        self,
        id: StrokeId | str = "",
        middle_mm: numpy.typing.ArrayLike = ...,
        closed: bool = False,
        half_width: collections.abc.Sequence[tuple[float, float]] = [],
        layer: str = "",
        colour: str = "",
        settings: Settings = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def replaced(self, **fields: object) -> Stroke:
        """
        A copy in which the fields that are given are these.
        """
    @property
    def half_width(self) -> tuple[tuple[float, float], ...]: ...
    @half_width.setter
    def half_width(
        self, arg1: collections.abc.Sequence[tuple[float, float]]
    ) -> None: ...
    @property
    def id(self) -> str: ...
    @id.setter
    def id(self, arg1: StrokeId | str) -> None: ...
    @property
    def middle_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @middle_mm.setter
    def middle_mm(self, arg1: numpy.typing.ArrayLike) -> None: ...
    @property
    def origin(self) -> StrokeId: ...
    @property
    def wanted_mm(self) -> tuple[numpy.typing.NDArray[numpy.float64], ...]: ...
    @wanted_mm.setter
    def wanted_mm(
        self, arg1: collections.abc.Sequence[numpy.typing.ArrayLike]
    ) -> None: ...

class Arc:
    """
    Poses first to last are on a circle about centre_mm (x, y), at constant depth.

    direction: 1 counter-clockwise, -1 clockwise; neighbouring poses are less than 180 degrees apart on it.
    """
    def __copy__(self) -> Arc: ...
    def __deepcopy__(self, memo: dict) -> Arc: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self, first: int, last: int, centre_mm: tuple[float, float], direction: int
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def centre_mm(self) -> tuple[float, float]: ...
    @property
    def direction(self) -> int: ...
    @property
    def first(self) -> int: ...
    @property
    def last(self) -> int: ...

class Pass:
    """
    One stroke's motion.

    stroke: the name of what it paints, made of origin, a StrokeId, and set by a name or one.
    poses_mm: (n, 3) x, y, z = -depth [mm], straight moves in between, depth linear along each; read-only and not copied when read,
    to be replaced as a whole. arcs: a tuple of Arc, ascending: these poses are followed on the true circle, whose chords
    the straight moves are. speed_mm_s; layer, colour; settings, to be set as a whole;
    load: which of its stroke's loads of paint it is, from 1, or 0 for a stroke that is whole; extra: unknown keys of the
    file, as JSON. tool_axes: (n, 3) of each pose the unit vector from the tip up along the brush, in the frame of the paper,
    tilted by at most 30 degrees; empty for a brush that is upright; given, read and replaced as poses_mm.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    colour: str
    extra: str
    layer: str
    settings: Settings
    def __copy__(self) -> Pass: ...
    def __deepcopy__(self, memo: dict) -> Pass: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __init__(
        self,
        stroke: StrokeId | str = "",
        poses_mm: numpy.typing.ArrayLike = ...,
        speed_mm_s: float = 20.0,
        layer: str = "",
        colour: str = "",
        settings: Settings = ...,
        extra: str = "{}",
        arcs: collections.abc.Sequence[Arc] = [],
        load: int = 0,
        tool_axes: numpy.typing.ArrayLike = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def arcs(self) -> tuple[Arc, ...]: ...
    @arcs.setter
    def arcs(self, arg1: collections.abc.Sequence[Arc]) -> None: ...
    @property
    def load(self) -> int: ...
    @load.setter
    def load(self, arg0: int) -> None: ...
    @property
    def origin(self) -> StrokeId: ...
    @property
    def poses_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @poses_mm.setter
    def poses_mm(self, arg1: numpy.typing.ArrayLike) -> None: ...
    @property
    def speed_mm_s(self) -> float: ...
    @speed_mm_s.setter
    def speed_mm_s(self, arg0: float) -> None: ...
    @property
    def stroke(self) -> str: ...
    @stroke.setter
    def stroke(self, arg1: StrokeId | str) -> None: ...
    @property
    def tool_axes(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @tool_axes.setter
    def tool_axes(self, arg1: numpy.typing.ArrayLike) -> None: ...

class Plan:
    """
    TCP poses for every stroke, in the frame of the paper: plan.json as a value.

    brush, brush_sha256: what it was made for; sheet_mm: (w, h); passes: a tuple with one Pass per stroke, in painting
    order, to be set as a whole; extra: unknown keys of the file, as JSON.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    brush: str
    brush_sha256: str
    extra: str
    def __copy__(self) -> Plan: ...
    def __deepcopy__(self, memo: dict) -> Plan: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __init__(
        self,
        brush: str = "",
        brush_sha256: str = "",
        sheet_mm: collections.abc.Sequence[float] = [0.0, 0.0],
        passes: collections.abc.Sequence[Pass] = [],
        extra: str = "{}",
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def passes(self) -> tuple[Pass, ...]: ...
    @passes.setter
    def passes(self, arg1: collections.abc.Sequence[Pass]) -> None: ...
    @property
    def sheet_mm(self) -> tuple[float, float]: ...
    @sheet_mm.setter
    def sheet_mm(self, arg1: collections.abc.Sequence[float]) -> None: ...

class PassMarks:
    """
    What the patch does during one pass; parallel rows (mm, rad), read only.

    pose: the index of the plan's pose, with fractions in between. contact_mm[pose_rows] is the contact at each pose. Rows after
    the last pose's are the lift on the spot of a pass that ends on the paper (the patch moves as the bristles straighten), rows
    before the first pose's the brush being set down.

    lean_mm_per_mm (n, 2): how far the axis of a tilted brush goes sideways for each mm up; empty for one that is upright.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    stroke: str
    def __copy__(self) -> PassMarks: ...
    def __deepcopy__(self, memo: dict) -> PassMarks: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __init__(self) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def contact_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def depth_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def heading_rad(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def lean_mm_per_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def outline_mm(self) -> tuple[numpy.typing.NDArray[numpy.float64], ...]: ...
    @outline_mm.setter
    def outline_mm(
        self, arg1: collections.abc.Sequence[numpy.typing.ArrayLike]
    ) -> None: ...
    @property
    def pose(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def pose_rows(self) -> numpy.typing.NDArray[numpy.int64]:
        """
        For each pose of the pass the index of its row.
        """
    @property
    def pull(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def taut(self) -> numpy.typing.NDArray[numpy.bool]: ...
    @property
    def tcp_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def width_share(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        By how much narrower the brush paints than freshly dipped; empty: it does not.
        """

class Marks:
    """
    What is painted: marks.json as a value.

    passes: a tuple with a PassMarks per stroke; outline_mm: a tuple of rings [(n, 2) mm] of all paint together, filled by trace_outlines, outer
    ones counter-clockwise, holes clockwise, unclosed.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __copy__(self) -> Marks: ...
    def __deepcopy__(self, memo: dict) -> Marks: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __init__(self) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def outline_mm(self) -> tuple[numpy.typing.NDArray[numpy.float64], ...]: ...
    @outline_mm.setter
    def outline_mm(
        self, arg1: collections.abc.Sequence[numpy.typing.ArrayLike]
    ) -> None: ...
    @property
    def passes(self) -> tuple[PassMarks, ...]: ...
    @passes.setter
    def passes(self, arg1: collections.abc.Sequence[PassMarks]) -> None: ...

class AxisBranch:
    """
    A stretch of the medial axis between two nodes.
    """
    def __copy__(self) -> AxisBranch: ...
    def __deepcopy__(self, memo: dict) -> AxisBranch: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def end(self) -> int: ...
    @property
    def line(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def part(self) -> tuple[numpy.typing.NDArray[numpy.float64], ...]: ...
    @property
    def start(self) -> int: ...

class CommonArea:
    """
    Areas [mm^2] of paint and target mark.
    """
    def __copy__(self) -> CommonArea: ...
    def __deepcopy__(self, memo: dict) -> CommonArea: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(self, common_mm2: float, together_mm2: float) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def common_mm2(self) -> float: ...
    @property
    def overlap(self) -> float: ...
    @property
    def together_mm2(self) -> float: ...

class WorstPlace:
    """
    Where paint and drawing differ most, and by how much.
    """
    def __copy__(self) -> WorstPlace: ...
    def __deepcopy__(self, memo: dict) -> WorstPlace: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def area_mm2(self) -> float: ...
    @property
    def at_mm(self) -> tuple[float, ...]: ...
    @property
    def is_missing(self) -> bool: ...

class Verdict:
    """
    How well a pass paints its stroke.

    overlap: common over joint area; width_error_mm: mean absolute difference of widths across the line, None where none can
    be measured; excess_turning: of the mark's outline, in full turns; worst: a WorstPlace.
    """
    def __copy__(self) -> Verdict: ...
    def __deepcopy__(self, memo: dict) -> Verdict: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def excess_turning(self) -> float: ...
    @property
    def overlap(self) -> float: ...
    @property
    def width_error_mm(self) -> float | None: ...
    @property
    def worst(self) -> WorstPlace: ...

class TrackingError:
    """
    Distance of the widest point from the middle line [mm], from the first taut row to the last.

    largest_mm, where at_mm (x, y) it is; mean_mm over the length painted; within_tolerance; has_turn_in_place: at a corner
    too sharp for the lever.
    """
    def __copy__(self) -> TrackingError: ...
    def __deepcopy__(self, memo: dict) -> TrackingError: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def at_mm(self) -> tuple[float, ...]: ...
    @property
    def has_turn_in_place(self) -> bool: ...
    @property
    def largest_mm(self) -> float: ...
    @property
    def mean_mm(self) -> float: ...
    @property
    def within_tolerance(self) -> bool: ...

class Compensated:
    """
    A plan, the tracking error of each pass, and warnings, notices about strokes.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __copy__(self) -> Compensated: ...
    def __deepcopy__(self, memo: dict) -> Compensated: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def spliced(
        self, other: Compensated, passes: collections.abc.Sequence[tuple[bool, int]]
    ) -> Compensated:
        """
        One plan of passes of both: (whether it is the other's, its number), in order.
        """
    @property
    def plan(self) -> Plan: ...
    @property
    def tracking_errors(self) -> tuple[TrackingError, ...]: ...
    @property
    def warnings(self) -> tuple[Notice, ...]: ...

class Norm:
    """
    Members:

      squares

      absolute
    """

    __members__: typing.ClassVar[dict[str, Norm]]
    absolute: typing.ClassVar[Norm]
    squares: typing.ClassVar[Norm]
    @typing.overload
    def __eq__(self, other: Norm) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Norm) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: int) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class LawShape:
    """
    Constraints on a fitted law; positive and rising hold on range_mm.
    """
    def __copy__(self) -> LawShape: ...
    def __deepcopy__(self, memo: dict) -> LawShape: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        range_mm: collections.abc.Sequence[float],
        degree: int,
        *,
        through_zero: bool = False,
        positive: bool = False,
        rising: bool = False,
        floor: float = ...,
        norm: Norm = ...,
        smoothing: float = 0.0,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...

class LawFit:
    """
    A fitted law, how sure it is, and what it leaves.
    """
    def __copy__(self) -> LawFit: ...
    def __deepcopy__(self, memo: dict) -> LawFit: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        *,
        law: Profile,
        covariance: collections.abc.Sequence[collections.abc.Sequence[float]],
        residual_mm: collections.abc.Sequence[float],
        r_squared: float,
        degrees_of_freedom: float,
        held: bool,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def covariance(self) -> tuple[tuple[float, ...], ...]: ...
    @property
    def degrees_of_freedom(self) -> float: ...
    @property
    def held(self) -> bool: ...
    @property
    def law(self) -> Profile: ...
    @property
    def r_squared(self) -> float: ...
    @property
    def residual_mm(self) -> tuple[float, ...]: ...

class Lines:
    """
    Members:

      plain

      total
    """

    __members__: typing.ClassVar[dict[str, Lines]]
    plain: typing.ClassVar[Lines]
    total: typing.ClassVar[Lines]
    @typing.overload
    def __eq__(self, other: Lines) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Lines) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: int) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class PaintedMark:
    """
    What one pass painted.

    stroke: its id; poses_mm (n, 3): the TCP's way, z = -depth; outline_mm: rings [(n, 2) mm], holes among them; arcs: of
    the pass, followed on their circles.
    """
    def __copy__(self) -> PaintedMark: ...
    def __deepcopy__(self, memo: dict) -> PaintedMark: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        stroke: str,
        poses_mm: numpy.typing.ArrayLike,
        outline_mm: collections.abc.Sequence[numpy.typing.ArrayLike],
        arcs: collections.abc.Sequence[Arc] = [],
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def arcs(self) -> tuple[Arc, ...]: ...
    @property
    def outline_mm(self) -> tuple[numpy.typing.NDArray[numpy.float64], ...]: ...
    @property
    def poses_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def stroke(self) -> str: ...

class Prior:
    """
    What is known beforehand: a normal distribution; sigma 0: known, inf: nothing.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __copy__(self) -> Prior: ...
    def __deepcopy__(self, memo: dict) -> Prior: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __init__(self, value: float, sigma: float) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def sigma(self) -> float: ...
    @sigma.setter
    def sigma(self, arg0: float) -> None: ...
    @property
    def value(self) -> float: ...
    @value.setter
    def value(self, arg0: float) -> None: ...

class MarkLaws:
    """
    Laws as coefficients (ascending powers of depth), and a drop's shape.
    """
    def __copy__(self) -> MarkLaws: ...
    def __deepcopy__(self, memo: dict) -> MarkLaws: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        lag: collections.abc.Sequence[float],
        tip_gap: collections.abc.Sequence[float],
        half_width: collections.abc.Sequence[float],
        widest_per_half: float = 1.8,
        front_per_half: float = 1.0,
        round_tail: bool = False,
        widest_by_depth: collections.abc.Sequence[float] = [],
        front_by_depth: collections.abc.Sequence[float] = [],
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def front_by_depth(self) -> tuple[float, ...]: ...
    @property
    def front_per_half(self) -> float: ...
    @property
    def half_width(self) -> tuple[float, ...]: ...
    @property
    def lag(self) -> tuple[float, ...]: ...
    @property
    def round_tail(self) -> bool: ...
    @property
    def tip_gap(self) -> tuple[float, ...]: ...
    @property
    def widest_by_depth(self) -> tuple[float, ...]: ...
    @property
    def widest_per_half(self) -> float: ...

class LawPrior:
    """
    Laws that are known beforehand: laws is the mean.

    rows (k, n): each, over the coefficients of lag, tip_gap and half_width (their constant, 0, left out) and
    widest_per_half, gives a standard normal number of what they differ from it.
    """
    def __copy__(self) -> LawPrior: ...
    def __deepcopy__(self, memo: dict) -> LawPrior: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        laws: MarkLaws,
        rows: collections.abc.Sequence[collections.abc.Sequence[float]],
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...

class Machine:
    """
    How a machine takes the tool elsewhere than it was commanded.

    Commanded to (x, y) from MarkFit.centre_mm and depth d it goes to x' = scale_x x + skew y + lean_x d, y' = scale_y y + lean_y d,
    is tilt_x x + tilt_y y deeper, and on each axis stays behind by half its backlash. A smooth field takes it elsewhere
    still: field_mm (2, 3), a, b and c of a u^2 + b u v + c v^2 for x and for y, u and v how far it was commanded to go from
    field_middle_mm, over field_reach_mm.
    """
    def __copy__(self) -> Machine: ...
    def __deepcopy__(self, memo: dict) -> Machine: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def backlash_mm(self) -> tuple[float, ...]: ...
    @property
    def field_middle_mm(self) -> tuple[float, ...]: ...
    @property
    def field_mm(self) -> tuple[tuple[float, ...], ...]: ...
    @property
    def field_reach_mm(self) -> tuple[float, ...]: ...
    @property
    def lean_mm_per_mm(self) -> tuple[float, ...]: ...
    @property
    def scale(self) -> tuple[float, ...]: ...
    @property
    def skew(self) -> float: ...
    @property
    def tilt_mm_per_mm(self) -> tuple[float, ...]: ...

class MarkOptions:
    """
    How marks are fitted; lengths in mm.

    deepest_mm: the laws hold on [0, deepest]. lag_terms, tip_gap_terms, half_width_terms: numbers per law, at most four.
    widest_per_half, front_per_half, height_mm: Prior; laws: LawPrior or None. placement_mm, turn_rad, displacement_mm: sigmas of the sheet's shift
    and turn, and of each mark's own displacement; 0: none. lean_mm_per_mm, axes, tilt_mm_per_mm, backlash_mm, field_mm:
    sigmas of the machine's numbers; 0: it has no such error. departing: laws get more numbers if the marks ask for it. noise_mm: fit
    nothing, say what to expect of such edges.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    departing: bool
    front_per_half: Prior
    height_mm: Prior
    laws: LawPrior | None
    round_tail: bool
    widest_per_half: Prior
    def __copy__(self) -> MarkOptions: ...
    def __deepcopy__(self, memo: dict) -> MarkOptions: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __init__(self) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def axes(self) -> float: ...
    @axes.setter
    def axes(self, arg0: float) -> None: ...
    @property
    def backlash_mm(self) -> float: ...
    @backlash_mm.setter
    def backlash_mm(self, arg0: float) -> None: ...
    @property
    def deepest_mm(self) -> float: ...
    @deepest_mm.setter
    def deepest_mm(self, arg0: float) -> None: ...
    @property
    def displacement_mm(self) -> float: ...
    @displacement_mm.setter
    def displacement_mm(self, arg0: float) -> None: ...
    @property
    def field_mm(self) -> float: ...
    @field_mm.setter
    def field_mm(self, arg0: float) -> None: ...
    @property
    def half_width_terms(self) -> int: ...
    @half_width_terms.setter
    def half_width_terms(self, arg0: int) -> None: ...
    @property
    def lag_terms(self) -> int: ...
    @lag_terms.setter
    def lag_terms(self, arg0: int) -> None: ...
    @property
    def lean_mm_per_mm(self) -> float: ...
    @lean_mm_per_mm.setter
    def lean_mm_per_mm(self, arg0: float) -> None: ...
    @property
    def most_iterations(self) -> int: ...
    @most_iterations.setter
    def most_iterations(self, arg0: int) -> None: ...
    @property
    def noise_length_mm(self) -> float: ...
    @noise_length_mm.setter
    def noise_length_mm(self, arg0: float) -> None: ...
    @property
    def noise_mm(self) -> float | None: ...
    @noise_mm.setter
    def noise_mm(self, arg0: float | None) -> None: ...
    @property
    def placement_mm(self) -> float: ...
    @placement_mm.setter
    def placement_mm(self, arg0: float) -> None: ...
    @property
    def spacing_mm(self) -> float: ...
    @spacing_mm.setter
    def spacing_mm(self, arg0: float) -> None: ...
    @property
    def tilt_mm_per_mm(self) -> float: ...
    @tilt_mm_per_mm.setter
    def tilt_mm_per_mm(self, arg0: float) -> None: ...
    @property
    def tip_gap_terms(self) -> int: ...
    @tip_gap_terms.setter
    def tip_gap_terms(self, arg0: int) -> None: ...
    @property
    def turn_rad(self) -> float: ...
    @turn_rad.setter
    def turn_rad(self, arg0: float) -> None: ...

class MarkResidual:
    """
    One painted mark against its prediction.
    """
    def __copy__(self) -> MarkResidual: ...
    def __deepcopy__(self, memo: dict) -> MarkResidual: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def displacement_mm(self) -> tuple[float, ...]: ...
    @property
    def distance_mm(self) -> tuple[float, ...]: ...
    @property
    def outlier(self) -> bool: ...
    @property
    def point_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def rms_mm(self) -> float: ...
    @property
    def way_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...

class MarkFit:
    """
    A brush fitted to marks.

    covariance: over the coefficients of lag, tip_gap and half_width (without the constant 0 of both), widest_per_half,
    front_per_half (of widest_by_depth and front_by_depth, where the ratios change with depth), height, shift x and y, turn;
    where any of the machine was requested lean x and y, scale x and y, skew, tilt x and y, backlash x and y and the field's six.
    """
    def __copy__(self) -> MarkFit: ...
    def __deepcopy__(self, memo: dict) -> MarkFit: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    @property
    def centre_mm(self) -> tuple[float, ...]: ...
    @property
    def converged(self) -> bool: ...
    @property
    def covariance(self) -> tuple[tuple[float, ...], ...]: ...
    @property
    def effective_samples(self) -> float: ...
    @property
    def height_mm(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def laws(self) -> MarkLaws: ...
    @property
    def left_aside(self) -> float: ...
    @property
    def machine(self) -> Machine: ...
    @property
    def marks(self) -> tuple[MarkResidual, ...]: ...
    @property
    def noise_mm(self) -> float: ...
    @property
    def remarks(self) -> tuple[str, ...]: ...
    @property
    def samples(self) -> float: ...
    @property
    def shift_mm(self) -> tuple[float, ...]: ...
    @property
    def slim(self) -> float: ...
    @property
    def turn_rad(self) -> float: ...

def area(rings: collections.abc.Sequence[numpy.typing.ArrayLike]) -> float:
    """
    Area [mm^2], clockwise rings, which are holes, taken off: negative where they outweigh.
    """

def as_normal(t: numpy.typing.ArrayLike, degrees_of_freedom: float) -> typing.Any:
    """
    Size of a normal value as unlikely as t with so many degrees of freedom; of each t, where there are many.
    """

def bristle_coefficients(sliding_end: str) -> numpy.typing.NDArray[numpy.float64]:
    """
    c1 to c4 of w = c1 + c2 z + (c3 + c4 z) e^z + z^2/2, Lemma 1 with EI = load = exp(1 - z).
    """

def bristle_deflection(
    coefficients: numpy.typing.ArrayLike, z: numpy.typing.ArrayLike
) -> typing.Any:
    """
    w(z) for these coefficients, article (3) as it should read.
    """

def check(brush: Brush) -> None:
    """
    Error when the brush would lead a robot astray (negative lag, laws and outlines that disagree, ...).
    """

def clearance(
    rings: collections.abc.Sequence[numpy.typing.ArrayLike],
    points: numpy.typing.ArrayLike,
) -> list[float]:
    """
    Distance [mm] of points (n, 2) from the outline, on whichever side of it.
    """

def common_area(
    painted: collections.abc.Sequence[PassMarks],
    wanted: collections.abc.Sequence[Stroke],
    brush: Brush,
) -> CommonArea:
    """
    What passes of marks and the strokes they should be have in common, counted in pixels: a CommonArea.
    """

def common_areas(
    painted: collections.abc.Sequence[PassMarks],
    wanted: collections.abc.Sequence[Stroke],
    groups: collections.abc.Sequence[collections.abc.Sequence[int]],
    brush: Brush,
) -> list[CommonArea]:
    """
    The same of each of some groups, lists of numbers as touching() gives them: a CommonArea each.
    """

def compensate(
    strokes: collections.abc.Sequence[Stroke],
    brush: Brush,
    sheet_mm: collections.abc.Sequence[float] | None,
    method: str = "closed",
    tolerance_mm: float = 0.05,
    lag_mm: float | None = None,
    speed_mm_s: float = 20.0,
    progress: collections.abc.Callable[[int, int], object] | None = None,
    few_poses: bool = True,
    start: str = "pointed",
    end: str = "round",
) -> Compensated:
    """
    Where the TCP must go for the paint to land on the strokes' middle lines: a Compensated.

    sheet_mm: (w, h), kept in the plan; None: of no sheet, to look at. method: "none", the TCP on the line; "constant",
    ahead by lag_mm (None: the lag at each stroke's median depth); "closed", the inverse of the brush's law; "refined", from there on by least squares until
    the outline of the mark fits the target best, kept where it overlaps better. tolerance_mm: how far the widest
    point of the mark may be off the middle line once the brush is taut, between poses too; each pass is simulated and its
    tracking error returned ("refined" moves the middle on purpose). speed_mm_s: of painting, at most
    the brush's. progress: called with (strokes done, strokes). few_poses: closed only, no more poses than the tolerance
    asks for. start, end: closed and refined, the terminals of strokes that do not set them: "pointed", as the footprint is
    behind; "round", as it is in front, where a start is set down inside of the stroke, goes back to its beginning and turns
    over; "butt", straight, a narrower mark goes into one corner, along the cut and into the other; "auto", the one that
    suits the drawn end best.

    Error, naming the stroke, for widths or depths out of the brush's reach.
    """

def convex_hull(points: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
    """
    Convex hull of points (n, 2), counter-clockwise.
    """

@typing.overload
def coverage(
    marks: Marks,
    brush: Brush,
    window_mm: collections.abc.Sequence[float],
    px_per_mm: float,
) -> numpy.typing.NDArray[numpy.float32]:
    """
    Painted fraction of every pixel, float32, row 0 at the top; window = (x, y, width, height) [mm].
    """

@typing.overload
def coverage(
    rings: collections.abc.Sequence[numpy.typing.ArrayLike],
    window_mm: collections.abc.Sequence[float],
    px_per_mm: float,
) -> numpy.typing.NDArray[numpy.float32]:
    """
    The same for filled rings, non-zero winding.
    """

def coverage_of_pieces(
    convex_rings: collections.abc.Sequence[numpy.typing.ArrayLike],
    window_mm: collections.abc.Sequence[float],
    px_per_mm: float,
) -> numpy.typing.NDArray[numpy.float32]:
    """
    The same for the union of convex counter-clockwise rings, which may overlap.
    """

def deviations_of_95(degrees_of_freedom: float | None = None) -> float:
    """
    Half of a 95 % interval in standard deviations: Student's t, or normal where no degrees of freedom are known.
    """

def excess_turning(
    mark: collections.abc.Sequence[numpy.typing.ArrayLike],
    wanted: collections.abc.Sequence[numpy.typing.ArrayLike],
) -> float:
    """
    How much more the outlines of a mark turn than those of the target, in full turns; each as a polygon within 0.1 mm.
    """

def fill(
    outlines: collections.abc.Sequence[numpy.typing.ArrayLike], rule: str = "nonzero"
) -> list[numpy.typing.NDArray[numpy.float64]]:
    """
    Rings of the shape that closed outlines fill; they may cross and turn either way.
    """

def first_crossings(
    rings: collections.abc.Sequence[numpy.typing.ArrayLike],
    places: numpy.typing.ArrayLike,
    ways: numpy.typing.ArrayLike,
) -> list[float]:
    """
    How far ahead [mm] of each place (n, 2), along the unit vector in its row of ways (n, 2), the outline of rings is first crossed; infinite where it is not. Error where there are not as many ways as places.
    """

def fit_curve(
    line: numpy.typing.ArrayLike, tolerance_mm: float, closed: bool = False
) -> tuple[numpy.typing.NDArray[numpy.float64], list[tuple[float, float]]]:
    """
    Few cubics (n, 8) along the points (k, 3) of x, y, half width [mm], and the half widths along them
    [(fraction of arc length, mm)], within the tolerance.
    """

def fit_law(
    depth_mm: collections.abc.Sequence[float],
    value_mm: collections.abc.Sequence[float],
    shape: LawShape,
    scatter: collections.abc.Sequence[float] = [],
) -> LawFit:
    """
    Law of a shape through measured values [mm] at depths [mm], by least squares or absolute residuals. scatter: of each value, up to a common factor; empty: alike.
    """

def fit_marks(
    marks: collections.abc.Sequence[PaintedMark],
    start: MarkLaws | None = None,
    options: MarkOptions = ...,
) -> MarkFit:
    """
    Laws from painted marks and the TCP's way that painted each, by robust least squares through the simulator.

    start: MarkLaws to begin from; without them lags of many lengths are tried. Error: no mark, numbers that are not finite,
    marks that no brush paints along these ways.
    """

def flatten(
    stroke: Stroke, tolerance_mm: float = 0.005
) -> numpy.typing.NDArray[numpy.float64]:
    """
    Middle line as (n, 4): x, y, arc length, half width [mm].
    """

def follow_lags(
    passes: collections.abc.Sequence[Pass],
    marks: collections.abc.Sequence[PassMarks],
    lags: collections.abc.Sequence[Profile],
    depth_range_mm: collections.abc.Sequence[float],
) -> list:
    """
    Follow the TCP of each pass with K other lags, at the rows of its marks.

    marks: PassMarks of each pass, simulated with one upright brush. lags: Profiles that are positive on depth_range_mm. For
    each pass: contacts [mm] and headings as unit vectors, (n, 2, K) each. In the air the contact is the TCP.

    Exact at each row, by the closed form.
    """

def footprint_at(
    table: FootprintTable, depth_mm: float, pull: float = 1.0
) -> numpy.typing.NDArray[numpy.float64]:
    """
    Outline (n, 2) [mm] at a depth [mm], tip at the origin; pull = r'/r blends pressed (0) and dragged (1).
    """

def from_angles(
    alpha0: float,
    s_mm: collections.abc.Sequence[float],
    alpha: collections.abc.Sequence[float],
    beta: collections.abc.Sequence[float] = [],
    lines: Lines = ...,
) -> dict:
    """
    Lag and tip gap [mm] from angles [rad] after distances s [mm] of a straight drag (article (19) to (23)).
    """

def interrupted(
    a_pass: Pass,
    brush: Brush,
    first_mm: float,
    every_mm: float,
    backtrack_mm: float = 5.0,
) -> list[Pass]:
    """
    A pass in parts, between which the brush is lifted to fetch paint.

    first_mm: path of the TCP that the paint on the brush still lasts; every_mm: that it lasts after each visit; each part
    begins backtrack_mm back in the mark of the one before, so that no gap shows. Parts are named stroke, stroke+2, ...
    Error for a paint that lasts no more than twice the backtrack.
    """

def intersect(
    rings_a: collections.abc.Sequence[numpy.typing.ArrayLike],
    rings_b: collections.abc.Sequence[numpy.typing.ArrayLike],
) -> list[numpy.typing.NDArray[numpy.float64]]:
    """
    What two shapes have in common, each given as for unite.
    """

def medial_axis(
    rings: collections.abc.Sequence[numpy.typing.ArrayLike],
    least_share: float,
    least_limb: float | None = None,
) -> tuple[numpy.typing.NDArray[numpy.float64], list[AxisBranch]]:
    """
    Medial axis of a shape: nodes (n, 4) with x, y, distance to the outline [mm] and the largest corner dropped there
    [squares of that distance], and branches between them, each with start, end (node numbers), line (k, 3) and part (rings).

    rings: as `fill` returns them. least_share: what a branch must add to the disc it leaves, in squares of the radius; it
    stays, too, if what is beyond some place on it adds as much to the disc there, and least_limb to the disc it leaves.
    """

def narrow(
    marks: Marks,
    paint: Paint,
    dips_mm: collections.abc.Sequence[collections.abc.Sequence[float]],
) -> None:
    """
    Fills width_share of every pass, as paint runs out along them: before trace_outlines and coverage.

    dips_mm: for each pass the ways [mm] of the TCP along it at which paint was just fetched, ascending: [0] before it, [] goes
    on with the paint of the pass before.
    """

def overlap(
    rings_a: collections.abc.Sequence[numpy.typing.ArrayLike],
    rings_b: collections.abc.Sequence[numpy.typing.ArrayLike],
) -> float:
    """
    Area of the intersection over area of the union, each given as for unite; 1 when both are empty.
    """

def painted_bounds(pass_marks: PassMarks, brush: Brush) -> list[float]:
    """
    Left, bottom, right, top [mm] of everything one pass paints.
    """

def read_brush(text: str) -> Brush:
    """
    brush.json; Error names the key.
    """

def read_marks(text: str) -> Marks:
    """
    marks.json; Error names the key.
    """

def read_plan(text: str) -> Plan:
    """
    plan.json; Error names the key.
    """

def refuse_tilted(passes: collections.abc.Sequence[Pass], upright: str) -> None:
    """
    Error for the first pass whose brush is not upright everywhere.

    upright: who keeps it upright, as the sentence begins: "cell ur5e holds the brush upright".
    """

def remarks(brush: Brush) -> list[Notice]:
    """
    What is odd about an admissible brush: notices about its laws.
    """

def search_strokes(
    shapes: collections.abc.Sequence[
        tuple[
            collections.abc.Sequence[numpy.typing.ArrayLike],
            collections.abc.Sequence[Stroke],
            collections.abc.Sequence[Pass],
        ]
    ],
    brush: Brush,
    detail: str = "normal",
    are_free: bool = True,
) -> list[
    tuple[
        list[list[Stroke]],
        list[bool],
        list[
            tuple[
                Stroke,
                int,
                list[numpy.typing.NDArray[numpy.float64]],
                list[numpy.typing.NDArray[numpy.float64]],
            ]
        ],
    ]
]:
    """
    The strokes by which the mark of each shape costs least: for each (strokes, changed, added).

    shapes: (rings of the shape, strokes, the passes that paint them). detail: "draft", "normal" or "fine", how small an area
    gets a stroke of its own. are_free: whether strokes may be moved, cut or left out, and not only added. strokes: for each that was
    given what it is best painted as, [] for not at all; changed: whether that differs; added: (stroke, number of the stroke
    that is nearest, rings of the area that it is for, rings of what it paints).
    """

def simulate(
    plan: Plan,
    brush: Brush,
    tolerance_mm: float = 0.02,
    for_outlines: bool = True,
    progress: collections.abc.Callable[[int, int], object] | None = None,
    *,
    may_rise: bool = False,
) -> Marks:
    """
    What the brush does along a plan: Marks without outlines (see trace_outlines and coverage).

    tolerance_mm: how far the painted area between two rows may be off the hull of both; it has nothing to do with the
    tolerance that a plan was made with. for_outlines: False leaves out the rows that only the outline needs: enough for
    widest_points. progress: called with (passes done, passes).

    z = -depth. A pass that begins or ends below 0 is set down or lifted on the spot, with rows of its own: pose_rows of the
    PassMarks finds the poses. may_rise: the passes are motions of a machine that may leave the paper, z > 0; there the brush
    hangs free. Error for z > 0 otherwise, for a pass all of which is above the paper, and for a pose deeper than the brush may
    be pressed.
    """

def thin_out(pass_: Pass, brush: Brush, tolerance_mm: float = 0.05) -> Pass:
    """
    The pass with fewer poses, its mark's middle and edges within the tolerance of where they were.
    """

def thorns(
    mark: collections.abc.Sequence[numpy.typing.ArrayLike],
    wanted: collections.abc.Sequence[numpy.typing.ArrayLike],
) -> int:
    """
    How many corners of a mark's outlines beyond 20 degrees stick out of the target by more than 0.3 mm; each outline as a polygon within 0.05 mm, target given as for unite.
    """

def touching(wanted: collections.abc.Sequence[Stroke]) -> list[list[int]]:
    """
    Numbers of strokes whose target marks touch, a list per letter; those that stand alone are not named.
    """

def trace_outlines(
    marks: Marks,
    brush: Brush,
    progress: collections.abc.Callable[[int, int], object] | None = None,
) -> None:
    """
    Fills outline_mm of every pass and of the whole.
    """

def tracking_error_of(
    pass_: Pass, stroke: Stroke, brush: Brush, tolerance_mm: float = 0.05
) -> TrackingError:
    """
    Miss of one pass against the stroke it should paint, by simulating it.
    """

def tracking_errors_of(
    passes: collections.abc.Sequence[Pass],
    strokes: collections.abc.Sequence[Stroke],
    brush: Brush,
    tolerance_mm: float = 0.05,
) -> list[TrackingError]:
    """
    The same of passes and strokes in turn, on all processors: a Miss each.
    """

def uncovered_areas(
    shapes: collections.abc.Sequence[
        tuple[
            collections.abc.Sequence[numpy.typing.ArrayLike],
            collections.abc.Sequence[Stroke],
            collections.abc.Sequence[Pass],
        ]
    ],
    brush: Brush,
    least_share: float,
) -> list[list[tuple[list[numpy.typing.NDArray[numpy.float64]], list[float], float]]]:
    """
    The areas of each shape that its passes leave without paint, from a share of the shape on, the largest first.

    shapes: as for search_strokes. For each a list of (rings [mm], (x, y) in it [mm], area [mm2]).
    """

def unite(
    rings: collections.abc.Sequence[numpy.typing.ArrayLike],
) -> list[numpy.typing.NDArray[numpy.float64]]:
    """
    Union of shapes: counter-clockwise rings fill, the clockwise rings behind one are its holes. Error where clockwise ones outweigh.
    """

def verdicts(
    painted: collections.abc.Sequence[PassMarks],
    wanted: collections.abc.Sequence[Stroke],
    brush: Brush,
) -> list[Verdict]:
    """
    How well each pass of marks paints the stroke it should be: a Verdict each, on all processors.
    """

def wanted_coverage(
    wanted: collections.abc.Sequence[Stroke],
    window_mm: collections.abc.Sequence[float],
    px_per_mm: float,
) -> numpy.typing.NDArray[numpy.float32]:
    """
    What strokes should cover of every pixel, float32, row 0 at the top; window = (x, y, width, height) [mm].
    """

def wanted_outline(
    stroke: Stroke, tolerance_mm: float = 0.005
) -> list[numpy.typing.NDArray[numpy.float64]]:
    """
    Rings of the target mark: the path with its width, round caps and round joins.
    """

def wanted_pieces(
    stroke: Stroke, tolerance_mm: float = 0.005
) -> list[numpy.typing.NDArray[numpy.float64]]:
    """
    Convex rings whose union is the path with its width and round caps; no wanted_mm is looked at.
    """

def widest_points(
    pass_marks: PassMarks, brush: Brush
) -> numpy.typing.NDArray[numpy.float64]:
    """
    Centre of the widest section at every row (n, 2) [mm].
    """

def write_brush(brush: Brush) -> str:
    """
    The text of a brush.json.
    """

def write_marks(marks: Marks) -> str:
    """
    The text of a marks.json.
    """

def write_plan(plan: Plan) -> str:
    """
    The text of a plan.json.
    """

MOST_ENTRIES: int = 10000000
__version__: str = "0.1.0"
