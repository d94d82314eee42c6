"""
Simulation of a brush, its inverse, and the marks that it paints.

Lengths are in mm, angles in radians, coordinates in the paper frame.
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
    "MAX_ENTRIES",
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
    "StrokeScore",
    "TrackingError",
    "WorstPlace",
    "area",
    "bristle_coefficients",
    "bristle_deflection",
    "check",
    "clearance",
    "common_area",
    "common_areas",
    "compensate",
    "convex_hull",
    "coverage",
    "excess_turning",
    "fill",
    "first_crossings",
    "fit_cubics",
    "fit_law",
    "fit_marks",
    "flatten",
    "follow_lags",
    "footprint_at",
    "from_angles",
    "group_touching",
    "intersect",
    "interval_factor_95",
    "lag",
    "medial_axis",
    "narrow",
    "normal_equivalent",
    "overlap",
    "painted_bounds",
    "read_brush",
    "read_marks",
    "read_plan",
    "refuse_tilted",
    "remarks",
    "score_strokes",
    "search_strokes",
    "simplify_pass",
    "simulate",
    "split_into_loads",
    "target_coverage",
    "target_outline",
    "thorns",
    "trace_outlines",
    "tracking_error_of",
    "tracking_errors_of",
    "uncovered_areas",
    "unite",
    "widest_points",
    "write_brush",
    "write_marks",
    "write_plan",
]

class Profile:
    """
    A law of a brush: one parameter [mm] against the press depth d [mm].

    The value is max(floor + floor_slope d, c0 + c1 d + ...). Profile([3.1, 0.86])(2.0) is 3.1 + 0.86 * 2 mm. The depth may
    be an array.

    coefficients: c0, c1, ..., in ascending powers of d, at most 11.
    floor, floor_slope: the lower limit of the value, linear in d.
    calibrated_mm: (least, greatest) depth that was measured; None if this is not known.
    source: where the law comes from, in words.
    assumed: True if the law was not measured.
    half_interval_95: half of the 95 % interval of each coefficient.
    rmse_mm: root mean square error of the fit.
    degrees_of_freedom: number of spare values from which the scatter is known.
    extra: unknown keys of the file, as JSON.

    A Profile cannot be changed; make a new one instead.
    """
    @typing.overload
    def __call__(self, depth_mm: float) -> float: ...  # type: ignore[overload-overlap]
    @typing.overload
    def __call__(self, depth_mm: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]: ...
    def __copy__(self) -> Profile: ...
    def __deepcopy__(self, memo: dict) -> Profile: ...
    def __eq__(self, other: object, /) -> bool: ...
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
    @typing.overload
    def extrapolated(self, depth_mm: float) -> float: ...  # type: ignore[overload-overlap]
    @typing.overload
    def extrapolated(self, depth_mm: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]: ...
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
        Depths [mm] at which the law is defined; None: at any depth.

        For a law of a Brush, this is depth_range_mm of the Brush.
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
    The law by which marks narrow with the path painted since the last dip.

    After a path of s mm, marks are exp(-narrows_per_m s / 1000) times as wide. Paint(0.4).width_share(500) is exp(-0.2).
    The path is the path of the TCP on the paper.

    lasts_mm: path after which hairs run dry; None if this is not known.
    calibrated_mm: (least, greatest) path that was measured.
    source: where the law comes from, in words.
    assumed: True if the law was not measured.
    covariance: of narrows_per_m, and of lasts_mm if it is known; may be empty.
    degrees_of_freedom: number of spare values from which the scatter is known.
    extra: unknown keys of the file, as JSON.

    A Paint cannot be changed; make a new one instead.
    """
    def __copy__(self) -> Paint: ...
    def __deepcopy__(self, memo: dict) -> Paint: ...
    def __eq__(self, other: object, /) -> bool: ...
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
    def path_to_share_mm(self, share: float) -> float:
        """
        Return the path [mm] after which the width has fallen to a share.

        The share is of a freshly dipped brush's width. The path is infinite if the width never falls so far.
        """
    def width_share(self, way_mm: float) -> float:
        """
        Return the share of the width that is left after a path [mm].

        The share is of a freshly dipped brush's width.
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
    The outline of the contact patch at one depth.

    depth_mm: the depth [mm].
    outline_mm: the outline (n, 2) [mm], a simple, unclosed, counter-clockwise ring. Its first point is the tip at (0, 0),
        and x points towards the TCP.
    """
    def __copy__(self) -> Footprint: ...
    def __deepcopy__(self, memo: dict) -> Footprint: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __init__(self, depth_mm: float, outline_mm: numpy.typing.ArrayLike) -> None: ...
    @property
    def depth_mm(self) -> float: ...
    @property
    def outline_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...

class FootprintTable:
    """
    The outlines of a brush at several depths, in tuples, with ascending depths.

    dragged: outlines while the brush is drawn along.
    pressed: outlines of a brush pressed straight down; () if they equal dragged.

    All outlines have the same number of points. At other depths, the outlines are blended point by point.
    """
    def __copy__(self) -> FootprintTable: ...
    def __deepcopy__(self, memo: dict) -> FootprintTable: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __init__(
        self, dragged: collections.abc.Sequence[Footprint] = [], pressed: collections.abc.Sequence[Footprint] = []
    ) -> None: ...
    @property
    def dragged(self) -> tuple[Footprint, ...]: ...
    @property
    def pressed(self) -> tuple[Footprint, ...]: ...

