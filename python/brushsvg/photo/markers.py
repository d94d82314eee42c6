"""ArUco markers in a photograph: found, their corners where straight lines through their edges meet, and the camera's
view of the sheet from them. Refuses pictures that cannot be measured in."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import cv2
import numpy as np

from ..errors import Error
from .photo import blur_px, grey_light, refuse_dark_paper, refuse_grainy, white_share

FEWEST = 3  # markers: two leave the tilt of the sheet open to the noise of their corners
SEEN_AT_PX = 2400  # longer side of the picture that markers are looked for in; their corners are found in the whole one
ALONG = np.linspace(0.08, 0.92, 31)  # of an edge of a marker, where it is looked across
ACROSS = 0.8  # modules to both sides: beyond one module there are other black ones
CORNER_PX = 0.15  # standard deviation of a corner
# Standard deviations of a lens's k1 and k2, at half the picture's diagonal: they hold what few markers leave open.
# Without k2 the middle of a page is 0.05 mm off, with it 0.013.
BENT = np.array([0.1, 0.03])
LEAST_PX_PER_MM = 4.0
MOST_BLUR_MM = 0.3  # standard deviation: half way is then still half way, but narrow strokes grow pale
# Residual [mm] at most, with all eight markers and with fewer, in addition to so many pixels for the corners
# themselves. Paper that bulges by a millimetre leaves 0.15 on A4 with eight and moves marks by as much; on A5 with six
# it leaves 0.10 and moves them by 0.4. Half of it is remarked on.
MOST_MM, MOST_MM_OF_FEW, MANY, MOST_PX = 0.12, 0.06, 8, 0.2
# Times the limit that a covered marker is displaced at least, and that the others fit better than it
COVERED = 2.0
# Less of the usual contrast along a marker's edges hides a place; more hidden places of an edge cover it
HIDDEN, LEAST_HIDDEN = 0.75, 0.05
# Shares of half the picture's diagonal: how finely the middle of a lens is looked for, and how much of a picture counts
# as cut off
CUT_STEPS, LEAST_CUT = np.array([0.2, 0.08, 0.03]), 0.05
TOO_WHITE = 0.5  # share of the brightest parts that are as white as can be
UNPRINTED = "of a flatbed's scan of a sheet on which nothing is printed, give --dpi"
# Where no marker is found, edges over more of the picture's longer side are the reason: a module is lost in them
SMEARED = 1 / 250


@dataclass(frozen=True)
class Printed:
    """What a page shows: markers by id, corners (4, 2) in mm on the sheet, upper left first, clockwise; of which
    dictionary of OpenCV; who it is, for a sentence."""

    sheet_mm: tuple[float, float]
    corners_mm: dict[int, np.ndarray]
    dictionary: str
    name: str = ""


@dataclass(frozen=True)
class View:
    """How a photograph shows the sheet: a homography from mm, then radial distortion about the picture's middle.

    residual_mm: rms distance of the markers' corners from where the view has them, and worst, the marker where it is
    largest, with its own; unsure_mm: standard deviation of the least certain place on the sheet, by its corners;
    blur_mm: standard deviation of the blur, from the markers' edges, across or down, whichever is more; white: share of
    the sheet's brightest parts that are as white as can be.
    """

    homography: np.ndarray
    distortion: tuple[float, ...]
    middle_px: np.ndarray
    radius_px: float
    px_per_mm: float = 0.0
    residual_mm: float = 0.0
    worst: tuple[int, float] = (0, 0.0)
    blur_mm: float = 0.0
    seen: tuple[int, ...] = ()
    unsure_mm: float = 0.0
    white: float = 0.0

    @property
    def most_residual_mm(self) -> float:
        return (MOST_MM if len(self.seen) >= MANY else MOST_MM_OF_FEW) + MOST_PX / self.px_per_mm

    def to_px(self, mm: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the sheet in pixels, (0, 0) the middle of the upper left pixel."""
        x, y = mm.T
        h = self.homography
        w = h[2, 0] * x + h[2, 1] * y + h[2, 2]
        u = (h[0, 0] * x + h[0, 1] * y + h[0, 2]) / w
        v = (h[1, 0] * x + h[1, 1] * y + h[1, 2]) / w
        square = u * u + v * v
        bent = np.ones_like(square)
        for power, k in enumerate(self.distortion, 1):
            bent += k * square**power
        return np.column_stack([u * bent, v * bent]) * self.radius_px + self.middle_px