class Brush:
    """
    A brush: four laws against depth, and the footprints.

    All lengths are in mm. Depths are in mm and increase downwards from first contact.

    lag, tip_gap, tip_to_widest, half_width: the laws. Each is a Profile that refuses depths that the brush cannot have.
    footprints: a FootprintTable.

    The outlines of the footprints determine what is painted, and the laws determine where the tool goes. Outlines and
    laws may differ by 0.5 mm.

    To make a brush, start with Brush() and set all laws, footprints, name and depth_range_mm. Or start with a copy of a
    known brush. Set each law, and the footprints, as a whole: these values cannot be changed. save_brush, simulate,
    compensate and convert refuse a brush that is not valid.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __copy__(self) -> Brush: ...
    def __deepcopy__(self, memo: dict) -> Brush: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __init__(self) -> None: ...
    def depth_for_half_width(self, half_width_mm: float, where: str = "") -> float:
        """
        Return the depth [mm] that paints a half width [mm]. A brush of one width has one depth: paint_depth_mm.

        where: the element that the error names.

        Raises Error, with the reachable range, if no depth paints this half width.
        """
    def half_width_range_mm(self) -> list[float]:
        """Return the (least, greatest) half width [mm] within depth_range_mm."""
    def is_rigid(self) -> bool:
        """Return whether the lag is 0 at all depths: a pen."""
    def lever_to_widest(self, depth_mm: float) -> float:
        """Return e(d) = x_w(d) - b(d) [mm], signed."""
    def width_follows_depth(self) -> bool:
        """Return whether half_width depends on depth."""
    @property
    def covariance(self) -> tuple[tuple[float, ...], ...]:
        """Covariance of all coefficients, in the order of the four laws; may be empty."""
    @covariance.setter
    def covariance(self, arg1: collections.abc.Sequence[collections.abc.Sequence[float]]) -> None: ...
    @property
    def depth_range_mm(self) -> tuple[float, float]:
        """(least, greatest) depth [mm] to which the brush may be pressed."""
    @depth_range_mm.setter
    def depth_range_mm(self, arg1: collections.abc.Sequence[float]) -> None: ...
    @property
    def extra(self) -> str:
        """JSON object of the unknown keys of the brush's file, written back as read."""
    @extra.setter
    def extra(self, arg0: str) -> None: ...
    @property
    def footprints(self) -> FootprintTable:
        """Outlines of the contact patch by depth: a FootprintTable."""
    @footprints.setter
    def footprints(self, arg1: FootprintTable) -> None: ...
    @property
    def half_width(self) -> Profile:
        """h(d): half of the footprint's greatest width. A Profile that never falls."""
    @half_width.setter
    def half_width(self, arg1: Profile) -> None: ...
    @property
    def kind(self) -> str:
        """
        Kind of the brush: round, liner, pen, or empty, which means round.

        A liner is a round brush with long bristles. Other kinds are refused.
        """
    @kind.setter
    def kind(self, arg0: str) -> None: ...
    @property
    def lag(self) -> Profile:
        """
        r(d): distance of the centre of friction behind the TCP, bristles taut.

        A Profile, 0 at all depths for a pen.
        """
    @lag.setter
    def lag(self, arg1: Profile) -> None: ...
    @property
    def max_speed_mm_s(self) -> float:
        """Greatest speed [mm/s] at which the model holds; the model has no inertia."""
    @max_speed_mm_s.setter
    def max_speed_mm_s(self, arg0: float) -> None: ...
    @property
    def name(self) -> str:
        """Name of the brush in plans and messages."""
    @name.setter
    def name(self, arg0: str) -> None: ...
    @property
    def paint(self) -> Paint | None:
        """How the mark narrows between two dips into paint: a Paint, or None."""
    @paint.setter
    def paint(self, arg1: Paint | None) -> None: ...
    @property
    def paint_depth_mm(self) -> float:
        """Painting depth [mm] if half_width does not depend on depth."""
    @paint_depth_mm.setter
    def paint_depth_mm(self, arg0: float) -> None: ...
    @property
    def sha256(self) -> str:
        """SHA-256 of the bytes of the file from which the brush was read, or empty."""
    @sha256.setter
    def sha256(self, arg0: str) -> None: ...
    @property
    def tip_gap(self) -> Profile:
        """
        b(d): distance from the tip of the footprint to the centre of friction.

        A Profile.
        """
    @tip_gap.setter
    def tip_gap(self, arg1: Profile) -> None: ...
    @property
    def tip_to_widest(self) -> Profile:
        """
        x_w(d): distance from the tip of the footprint to its widest section.

        A Profile.
        """
    @tip_to_widest.setter
    def tip_to_widest(self, arg1: Profile) -> None: ...

class Settings:
    """
    The brushsvg settings of an element in a drawing; None if a setting is absent.

    brush, end, order, passes, reload, skip, speed_mm_s, start, width_mm: see docs/reference/drawings.md.
    kind: kind of a stroke on the calibration chart.
    extra: unknown keys of a plan.json, as JSON.

    A Settings cannot be changed; use replaced() to make a new one.
    """
    def __copy__(self) -> Settings: ...
    def __deepcopy__(self, memo: dict) -> Settings: ...
    def __eq__(self, other: object, /) -> bool: ...
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
    def replaced(self, **fields: object) -> Settings:
        """Return a copy in which the given fields have these values."""
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
    The origin of a stroke in a drawing.

    element: id of the element.
    part: number of the element's sub-path, 0 for the only one.
    repeat: number of the repetition, if the stroke is painted several times.
    lane: number of the pass that fills a shape wider than the brush.
    load: number of the load of paint.
    name: element/part#repeat~lane+load, without the parts that have their default. The name is never parsed.
    """
    def __copy__(self) -> StrokeId: ...
    def __deepcopy__(self, memo: dict) -> StrokeId: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __init__(self, element: str, part: int = 0, repeat: int = 1, lane: int = 1, load: int = 1) -> None: ...
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
    A stroke: a middle line, with a width along it.

    id: name of the stroke, made from origin. Set it to a name or to a StrokeId.
    origin: a StrokeId.
    middle_mm: cubics (n, 8) [mm].
    half_width: half widths along the middle line [(fraction of arc length, mm)].
    target_mm: rings of the target mark as drawn, or empty.
    start_covered, end_covered: whether this end meets other strokes of the shape, whose paint covers the end.

    Set middle_mm, half_width, target_mm and settings as a whole.
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
        Make a stroke through points, in painting direction.

        The stroke is closed if the last point repeats the first one.

        points_mm: (n, 2) [mm], y up.
        width_mm: one width for all points, or (n,), one width at each point, linear in between.
        tolerance_mm: None: straight lines from point to point. Otherwise cubics that pass each point within the tolerance. The
            cubics are smooth except at corners that no smooth line follows. Points too far apart for the tolerance are
            joined by lines.

        Raises Error, naming the stroke, for fewer than two different points, or a width that is not positive. Also raises
        Error for a number that is not finite or beyond 1e6 mm.
        """
    def __copy__(self) -> Stroke: ...
    def __deepcopy__(self, memo: dict) -> Stroke: ...
    def __eq__(self, other: object, /) -> bool: ...
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
    def replaced(self, **fields: object) -> Stroke:
        """Return a copy in which the given fields have these values."""
    @property
    def half_width(self) -> tuple[tuple[float, float], ...]: ...
    @half_width.setter
    def half_width(self, arg1: collections.abc.Sequence[tuple[float, float]]) -> None: ...
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
    def target_mm(self) -> tuple[numpy.typing.NDArray[numpy.float64], ...]: ...
    @target_mm.setter
    def target_mm(self, arg1: collections.abc.Sequence[numpy.typing.ArrayLike]) -> None: ...