def find_view(pixels: np.ndarray, printed: Printed) -> View:
    """Error in one sentence where markers are missing, doubled, of another chart or mirrored, where the picture is too
    small or blurred, or where the corners are not where flat paper has them."""
    light = grey_light(pixels)
    found = _of_this_chart(pixels, light, printed)
    modules = _modules(printed.dictionary)
    corners, blurs, clear = {}, [], {}
    for number, rough in found.items():
        corners[number], blur, clear[number] = _exact(light, rough, modules)
        blurs.append(blur)
    try:
        view = _fitted(corners, printed, pixels.shape)
        view = _without_covered(view, corners, clear, printed, pixels.shape)
        blur_mm = float(np.median(blurs)) / view.px_per_mm
        view = replace(view, blur_mm=blur_mm, white=white_share(_of_sheet(light, view, printed)))
        _refuse_unmeasurable(view, printed)
    except Error as refusal:  # markers along one edge of the page give its view poorly
        _refuse_cropped(found, printed, light.shape)
        if refusal.code == "photo-not-flat":
            refuse_grainy(light, f"the markers are {view.residual_mm:.2f} mm (rms) off")
            _refuse_cut(corners, printed, pixels.shape, view)
        raise
    return view


def _of_sheet(light: np.ndarray, view: View, printed: Printed) -> np.ndarray:
    """Return the light of the sheet, (n, 1): around it is a table, or the fill of a picture that was turned."""
    share = np.linspace(0.02, 0.98, 200)
    x, y = np.meshgrid(share * printed.sheet_mm[0], share * printed.sheet_mm[1])
    column, row = view.to_px(np.column_stack([x.ravel(), y.ravel()])).round().T
    inside = (row >= 0) & (row < light.shape[0]) & (column >= 0) & (column < light.shape[1])
    return light[row[inside].astype(int), column[inside].astype(int)][:, None]


def _modules(dictionary: str) -> int:
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary)).markerSize + 2


def detected(pixels: np.ndarray, dictionary: str) -> list[tuple[int, np.ndarray]]:
    """Ids with rough corners (4, 2) in px."""
    shrunk = max(1.0, max(pixels.shape[:2]) / SEEN_AT_PX)
    grey = cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
    small = cv2.resize(grey, None, fx=1 / shrunk, fy=1 / shrunk, interpolation=cv2.INTER_AREA)
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    corners, ids, _ = cv2.aruco.ArucoDetector(known).detectMarkers(small)
    if ids is None:
        return []
    back = np.array([grey.shape[1] / small.shape[1], grey.shape[0] / small.shape[0]])
    return [
        (int(i), (c.reshape(4, 2).astype(float) + 0.5) * back - 0.5)
        for i, c in zip(ids.ravel(), corners, strict=True)
    ]


def _of_this_chart(pixels: np.ndarray, light: np.ndarray, printed: Printed) -> dict[int, np.ndarray]:
    seen = detected(pixels, printed.dictionary)
    ours = [(number, corners) for number, corners in seen if number in printed.corners_mm]
    others = {number for number, _ in seen} - set(printed.corners_mm)
    found: dict[int, np.ndarray] = {}
    for number, corners in ours:
        if number in found:
            raise Error(
                f"marker {number} is in the picture twice: photograph one page alone, without mirrors and other prints",
                code="photo-marker-twice",
            )
        found[number] = corners
    if len(found) >= FEWEST:
        return found
    name = f" {printed.name}" if printed.name else ""
    if len(others) >= FEWEST:
        raise Error(
            f"the picture shows another chart: its markers are {_listed(others)}, those of chart{name} are "
            f"{_listed(printed.corners_mm)}",
            code="photo-of-another-chart",
            advice="give the --chart that was written with this page; calibrate the page of a job (convert --page, "
            "simulate-photo) with --plan and --prior",
        )
    mirrored = [number for number, _ in detected(pixels[:, ::-1], printed.dictionary)]
    if len(set(mirrored) & set(printed.corners_mm)) >= FEWEST:
        raise Error(
            "the picture is mirrored: turn off the mirroring of the camera, or flip the picture back",
            code="photo-mirrored",
        )
    if not found:
        _refuse_blind(light, 0)
        raise Error(
            f"no marker of chart{name} is in the picture: photograph the whole page, sharp and without deep shadows",
            code="photo-markers-missing",
            advice=UNPRINTED,
        )
    _refuse_blind(light, len(found))
    _refuse_cropped(found, printed, light.shape)
    raise Error(
        f"found {len(found)} of {len(printed.corners_mm)} markers ({_listed(found)}), at least {FEWEST} are needed: "
        "photograph the whole page, with nothing over its markers",
        code="photo-markers-missing",
    )