class Arc:
    """
    A stretch of a pass on a circle, at constant depth.

    first, last: indices of the first and the last pose on the circle.
    centre_mm: centre (x, y) of the circle.
    direction: 1 counter-clockwise, -1 clockwise.

    Neighbouring poses are less than 180 degrees apart on the circle.
    """
    def __copy__(self) -> Arc: ...
    def __deepcopy__(self, memo: dict) -> Arc: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __init__(self, first: int, last: int, centre_mm: tuple[float, float], direction: int) -> None: ...
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
    The motion for one stroke.

    stroke: name of the stroke that the pass paints, made from origin. Set it to a name or to a StrokeId.
    origin: a StrokeId.
    poses_mm: (n, 3): x, y, z = -depth [mm]. Moves between poses are straight, with linear depth. The array is read-only
        and not copied when you read it. Replace it as a whole.
    arcs: a tuple of Arc, ascending. Poses of an arc are followed on the true circle, not on its chords.
    speed_mm_s, layer, colour: of the pass.
    settings: a Settings. Set it as a whole.
    load: number of the load of paint within the stroke, from 1; 0 for a stroke that is not split.
    extra: unknown keys of the file, as JSON.
    tool_axes: (n, 3): for each pose the unit vector from the tip up along the brush, in the paper frame. The tilt is at
        most 30 degrees. Empty for an upright brush. Like poses_mm, read-only, and replaced as a whole.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    colour: str
    extra: str
    layer: str
    settings: Settings
    def __copy__(self) -> Pass: ...
    def __deepcopy__(self, memo: dict) -> Pass: ...
    def __eq__(self, other: object, /) -> bool: ...
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
    The TCP poses of all strokes, in the paper frame: plan.json as a value.

    brush, brush_sha256: name and file hash of the brush for which the plan was made.
    sheet_mm: (width, height).
    passes: a tuple with one Pass per stroke, in painting order. Set it as a whole.
    extra: unknown keys of the file, as JSON.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    brush: str
    brush_sha256: str
    extra: str
    def __copy__(self) -> Plan: ...
    def __deepcopy__(self, memo: dict) -> Plan: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __init__(
        self,
        brush: str = "",
        brush_sha256: str = "",
        sheet_mm: collections.abc.Sequence[float] = [0.0, 0.0],
        passes: collections.abc.Sequence[Pass] = [],
        extra: str = "{}",
    ) -> None: ...
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
    The motion of the contact patch in one pass, as parallel rows [mm, rad].

    The rows are read-only.

    pose: index of the plan's pose, with fractions between two poses. contact_mm[pose_rows] is the contact at each pose.
    lean_mm_per_mm: (n, 2), sideways distance of a tilted brush's axis for each mm up; empty for an upright brush.

    A pass that ends on the paper has rows after the last pose, where the brush is lifted on the spot. There the patch
    moves, because the bristles straighten. In the rows before the first pose, the brush is set down.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    stroke: str
    def __copy__(self) -> PassMarks: ...
    def __deepcopy__(self, memo: dict) -> PassMarks: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __init__(self) -> None: ...
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
    def outline_mm(self, arg1: collections.abc.Sequence[numpy.typing.ArrayLike]) -> None: ...
    @property
    def pose(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def pose_rows(self) -> numpy.typing.NDArray[numpy.int64]:
        """Index of the row of each pose."""
    @property
    def pull(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def taut(self) -> numpy.typing.NDArray[numpy.bool]: ...
    @property
    def tcp_mm(self) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def width_share(self) -> numpy.typing.NDArray[numpy.float64]:
        """Width as a share of a freshly dipped brush's width; empty: 1 in all rows."""

class Marks:
    """
    The marks that are painted: marks.json as a value.

    passes: a tuple with one PassMarks per stroke.
    outline_mm: a tuple of unclosed rings [(n, 2) mm] around all paint together, filled in by trace_outlines. Outer rings
        are counter-clockwise, holes are clockwise.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __copy__(self) -> Marks: ...
    def __deepcopy__(self, memo: dict) -> Marks: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __init__(self) -> None: ...
    @property
    def outline_mm(self) -> tuple[numpy.typing.NDArray[numpy.float64], ...]: ...
    @outline_mm.setter
    def outline_mm(self, arg1: collections.abc.Sequence[numpy.typing.ArrayLike]) -> None: ...
    @property
    def passes(self) -> tuple[PassMarks, ...]: ...
    @passes.setter
    def passes(self, arg1: collections.abc.Sequence[PassMarks]) -> None: ...

class AxisBranch:
    """
    A stretch of the medial axis between two nodes.

    start, end: indices of the nodes.
    line: (k, 3), places on the axis: x, y, distance to the outline [mm].
    part: rings of the part of the shape nearest to the branch.
    """
    def __copy__(self) -> AxisBranch: ...
    def __deepcopy__(self, memo: dict) -> AxisBranch: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
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
    The areas that paint and target mark have in common and together.

    intersection_mm2: area of the intersection [mm^2].
    union_mm2: area of the union [mm^2].
    overlap: intersection_mm2 / union_mm2; 1 if both are 0.
    """
    def __copy__(self) -> CommonArea: ...
    def __deepcopy__(self, memo: dict) -> CommonArea: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __init__(self, intersection_mm2: float, union_mm2: float) -> None: ...
    @property
    def intersection_mm2(self) -> float: ...
    @property
    def overlap(self) -> float: ...
    @property
    def union_mm2(self) -> float: ...

class WorstPlace:
    """
    The place where paint and drawing differ most.

    at_mm: the place (x, y).
    is_missing: True if paint is missing there, False if there is too much paint.
    area_mm2: area of the missing or excess paint.
    """
    def __copy__(self) -> WorstPlace: ...
    def __deepcopy__(self, memo: dict) -> WorstPlace: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    @property
    def area_mm2(self) -> float: ...
    @property
    def at_mm(self) -> tuple[float, ...]: ...
    @property
    def is_missing(self) -> bool: ...

class StrokeScore:
    """
    A score of how well a pass paints its stroke.

    overlap: area of the intersection over area of the union.
    width_error_mm: mean absolute difference of the widths across the line; None if no width can be measured.
    excess_turning: excess turning of the mark's outline, in full turns.
    worst: a WorstPlace.
    """
    def __copy__(self) -> StrokeScore: ...
    def __deepcopy__(self, memo: dict) -> StrokeScore: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
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
    Distance [mm] of a mark's widest point from the middle line of its stroke.

    The distance is measured from the first taut row to the last.

    largest_mm: the largest distance.
    at_mm: the place (x, y) of the largest distance.
    mean_mm: the mean distance over the painted length.
    within_tolerance: whether the largest distance is within the tolerance.
    has_turn_in_place: whether the brush turns in place, at a corner too sharp for the lever.
    """
    def __copy__(self) -> TrackingError: ...
    def __deepcopy__(self, memo: dict) -> TrackingError: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
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
    A plan with its tracking errors and warnings.

    plan: the Plan.
    tracking_errors: a TrackingError for each pass.
    warnings: notices about strokes.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __copy__(self) -> Compensated: ...
    def __deepcopy__(self, memo: dict) -> Compensated: ...
    def __eq__(self, other: object, /) -> bool: ...
    def spliced(self, other: Compensated, passes: collections.abc.Sequence[tuple[bool, int]]) -> Compensated:
        """
        Combine passes of this plan and another plan into one plan.

        other: the other Compensated.
        passes: (whether the pass is from the other plan, its index there) for each pass of the new plan, in order.
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
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Norm) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class LawShape:
    """
    Constraints on a law that is fitted.

    positive and rising hold at all depths of range_mm.
    """
    def __copy__(self) -> LawShape: ...
    def __deepcopy__(self, memo: dict) -> LawShape: ...
    def __eq__(self, other: object, /) -> bool: ...
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

class LawFit:
    """A fitted law, with its uncertainty and its residuals."""
    def __copy__(self) -> LawFit: ...
    def __deepcopy__(self, memo: dict) -> LawFit: ...
    def __eq__(self, other: object, /) -> bool: ...
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
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Lines) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class PaintedMark:
    """
    The mark that one pass painted, with the path of the TCP.

    stroke: id of the stroke.
    poses_mm: path of the TCP (n, 3), z = -depth.
    outline_mm: rings [(n, 2) mm] of the mark, including its holes.
    arcs: arcs of the pass, which the TCP follows on their circles.
    """
    def __copy__(self) -> PaintedMark: ...
    def __deepcopy__(self, memo: dict) -> PaintedMark: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __init__(
        self,
        stroke: str,
        poses_mm: numpy.typing.ArrayLike,
        outline_mm: collections.abc.Sequence[numpy.typing.ArrayLike],
        arcs: collections.abc.Sequence[Arc] = [],
    ) -> None: ...
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
    Prior knowledge of a number, as a normal distribution.

    value: the mean.
    sigma: the standard deviation. 0: the number is known; inf: nothing is known.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    def __copy__(self) -> Prior: ...
    def __deepcopy__(self, memo: dict) -> Prior: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __init__(self, value: float, sigma: float) -> None: ...
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
    Laws as coefficients (ascending powers of depth), and a footprint's shape.

    The footprint has the shape of a drop.
    """
    def __copy__(self) -> MarkLaws: ...
    def __deepcopy__(self, memo: dict) -> MarkLaws: ...
    def __eq__(self, other: object, /) -> bool: ...
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
    Prior knowledge of the laws.

    laws: the mean.
    rows: (k, n), over the coefficients of lag, tip_gap and half_width (their constant, 0, left out) and widest_per_half.
        Each row turns the difference of these numbers from the mean into a standard normal number.
    """
    def __copy__(self) -> LawPrior: ...
    def __deepcopy__(self, memo: dict) -> LawPrior: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __init__(self, laws: MarkLaws, rows: collections.abc.Sequence[collections.abc.Sequence[float]]) -> None: ...

class Machine:
    """
    The systematic errors of a machine's motion.

    The tool is commanded to (x, y), measured from MarkFit.centre_mm, and to the depth d. The machine moves the tool to

        x' = scale_x x + skew y + lean_x d
        y' = scale_y y + lean_y d

    and by tilt_x x + tilt_y y deeper. On each axis the tool stays behind by half of the backlash. A smooth field adds
    a u^2 + b u v + c v^2 [mm] to x and to y.

    field_mm: (2, 3), the numbers a, b and c for x and for y.
    field_middle_mm, field_reach_mm: u and v are the commanded distances from field_middle_mm, divided by
        field_reach_mm.
    """
    def __copy__(self) -> Machine: ...
    def __deepcopy__(self, memo: dict) -> Machine: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
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
    Options of fit_marks; lengths in mm.

    deepest_mm: the laws hold on [0, deepest_mm].
    lag_terms, tip_gap_terms, half_width_terms: number of coefficients of each law, at most four.
    widest_per_half, front_per_half, height_mm: a Prior each.
    laws: LawPrior or None.
    placement_mm, turn_rad: sigmas of the sheet's shift and turn; 0: none.
    displacement_mm: sigma of each mark's own displacement; 0: none.
    lean_mm_per_mm, axes, tilt_mm_per_mm, backlash_mm, field_mm: sigmas of the numbers of the Machine; 0: the machine does
        not have this error.
    departing: whether laws get more coefficients if the marks need them.
    noise_mm: noise of the edges. If given, nothing is fitted, and the result is the covariance to expect from these
        edges.
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
    def __init__(self) -> None: ...
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
    def max_iterations(self) -> int: ...
    @max_iterations.setter
    def max_iterations(self, arg0: int) -> None: ...
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
    """Deviation of one painted mark from its prediction."""
    def __copy__(self) -> MarkResidual: ...
    def __deepcopy__(self, memo: dict) -> MarkResidual: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
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

    covariance: of these numbers, in this order:
        the coefficients of lag, and of tip_gap and half_width (without the constant 0 of both);
        widest_per_half and front_per_half, or the coefficients of widest_by_depth and front_by_depth if the ratios change
        with depth;
        height, shift x and y, turn;
        if any number of the machine was requested: lean x and y, scale x and y, skew, tilt x and y, backlash x and y, and
        the six numbers of the field.
    """
    def __copy__(self) -> MarkFit: ...
    def __deepcopy__(self, memo: dict) -> MarkFit: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
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
    def machine(self) -> Machine: ...
    @property
    def marks(self) -> tuple[MarkResidual, ...]: ...
    @property
    def noise_mm(self) -> float: ...
    @property
    def outlier_share(self) -> float: ...
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
    Return the area of rings [mm^2].

    Clockwise rings are holes, and their area is subtracted. The area is negative if the holes outweigh the rest.
    """

def bristle_coefficients(sliding_end: str) -> numpy.typing.NDArray[numpy.float64]:
    """
    Return the coefficients c1 to c4 of a bristle's deflection, by Lemma 1.

    The deflection is w(z) = c1 + c2 z + (c3 + c4 z) e^z + z^2/2, for EI = load = exp(1 - z).

    sliding_end: "third_derivative" or "shear_free".
    """

def bristle_deflection(coefficients: numpy.typing.ArrayLike, z: numpy.typing.ArrayLike) -> typing.Any:
    """
    Return the deflection w(z) of a bristle with these coefficients.

    The equation is article (3), corrected. z may be an array.
    """

def check(brush: Brush) -> None:
    """
    Raise Error if the brush would make a robot go wrong.

    Examples are a negative lag, or laws and outlines that disagree.
    """

def clearance(rings: collections.abc.Sequence[numpy.typing.ArrayLike], points: numpy.typing.ArrayLike) -> list[float]:
    """Return the distance [mm] of points (n, 2) from the outline, on either side."""

def common_area(
    painted: collections.abc.Sequence[PassMarks], target: collections.abc.Sequence[Stroke], brush: Brush
) -> CommonArea:
    """
    Return the CommonArea of passes of marks and the strokes they should paint.

    The areas are counted in pixels.
    """