def _refuse_cropped(found: dict[int, np.ndarray], printed: Printed, shape) -> None:
    """Refuse a page of which half of the other markers or more are beyond the picture, judged by the corners of these
    few."""
    others = [c.mean(axis=0) for number, c in printed.corners_mm.items() if number not in found]
    if not others:
        return
    mm = np.vstack([printed.corners_mm[number] for number in found])
    roughly, _ = cv2.estimateAffinePartial2D(mm * (1, -1), np.vstack([*found.values()]))
    if roughly is None:
        return
    px = np.array(others) * (1, -1) @ roughly[:, :2].T + roughly[:, 2]
    beyond = (px < 0).any(axis=1) | (px > np.array(shape[1::-1]) - 1).any(axis=1)
    if beyond.mean() >= 0.5:
        raise Error(
            f"the page is cropped: only {len(found)} of its {len(printed.corners_mm)} markers ({_listed(found)}) are "
            "in the picture, others are beyond its edge: photograph the whole page",
            value=len(found),
            code="photo-cropped",
        )


def _refuse_cut(corners: dict[int, np.ndarray], printed: Printed, shape, view: View) -> None:
    """Where the sheet is flat to a lens whose middle is not the picture's, which cameras have there."""
    at = np.zeros(2)
    for step in CUT_STEPS * view.radius_px:
        places = [at + step * np.array([i, j]) for i in range(-2, 3) for j in range(-2, 3)]
        fits = [_fitted(corners, printed, shape, place) for place in places]
        best = min(range(len(fits)), key=lambda k: fits[k].residual_mm)
        at, view = places[best], fits[best]
    cut = 2 * np.abs(at)
    if view.residual_mm < view.most_residual_mm / 2 and cut.max() > LEAST_CUT * view.radius_px:
        raise Error(
            f"about {cut[0]:.0f} x {cut[1]:.0f} pixels of the picture were cut off, as the lens's middle has it: give "
            "it whole, as the camera took it",
            value=float(cut.max()),
            code="photo-cropped",
        )


def _refuse_blind(light: np.ndarray, count: int) -> None:
    """Where markers are not found because of the picture as a whole."""
    few = f"{count or 'no'} marker{'s' * (count > 1)} can be read"
    refuse_grainy(light, few)
    if not count:
        refuse_dark_paper(float(np.quantile(light[::7, ::7], 0.8)))
    if (white := white_share(light)) > TOO_WHITE:
        raise Error(
            f"{few}, and {100 * white:.0f} % of the brightest parts are as white as can be: the picture is "
            "overexposed; take it with less light, without glare, or with the exposure turned down",
            value=white,
            code="photo-overexposed",
            advice="" if count else UNPRINTED,
        )
    if (wide := blur_px(light)) > SMEARED * max(light.shape):
        raise Error(
            f"{few}, and edges go over {wide:.0f} pixels, more than {SMEARED * max(light.shape):.0f}: the picture is "
            "blurred; hold the camera still and let it focus on the paper",
            value=wide,
            code="photo-blurred",
        )


def _listed(numbers) -> str:
    return ", ".join(map(str, sorted(numbers)))


def _exact(light: np.ndarray, corners: np.ndarray, modules: int) -> tuple[np.ndarray, float, np.ndarray]:
    """Corners where lines through the edges meet, the blur [px] of the edges, and between which edges that nothing
    covers corners (4,) are."""
    blur, is_seen = 0.0, np.ones(4, bool)
    for again in range(3):  # the second time the lines run where they should; the third only looks along them
        lines, blurs, contrasts = [], [], []
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            points, spread, contrast = _edge_points(light, a, b, np.hypot(*(b - a)) / modules)
            lines.append(_line(points))
            blurs.append(spread)
            contrasts.append(contrast)
        lost = np.array(contrasts) < HIDDEN * np.median(contrasts)
        is_seen &= lost.mean(axis=1) <= LEAST_HIDDEN
        if again < 2:
            corners = np.array([_meet(lines[k - 1], lines[k]) for k in range(4)])
            # a camera that moves blurs one way alone
            blur = max(blurs[0] + blurs[2], blurs[1] + blurs[3]) / 2
    return corners, blur, is_seen & np.roll(is_seen, 1)