def common_areas(
    painted: collections.abc.Sequence[PassMarks],
    target: collections.abc.Sequence[Stroke],
    groups: collections.abc.Sequence[collections.abc.Sequence[int]],
    brush: Brush,
) -> list[CommonArea]:
    """
    Return a CommonArea for each group of strokes and their passes.

    groups: lists of indices, as group_touching() returns them.
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
    Compute a plan for the TCP that puts the paint on the strokes' middle lines.

    Returns a Compensated. Each pass is simulated, and its tracking error is returned.

    sheet_mm: (width, height), kept in the plan. None: the plan has no sheet and is only for viewing.
    method: how the plan is computed:
        "none": the TCP is on the middle line.
        "constant": the TCP is ahead by lag_mm.
        "closed": the inverse of the brush's laws.
        "refined": the closed plan, moved by least squares until the outline of the mark fits the target best. The refined
        plan is kept only if its mark overlaps the target better. Refining moves the middle of the mark on purpose.
    tolerance_mm: largest allowed distance of the mark's widest point from the middle line. The limit applies once the
        brush is taut, also between poses.
    lag_mm: constant only. None: the lag at each stroke's median depth.
    speed_mm_s: painting speed, at most the speed of the brush.
    progress: called with (strokes done, strokes).
    few_poses: closed only. Use no more poses than the tolerance needs.
    start, end: closed and refined only. Terminals of the strokes that do not set their own:
        "pointed": the shape of the footprint's rear.
        "round": the shape of the footprint's front. At a start, the brush is set down inside the stroke. Then it goes back
        to the stroke's beginning and turns over.
        "butt": straight. A narrower mark goes into one corner, along the cut and into the other corner.
        "auto": the terminal that suits the drawn end best.

    Raises Error, naming the stroke, for widths or depths that the brush cannot reach.
    """

def convex_hull(points: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
    """Return the convex hull of points (n, 2), counter-clockwise."""

@typing.overload
def coverage(
    marks: Marks, brush: Brush, window_mm: collections.abc.Sequence[float], px_per_mm: float
) -> numpy.typing.NDArray[numpy.float32]:
    """
    Return the painted fraction of each pixel, as float32 with row 0 at the top.

    window_mm: (x, y, width, height) [mm] of the part of the paper.
    """

@typing.overload
def coverage(
    rings: collections.abc.Sequence[numpy.typing.ArrayLike],
    window_mm: collections.abc.Sequence[float],
    px_per_mm: float,
) -> numpy.typing.NDArray[numpy.float32]:
    """
    Return the fraction of each pixel that filled rings cover, as float32.

    The rings are filled by the non-zero winding rule. Row 0 is at the top.

    window_mm: (x, y, width, height) [mm] of the part of the paper.
    """

def excess_turning(
    mark: collections.abc.Sequence[numpy.typing.ArrayLike], target: collections.abc.Sequence[numpy.typing.ArrayLike]
) -> float:
    """
    Return how much more a mark's outlines turn than the target's, in full turns.

    Each outline is replaced by a polygon within 0.1 mm.
    """

def fill(
    outlines: collections.abc.Sequence[numpy.typing.ArrayLike], rule: str = "nonzero"
) -> list[numpy.typing.NDArray[numpy.float64]]:
    """
    Return the rings of the shape that closed outlines fill.

    The outlines may cross and turn either way.

    rule: "nonzero" or "evenodd".
    """

def first_crossings(
    rings: collections.abc.Sequence[numpy.typing.ArrayLike],
    places: numpy.typing.ArrayLike,
    directions: numpy.typing.ArrayLike,
) -> list[float]:
    """
    Return how far ahead of each place the outline of rings is first crossed [mm].

    The distance is infinite if the outline is not crossed.

    places: (n, 2).
    directions: (n, 2), the unit vector from each place along which to look.

    Raises Error if there are not as many directions as places.
    """

def fit_cubics(
    line: numpy.typing.ArrayLike, tolerance_mm: float, closed: bool = False
) -> tuple[numpy.typing.NDArray[numpy.float64], list[tuple[float, float]]]:
    """
    Fit few cubics and half widths to a line of points, within a tolerance.

    Returns the cubics (n, 8) [mm] and the half widths along them [(fraction of arc length, mm)].

    line: points (k, 3): x, y, half width [mm].
    tolerance_mm: largest distance from the points.
    closed: whether the last point repeats the first one.
    """

def fit_law(
    depth_mm: collections.abc.Sequence[float],
    value_mm: collections.abc.Sequence[float],
    shape: LawShape,
    scatter: collections.abc.Sequence[float] = [],
) -> LawFit:
    """
    Fit a law to values [mm] measured at depths [mm].

    The fit minimises squares or absolute residuals.

    shape: a LawShape, the constraints on the law.
    scatter: scatter of each value, up to a common factor. Empty: all values scatter alike.
    """

def fit_marks(
    marks: collections.abc.Sequence[PaintedMark], start: MarkLaws | None = None, options: MarkOptions = ...
) -> MarkFit:
    """
    Fit laws to painted marks and to the TCP paths that painted them.

    The fit is by robust least squares through the simulator.

    marks: a PaintedMark for each pass.
    start: MarkLaws at which the fit begins. None: lags of many lengths are tried.
    options: MarkOptions.

    Raises Error if there is no mark, for numbers that are not finite, and for marks that no brush paints along these
    paths.
    """

def flatten(stroke: Stroke, tolerance_mm: float = 0.005) -> numpy.typing.NDArray[numpy.float64]:
    """Return the middle line as points (n, 4): x, y, arc length, half width [mm]."""

def follow_lags(
    passes: collections.abc.Sequence[Pass],
    marks: collections.abc.Sequence[PassMarks],
    lags: collections.abc.Sequence[Profile],
    depth_range_mm: collections.abc.Sequence[float],
) -> list:
    """
    Follow the TCP of each pass with K other lags, at the rows of its marks.

    Returns for each pass the contacts [mm] and the headings as unit vectors, (n, 2, K) each. In the air, the contact is the
    TCP. The result is exact at each row, by the closed form.

    marks: PassMarks of each pass, simulated with one upright brush.
    lags: K Profiles that are positive on depth_range_mm.
    """

def footprint_at(table: FootprintTable, depth_mm: float, pull: float = 1.0) -> numpy.typing.NDArray[numpy.float64]:
    """
    Return the outline (n, 2) [mm] at a depth [mm], with the tip at the origin.

    pull: r'/r, which blends the pressed (0) and the dragged outline (1).
    """

def from_angles(
    alpha0: float,
    s_mm: collections.abc.Sequence[float],
    alpha: collections.abc.Sequence[float],
    beta: collections.abc.Sequence[float] = [],
    lines: Lines = ...,
) -> dict:
    """
    Compute lag and tip gap [mm] from the angles of a straight drag.

    The equations are article (19) to (23).

    alpha0, alpha, beta: angles [rad].
    s_mm: distances of the drag after which alpha and beta were measured.
    """

def group_touching(target: collections.abc.Sequence[Stroke]) -> list[list[int]]:
    """
    Group the strokes whose target marks touch: one list per letter.

    Each list contains the indices of the strokes. A stroke that touches no other stroke is not listed.
    """

def intersect(
    rings_a: collections.abc.Sequence[numpy.typing.ArrayLike], rings_b: collections.abc.Sequence[numpy.typing.ArrayLike]
) -> list[numpy.typing.NDArray[numpy.float64]]:
    """Return the intersection of two shapes, each given as for unite."""

def interval_factor_95(degrees_of_freedom: float | None = None) -> float:
    """
    Return half of a 95 % interval, in standard deviations.

    The interval is of Student's t, or of the normal distribution if degrees_of_freedom is None.
    """

def medial_axis(
    rings: collections.abc.Sequence[numpy.typing.ArrayLike], min_share: float, min_limb_share: float | None = None
) -> tuple[numpy.typing.NDArray[numpy.float64], list[AxisBranch]]:
    """
    Return the medial axis of a shape: its nodes and the branches between them.

    nodes: (n, 4): x, y, distance to the outline [mm], and the largest corner dropped at the node, in squares of the
        distance.
    branches: a list of AxisBranch, each with start and end (indices of nodes), line (k, 3) and part (rings).

    rings: a shape as `fill` returns it.
    min_share: the least area that a branch must add to the disc from which it starts, in squares of the disc's radius.
    min_limb_share: a branch also stays if the part beyond some place on the branch adds min_share to the disc at this
        place. The part must also add min_limb_share to the disc from which the branch starts. None: equal to min_share.
    """

def narrow(marks: Marks, paint: Paint, dips_mm: collections.abc.Sequence[collections.abc.Sequence[float]]) -> None:
    """
    Fill in width_share of each pass, as the paint runs out along the passes.

    Call this function before trace_outlines and coverage.

    dips_mm: for each pass, the distances [mm] along the TCP's path at which paint was just fetched, ascending. [0]: just
        before the pass. []: the pass continues with the paint of the previous pass.
    """

def normal_equivalent(t: numpy.typing.ArrayLike, degrees_of_freedom: float) -> typing.Any:
    """
    Return the size of a normal value that is as unlikely as Student's t.

    t: a value, or an array of values.
    """

def overlap(
    rings_a: collections.abc.Sequence[numpy.typing.ArrayLike], rings_b: collections.abc.Sequence[numpy.typing.ArrayLike]
) -> float:
    """
    Return the area of the intersection of two shapes over the area of their union.

    The result is 1 if both shapes are empty. Each shape is given as for unite.
    """

def painted_bounds(pass_marks: PassMarks, brush: Brush) -> list[float]:
    """Return left, bottom, right and top [mm] of all that one pass paints."""

def read_brush(text: str) -> Brush:
    """Read a brush from the text of brush.json. Raises Error, naming the key."""

def read_marks(text: str) -> Marks:
    """Read marks from the text of marks.json. Raises Error, naming the key."""

def read_plan(text: str) -> Plan:
    """Read a plan from the text of plan.json. Raises Error, naming the key."""

def refuse_tilted(passes: collections.abc.Sequence[Pass], upright: str) -> None:
    """
    Raise Error for the first pass whose brush is not upright at all poses.

    upright: the beginning of the error's sentence, which says what keeps the brush upright. An example is "cell ur5e holds
        the brush upright".
    """

def remarks(brush: Brush) -> list[Notice]:
    """Return notices about unusual laws of a brush that check() accepts."""

def score_strokes(
    painted: collections.abc.Sequence[PassMarks], target: collections.abc.Sequence[Stroke], brush: Brush
) -> list[StrokeScore]:
    """
    Score how well each pass of marks paints its stroke.

    Returns a StrokeScore for each pass, computed on all processors.
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
        list[tuple[Stroke, int, list[numpy.typing.NDArray[numpy.float64]], list[numpy.typing.NDArray[numpy.float64]]]],
    ]
]:
    """
    Search for the strokes with which the mark of each shape costs least.

    Returns (strokes, changed, added) for each shape:
        strokes: for each given stroke, the strokes that paint it best; [] if it is best left out.
        changed: for each given stroke, whether these strokes differ from the given stroke.
        added: (stroke, index of the nearest stroke, rings of the area that the stroke is for, rings of its paint) for each
        added stroke.

    shapes: (rings of the shape, strokes, passes that paint the strokes) for each shape.
    detail: "draft", "normal" or "fine": how small an area gets its own stroke.
    are_free: True if strokes may also be moved, cut or left out. False: strokes are only added.
    """

def simplify_pass(pass_: Pass, brush: Brush, tolerance_mm: float = 0.05) -> Pass:
    """
    Simplify a pass: return a pass with fewer poses.

    The middle and the edges of the mark stay within the tolerance [mm] of where they were.
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
    Simulate the brush along a plan.

    Returns Marks without outlines. To fill in the outlines, use trace_outlines; for a picture, use coverage.

    z = -depth. If a pass begins or ends below 0, the brush is set down or lifted on the spot, in rows of its own. To find
    the rows of the poses, use pose_rows of the PassMarks.

    tolerance_mm: largest distance of the painted area between two rows from the hull of both. This tolerance is independent
        of the tolerance with which the plan was made.
    for_outlines: False leaves out the rows that only the outline needs. The other rows are enough for widest_points.
    progress: called with (passes done, passes).
    may_rise: True if the passes are motions of a machine that may leave the paper (z > 0). There the brush hangs free.

    Raises Error for z > 0 without may_rise, and for a pass entirely above the paper. Also raises Error for a pose deeper
    than the brush may be pressed.
    """

def split_into_loads(
    a_pass: Pass, brush: Brush, first_mm: float, every_mm: float, backtrack_mm: float = 5.0
) -> list[Pass]:
    """
    Split a pass into parts, between which the brush is lifted to fetch paint.

    The parts are called stroke, stroke+2, ...

    first_mm: path of the TCP for which the paint on the brush still lasts.
    every_mm: path of the TCP for which the paint lasts after each refill.
    backtrack_mm: how far back in the mark of the previous part each part begins, so that no gap shows.

    Raises Error if the paint does not last for more than twice the backtrack.
    """

def target_coverage(
    target: collections.abc.Sequence[Stroke], window_mm: collections.abc.Sequence[float], px_per_mm: float
) -> numpy.typing.NDArray[numpy.float32]:
    """
    Return the fraction of each pixel that the strokes should cover, as float32.

    Row 0 is at the top.

    window_mm: (x, y, width, height) [mm] of the part of the paper.
    """

def target_outline(stroke: Stroke, tolerance_mm: float = 0.005) -> list[numpy.typing.NDArray[numpy.float64]]:
    """
    Return the rings of the target mark.

    The target mark is target_mm of the stroke, if given. Otherwise the target mark is the path with its width, round caps
    and round joins.
    """

def thorns(
    mark: collections.abc.Sequence[numpy.typing.ArrayLike], target: collections.abc.Sequence[numpy.typing.ArrayLike]
) -> int:
    """
    Count the corners of a mark that stick out of the target.

    Counted are corners of more than 20 degrees that stick out by more than 0.3 mm. Each outline is replaced by a polygon
    within 0.05 mm. The target is given as for unite.
    """

def trace_outlines(
    marks: Marks, brush: Brush, progress: collections.abc.Callable[[int, int], object] | None = None
) -> None:
    """Fill in outline_mm of each pass, and outline_mm of all marks together."""

def tracking_error_of(pass_: Pass, stroke: Stroke, brush: Brush, tolerance_mm: float = 0.05) -> TrackingError:
    """
    Return the TrackingError of a pass against the stroke that it should paint.

    The pass is simulated.
    """

def tracking_errors_of(
    passes: collections.abc.Sequence[Pass],
    strokes: collections.abc.Sequence[Stroke],
    brush: Brush,
    tolerance_mm: float = 0.05,
) -> list[TrackingError]:
    """
    Return a TrackingError for each pass, against the stroke with its index.

    Each pass is simulated, on all processors. Raises Error if there are not as many strokes as passes.
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
    min_share: float,
) -> list[list[tuple[list[numpy.typing.NDArray[numpy.float64]], list[float], float]]]:
    """
    Find the areas of each shape that its passes leave without paint.

    Returns for each shape a list of (rings [mm], a place (x, y) in the area [mm], area [mm2]), the largest area first.

    shapes: as for search_strokes.
    min_share: the least area, as a share of the shape's area.
    """

def unite(rings: collections.abc.Sequence[numpy.typing.ArrayLike]) -> list[numpy.typing.NDArray[numpy.float64]]:
    """
    Return the union of shapes.

    Each counter-clockwise ring is filled. The clockwise rings after it are its holes.

    Raises Error if the clockwise rings outweigh the others.
    """

def widest_points(pass_marks: PassMarks, brush: Brush) -> numpy.typing.NDArray[numpy.float64]:
    """Return the centre of the widest section at each row (n, 2) [mm]."""

def write_brush(brush: Brush) -> str:
    """Return the text of a brush.json."""

def write_marks(marks: Marks) -> str:
    """Return the text of a marks.json."""

def write_plan(plan: Plan) -> str:
    """Return the text of a plan.json."""

MAX_ENTRIES: int = 10000000
__version__: str = "0.1.0"