def _edge_points(light, a, b, module_px: float) -> tuple[np.ndarray, float, np.ndarray]:
    """Points (n, 2) of the edge from a to b, white on its left as the picture is drawn, its blur [px], and by how much
    each place (n,) is lighter outside of the edge than inside.

    Across an edge from black to white, the sum of light against all white gives the place of the edge, however much
    it is blurred: area under the profile = white times the way behind the edge.
    """
    along = (b - a) / np.hypot(*(b - a))
    out = np.array([along[1], -along[0]])  # corners run clockwise with y down
    reach = ACROSS * module_px
    count = max(9, 2 * round(reach * 2) + 1)
    across = np.linspace(-reach, reach, count)
    at = a + ALONG[:, None] * (b - a)
    places = (at[:, None] + across[:, None] * out).astype(np.float32)
    seen = cv2.remap(light, places[..., 0], places[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    end = max(2, count // 6)
    black, white = (
        np.median(seen[:, :end], axis=1, keepdims=True),
        np.median(seen[:, -end:], axis=1, keepdims=True),
    )
    share = (seen - black) / np.maximum(white - black, 1e-3)
    step = across[1] - across[0]
    offset = reach - step * (share.sum(axis=1) - 0.5 * (share[:, 0] + share[:, -1]))
    offset = np.clip(offset, -reach, reach)
    middle = np.median(share, axis=0)
    rising = np.maximum.accumulate(middle) + 1e-9 * np.arange(count)
    low, high = np.interp([0.2, 0.8], rising, across)
    return at + offset[:, None] * out, float(high - low) / 1.683, (white - black)[:, 0]


def _line(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Return (normal, distance from the origin), without outliers."""
    kept = points
    for _ in range(3):
        middle = kept.mean(axis=0)
        normal = np.linalg.svd(kept - middle, full_matrices=False)[2][1]
        off = np.abs((points - middle) @ normal)
        kept = points[off <= max(3 * 1.4826 * np.median(off), 0.05)]
    return normal, float(normal @ middle)


def _meet(one, other) -> np.ndarray:
    normals = np.array([one[0], other[0]])
    return np.linalg.solve(normals, [one[1], other[1]])


def _fitted(corners: dict[int, np.ndarray], printed: Printed, shape, shift_px=(0.0, 0.0)) -> View:
    """Fit by least squares all corners that are not NaN. shift_px: of the lens's middle from the picture's."""
    ids = tuple(number for number in sorted(corners) if np.isfinite(corners[number]).all())
    marker = np.repeat(sorted(corners), 4)
    mm = np.vstack([printed.corners_mm[i] for i in sorted(corners)])
    px = np.vstack([corners[i] for i in sorted(corners)])
    marker, mm, px = (each[np.isfinite(px).all(axis=1)] for each in (marker, mm, px))
    middle = np.array([(shape[1] - 1) / 2, (shape[0] - 1) / 2])
    radius = float(np.hypot(*middle))
    middle = middle + shift_px
    centre, size = np.array(printed.sheet_mm) / 2, max(printed.sheet_mm) / 2
    to_unit = np.array([[1 / size, 0, -centre[0] / size], [0, 1 / size, -centre[1] / size], [0, 0, 1]])
    start, _ = cv2.findHomography((mm - centre) / size, (px - middle) / radius)
    if start is None:
        raise Error(
            "the markers are on one line in the picture: photograph the page from above",
            code="photo-markers-missing",
        )
    unknowns = np.concatenate([start.ravel()[:8] / start[2, 2], np.zeros(len(BENT))])

    def view(u: np.ndarray) -> View:
        homography = np.append(u[:8], 1.0).reshape(3, 3) @ to_unit
        return View(homography, tuple(u[8:]), middle, radius)

    def off(u: np.ndarray) -> np.ndarray:
        return np.concatenate([((view(u).to_px(mm) - px) / CORNER_PX).ravel(), u[8:] / BENT])

    for _ in range(15):
        now = off(unknowns)
        slopes = np.column_stack(
            [(off(unknowns + step) - now) / 1e-6 for step in 1e-6 * np.eye(len(unknowns))]
        )
        change = np.linalg.lstsq(slopes, -now, rcond=None)[0]
        unknowns = unknowns + change
        if np.abs(change).max() < 1e-9:
            break
    found = view(unknowns)
    scale = _px_per_mm(found, printed.sheet_mm)
    squares = np.sum((found.to_px(mm) - px) ** 2, axis=1) / scale**2
    freedom = len(mm) - 4.5  # the homography and k1, two numbers a corner
    each = {number: float(np.sqrt(squares[marker == number].mean())) for number in np.unique(marker).tolist()}
    worst = max(each, key=lambda number: each[number])
    residual = float(np.sqrt(squares.sum() / freedom))
    unsure = _unsure_px(view, unknowns, np.linalg.pinv(slopes.T @ slopes), printed.sheet_mm) / scale
    return View(
        found.homography,
        found.distortion,
        middle,
        radius,
        scale,
        residual,
        (worst, each[worst]),
        seen=ids,
        unsure_mm=unsure,
    )


def _without_covered(view: View, corners: dict, clear: dict, printed: Printed, shape) -> View:
    """Leave out the corners that something covers, of as few markers as possible, so that the others fit flat paper.

    clear: by marker, which of its corners (4,) are between edges that are seen. The marker that is displaced most is
    tried as a whole as well: what covers it may have its own edge next to the marker's. Paper that bulges moves all
    markers, and the clear corners of covered ones with them.
    """
    number, own = view.worst
    limit = view.most_residual_mm
    if view.residual_mm <= limit:
        return view
    hidden = {k: ~each for k, each in clear.items() if not each.all()}
    if own >= COVERED * limit:
        hidden.setdefault(number, np.ones(4, bool))
    for count in range(1, min(len(hidden), len(corners) - FEWEST) + 1):
        fits = [
            _fitted(corners | {k: _without(corners[k], hidden[k]) for k in chosen}, printed, shape)
            for chosen in combinations(sorted(hidden), count)
        ]
        others = min(fits, key=lambda each: each.residual_mm)
        if others.residual_mm < others.most_residual_mm / COVERED:
            return others
    return view


def _without(corners: np.ndarray, hidden: np.ndarray) -> np.ndarray:
    return np.where(hidden[:, None], np.nan, corners)


def _unsure_px(view, unknowns: np.ndarray, covariance: np.ndarray, sheet_mm) -> float:
    at = np.array([(x * sheet_mm[0], y * sheet_mm[1]) for x in (0.1, 0.5, 0.9) for y in (0.1, 0.5, 0.9)])
    here = view(unknowns).to_px(at)
    slopes = [
        (view(unknowns + step).to_px(at) - here).ravel() / 1e-6 for step in 1e-6 * np.eye(len(unknowns))
    ]
    spread = np.einsum("ki,kl,li->i", slopes, covariance, slopes).reshape(-1, 2)
    return float(np.sqrt(spread.sum(axis=1).max()))


def _px_per_mm(view: View, sheet_mm) -> float:
    """The least on the sheet, by how much areas grow."""
    at = np.array([(x * sheet_mm[0], y * sheet_mm[1]) for x in (0.1, 0.5, 0.9) for y in (0.1, 0.5, 0.9)])
    right, up = (view.to_px(at + step) - view.to_px(at - step) for step in 0.5 * np.eye(2))
    return float(np.sqrt(np.abs(right[:, 0] * up[:, 1] - right[:, 1] * up[:, 0]).min()))


def _refuse_unmeasurable(view: View, printed: Printed) -> None:
    if view.px_per_mm < LEAST_PX_PER_MM:
        raise Error(
            f"the picture shows {view.px_per_mm:.1f} pixels per mm, at least {LEAST_PX_PER_MM:g} are needed: let the "
            "page fill the picture, and take it as large as the camera gives it",
            value=view.px_per_mm,
            code="photo-too-coarse",
        )
    if view.blur_mm > MOST_BLUR_MM:
        raise Error(
            f"the picture is blurred, edges over {view.blur_mm:.2f} mm where {MOST_BLUR_MM:g} is the most: hold the "
            "camera still and let it focus on the paper",
            value=view.blur_mm,
            code="photo-blurred",
        )
    limit = view.most_residual_mm
    if view.residual_mm > limit and view.white > TOO_WHITE:
        raise Error(
            f"the markers are {view.residual_mm:.2f} mm (rms) off, more than {limit:.2f}, and {100 * view.white:.0f} % "
            "of the brightest parts are as white as can be: the picture is overexposed; take it with less light",
            value=view.white,
            code="photo-overexposed",
        )
    if view.residual_mm > limit:
        number, own = view.worst
        raise Error(
            f"the markers are {view.residual_mm:.2f} mm (rms) from where flat paper would have them, more than "
            f"{limit:.2f}; marker {number} most, {own:.2f} mm: press the page flat, and take it from straight above",
            value=view.residual_mm,
            code="photo-not-flat",
        )
