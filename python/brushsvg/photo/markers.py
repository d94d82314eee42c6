"""Find ArUco markers in a photograph, refine their corners, and fit the camera's view of the sheet to them.

A corner is where straight lines through two edges of its marker meet. Pictures that cannot be measured are refused.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import cv2
import numpy as np

from ..errors import Error
from .photo import blur_px, grey_light, refuse_dark_paper, refuse_grainy, white_share

MIN_MARKERS = 3  # with two, the noise of their corners leaves the tilt of the sheet undetermined
# Longer side of the reduced picture in which markers are detected. Their corners are refined at full size.
MAX_SEARCH_SIDE_PX = 2400
EDGE_PLACES = np.linspace(0.08, 0.92, 31)  # shares of a marker's edge at which light is sampled across it
EDGE_REACH_MODULES = 0.8  # sampled to both sides: other black modules begin at one module
CORNER_SIGMA_PX = 0.15  # standard deviation of a corner
# Standard deviations of a lens's k1 and k2, at half the picture's diagonal. They determine what a few markers leave
# open. Without k2 the middle of a page is 0.05 mm off, with it 0.013.
DISTORTION_SIGMA = np.array([0.1, 0.03])
MIN_PX_PER_MM = 4.0
# Standard deviation of the blur. Half way is still half way at this blur, but narrow strokes become pale.
MAX_BLUR_MM = 0.3
# Largest residual [mm], with all eight markers and with fewer, and the pixels added to it for the corners themselves.
# Paper that bulges by 1 mm leaves 0.15 mm on A4 with eight markers and moves marks by as much. On A5 with six markers
# it leaves 0.10 mm and moves marks by 0.4 mm. Half of the limit causes a warning.
MAX_RESIDUAL_MM, MAX_RESIDUAL_MM_OF_FEW, MANY_MARKERS, MAX_RESIDUAL_PX = 0.12, 0.06, 8, 0.2
# Factor by which a covered marker exceeds the limit, and by which the other markers must stay below it.
MIN_COVERED_FACTOR = 2.0
# A place on a marker's edge with less of the usual contrast is hidden. An edge with more hidden places is covered.
MIN_EDGE_CONTRAST, MAX_HIDDEN_SHARE = 0.75, 0.05
# Shares of half the picture's diagonal: the steps of the search for the middle of the lens, and the narrowest strip
# that counts as cut off.
LENS_MIDDLE_STEPS, MIN_CUT_SHARE = np.array([0.2, 0.08, 0.03]), 0.05
TOO_WHITE = 0.5  # share of the brightest parts that are fully white
ADVICE_FOR_UNPRINTED = "for a flatbed scan of a sheet without printed markers, add --dpi"
# Of the picture's longer side. Where no marker is found, wider edges are the reason: they blur out whole modules.
MAX_EDGE_SHARE = 1 / 250


@dataclass(frozen=True)
class Printed:
    """The markers that are printed on a page.

    corners_mm: corners (4, 2) by marker id, in mm on the sheet, upper left first, clockwise; dictionary: OpenCV's name
    of the marker dictionary; name: the page's name for messages.
    """

    sheet_mm: tuple[float, float]
    corners_mm: dict[int, np.ndarray]
    dictionary: str
    name: str = ""


@dataclass(frozen=True)
class View:
    """The camera's view of the sheet.

    A point in mm is mapped by a homography, then by radial distortion about the picture's middle.

    residual_mm: rms distance of the markers' corners from their places in the view; worst: the marker with the largest
    residual, and this residual; unsure_mm: standard deviation of the least certain place on the sheet, from the
    corners; blur_mm: standard deviation of the blur of the markers' edges, the larger of across and down; white: share
    of the sheet's brightest parts that are fully white.
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
        return (
            MAX_RESIDUAL_MM if len(self.seen) >= MANY_MARKERS else MAX_RESIDUAL_MM_OF_FEW
        ) + MAX_RESIDUAL_PX / self.px_per_mm

    def to_px(self, mm: np.ndarray) -> np.ndarray:
        """Map points (n, 2) of the sheet to pixels. (0, 0) is the middle of the upper left pixel."""
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
    """Find the printed markers in a photograph and fit the view of the sheet to them.

    Raises Error where markers are missing, appear twice, are mirrored or belong to another chart. It also refuses
    pictures that are too small or blurred, and corners that do not match flat paper.
    """
    light = grey_light(pixels)
    found = _find_chart_markers(pixels, light, printed)
    modules = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, printed.dictionary)).markerSize + 2
    corners, blurs, clear = {}, [], {}
    for number, rough in found.items():
        corners[number], blur, clear[number] = _refine_corners(light, rough, modules)
        blurs.append(blur)
    try:
        view = _fit_view(corners, printed, pixels.shape)
        view = _fit_without_covered(view, corners, clear, printed, pixels.shape)
        blur_mm = float(np.median(blurs)) / view.px_per_mm
        view = replace(view, blur_mm=blur_mm, white=white_share(_sheet_light(light, view, printed)))
        _refuse_unmeasurable(view, printed)
    except Error as refusal:  # markers along only one edge determine the view poorly
        _refuse_cropped(found, printed, light.shape)
        if refusal.code == "photo-not-flat":
            refuse_grainy(light, f"the markers are {view.residual_mm:.2f} mm (rms) from their places")
            _refuse_cut_off(corners, printed, pixels.shape, view)
        raise
    return view


def _sheet_light(light: np.ndarray, view: View, printed: Printed) -> np.ndarray:
    """Return the light of the sheet's pixels, (n, 1).

    Pixels around the sheet show a table, or the fill of a rotated picture, and do not count.
    """
    share = np.linspace(0.02, 0.98, 200)
    x, y = np.meshgrid(share * printed.sheet_mm[0], share * printed.sheet_mm[1])
    column, row = view.to_px(np.column_stack([x.ravel(), y.ravel()])).round().T
    inside = (row >= 0) & (row < light.shape[0]) & (column >= 0) & (column < light.shape[1])
    return light[row[inside].astype(int), column[inside].astype(int)][:, None]


def detect_markers(pixels: np.ndarray, dictionary: str) -> list[tuple[int, np.ndarray]]:
    """Return the ids of all markers in the picture, with rough corners (4, 2) in px."""
    shrunk = max(1.0, max(pixels.shape[:2]) / MAX_SEARCH_SIDE_PX)
    grey = cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
    small = cv2.resize(grey, None, fx=1 / shrunk, fy=1 / shrunk, interpolation=cv2.INTER_AREA)
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    corners, ids, _ = cv2.aruco.ArucoDetector(known).detectMarkers(small)
    if ids is None:
        return []
    back = np.array([grey.shape[1] / small.shape[1], grey.shape[0] / small.shape[0]])
    return [
        (int(i), (c.reshape(4, 2).astype(float) + 0.5) * back - 0.5) for i, c in zip(ids.ravel(), corners, strict=True)
    ]


def _find_chart_markers(pixels: np.ndarray, light: np.ndarray, printed: Printed) -> dict[int, np.ndarray]:
    markers_in_picture = detect_markers(pixels, printed.dictionary)
    ours = [(number, corners) for number, corners in markers_in_picture if number in printed.corners_mm]
    others = {number for number, _ in markers_in_picture} - set(printed.corners_mm)
    found: dict[int, np.ndarray] = {}
    for number, corners in ours:
        if number in found:
            raise Error(
                f"marker {number} is in the picture twice: photograph only one page, without mirrors or other prints",
                code="photo-marker-twice",
            )
        found[number] = corners
    if len(found) >= MIN_MARKERS:
        return found
    name = f" {printed.name}" if printed.name else ""
    if len(others) >= MIN_MARKERS:
        raise Error(
            f"the picture shows another chart: it has the markers {_list_numbers(others)}, but chart{name} has "
            f"{_list_numbers(printed.corners_mm)}",
            code="photo-of-another-chart",
            advice="give the --chart that was written with this page; for the page of a job (convert --page, "
            "simulate-photo), use --plan and --prior",
        )
    mirrored = [number for number, _ in detect_markers(pixels[:, ::-1], printed.dictionary)]
    if len(set(mirrored) & set(printed.corners_mm)) >= MIN_MARKERS:
        sentence = "the picture is mirrored: turn off the mirroring of the camera, or flip the picture back"
        raise Error(sentence, code="photo-mirrored")
    if not found:
        _refuse_poor_picture(light, 0)
        raise Error(
            f"no marker of chart{name} is in the picture: photograph the whole page, sharp and without deep shadows",
            code="photo-markers-missing",
            advice=ADVICE_FOR_UNPRINTED,
        )
    _refuse_poor_picture(light, len(found))
    _refuse_cropped(found, printed, light.shape)
    raise Error(
        f"found {len(found)} of {len(printed.corners_mm)} markers ({_list_numbers(found)}), at least {MIN_MARKERS} are "
        "needed: photograph the whole page, with nothing over its markers",
        code="photo-markers-missing",
    )


def _refuse_cropped(found: dict[int, np.ndarray], printed: Printed, shape) -> None:
    """Refuse a page if at least half of the missing markers are outside the picture, by the found corners."""
    others = [c.mean(axis=0) for number, c in printed.corners_mm.items() if number not in found]
    if not others:
        return
    mm = np.vstack([printed.corners_mm[number] for number in found])
    rough_view, _ = cv2.estimateAffinePartial2D(mm * (1, -1), np.vstack([*found.values()]))
    if rough_view is None:
        return
    px = np.array(others) * (1, -1) @ rough_view[:, :2].T + rough_view[:, 2]
    beyond = (px < 0).any(axis=1) | (px > np.array(shape[1::-1]) - 1).any(axis=1)
    if beyond.mean() >= 0.5:
        raise Error(
            f"the page is cropped: only {len(found)} of its {len(printed.corners_mm)} markers ({_list_numbers(found)}) "
            "are in the picture: photograph the whole page",
            value=len(found),
            code="photo-cropped",
        )


def _refuse_cut_off(corners: dict[int, np.ndarray], printed: Printed, shape, view: View) -> None:
    """Refuse a picture of which a part was cut off.

    Such a picture fits flat paper only if the middle of the lens is not the middle of the picture. Cameras have both in
    the same place, so that a part of this picture was cut off.
    """
    at = np.zeros(2)
    for step in LENS_MIDDLE_STEPS * view.radius_px:
        places = [at + step * np.array([i, j]) for i in range(-2, 3) for j in range(-2, 3)]
        fits = [_fit_view(corners, printed, shape, place) for place in places]
        best = min(range(len(fits)), key=lambda k: fits[k].residual_mm)
        at, view = places[best], fits[best]
    cut = 2 * np.abs(at)
    if view.residual_mm < view.most_residual_mm / 2 and cut.max() > MIN_CUT_SHARE * view.radius_px:
        raise Error(
            f"the picture was cropped by about {cut[0]:.0f} x {cut[1]:.0f} pixels, because it is not centred on the "
            "lens: use the original picture of the camera",
            value=float(cut.max()),
            code="photo-cropped",
        )


def _refuse_poor_picture(light: np.ndarray, count: int) -> None:
    """Refuse a picture whose markers cannot be found for grain, darkness, glare or blur."""
    markers = f"{f'only {count}' if count else 'no'} marker{'s' * (count > 1)} can be read"
    refuse_grainy(light, markers)
    if not count:
        refuse_dark_paper(float(np.quantile(light[::7, ::7], 0.8)))
    if (white := white_share(light)) > TOO_WHITE:
        sentence = (
            f"{markers}, because the picture is overexposed ({100 * white:.0f} % of its brightest parts are pure "
            "white): take it with less light, without glare, or with a lower exposure"
        )
        raise Error(sentence, value=white, code="photo-overexposed", advice="" if count else ADVICE_FOR_UNPRINTED)
    if (edge_width_px := blur_px(light)) > MAX_EDGE_SHARE * max(light.shape):
        raise Error(
            f"{markers}, because the picture is blurred (edges are {edge_width_px:.0f} pixels wide, more than "
            f"{MAX_EDGE_SHARE * max(light.shape):.0f}): hold the camera still and let it focus on the paper",
            value=edge_width_px,
            code="photo-blurred",
        )


def _list_numbers(numbers) -> str:
    return ", ".join(map(str, sorted(numbers)))


def _refine_corners(light: np.ndarray, corners: np.ndarray, modules: int) -> tuple[np.ndarray, float, np.ndarray]:
    """Refine a marker's corners (4, 2) to where lines through its edges meet.

    Returns the corners, the edges' blur [px] and the visibility. The visibility (4,) is true for corners between two
    edges that nothing covers.
    """
    blur, is_seen = 0.0, np.ones(4, bool)
    for iteration in range(3):  # the first two passes correct the lines; the third only measures along them
        lines, blurs, contrasts = [], [], []
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            points, spread, contrast = _locate_edge(light, a, b, np.hypot(*(b - a)) / modules)
            lines.append(_fit_line(points))
            blurs.append(spread)
            contrasts.append(contrast)
        is_hidden = np.array(contrasts) < MIN_EDGE_CONTRAST * np.median(contrasts)
        is_seen &= is_hidden.mean(axis=1) <= MAX_HIDDEN_SHARE
        if iteration < 2:
            corners = np.array([_intersect_lines(lines[k - 1], lines[k]) for k in range(4)])
            # A moving camera blurs in one direction only.
            blur = max(blurs[0] + blurs[2], blurs[1] + blurs[3]) / 2
    return corners, blur, is_seen & np.roll(is_seen, 1)


def _locate_edge(light, a, b, module_px: float) -> tuple[np.ndarray, float, np.ndarray]:
    """Locate the edge from a to b, with white on its left in the picture.

    Returns points (n, 2) on the edge, its blur [px], and the contrast (n,): how much lighter each place is outside the
    edge than inside. The position of an edge from black to white follows from the sum of the light across it, however
    blurred the edge is: the area under the profile is the white level times the distance behind the edge.
    """
    along = (b - a) / np.hypot(*(b - a))
    outward = np.array([along[1], -along[0]])  # corners run clockwise with y down
    reach = EDGE_REACH_MODULES * module_px
    count = max(9, 2 * round(reach * 2) + 1)
    across = np.linspace(-reach, reach, count)
    at = a + EDGE_PLACES[:, None] * (b - a)
    places = (at[:, None] + across[:, None] * outward).astype(np.float32)
    profiles = cv2.remap(light, places[..., 0], places[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    end = max(2, count // 6)
    black = np.median(profiles[:, :end], axis=1, keepdims=True)
    white = np.median(profiles[:, -end:], axis=1, keepdims=True)
    share = (profiles - black) / np.maximum(white - black, 1e-3)
    step = across[1] - across[0]
    offset = reach - step * (share.sum(axis=1) - 0.5 * (share[:, 0] + share[:, -1]))
    offset = np.clip(offset, -reach, reach)
    mean_profile = np.median(share, axis=0)
    rising = np.maximum.accumulate(mean_profile) + 1e-9 * np.arange(count)
    low, high = np.interp([0.2, 0.8], rising, across)
    return at + offset[:, None] * outward, float(high - low) / 1.683, (white - black)[:, 0]


def _fit_line(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Fit a line to points without outliers. Returns its normal and its distance from the origin."""
    inliers = points
    for _ in range(3):
        middle = inliers.mean(axis=0)
        normal = np.linalg.svd(inliers - middle, full_matrices=False)[2][1]
        distances = np.abs((points - middle) @ normal)
        inliers = points[distances <= max(3 * 1.4826 * np.median(distances), 0.05)]
    return normal, float(normal @ middle)


def _intersect_lines(line, other_line) -> np.ndarray:
    normals = np.array([line[0], other_line[0]])
    return np.linalg.solve(normals, [line[1], other_line[1]])


def _fit_view(corners: dict[int, np.ndarray], printed: Printed, shape, shift_px=(0.0, 0.0)) -> View:
    """Fit the view to all corners that are not NaN; shift_px: lens middle relative to the picture's middle."""
    ids = tuple(number for number in sorted(corners) if np.isfinite(corners[number]).all())
    marker = np.repeat(sorted(corners), 4)
    mm = np.vstack([printed.corners_mm[i] for i in sorted(corners)])
    px = np.vstack([corners[i] for i in sorted(corners)])
    is_seen = np.isfinite(px).all(axis=1)
    marker, mm, px = marker[is_seen], mm[is_seen], px[is_seen]
    middle = np.array([(shape[1] - 1) / 2, (shape[0] - 1) / 2])
    radius = float(np.hypot(*middle))
    middle = middle + shift_px
    centre, size = np.array(printed.sheet_mm) / 2, max(printed.sheet_mm) / 2
    to_unit = np.array([[1 / size, 0, -centre[0] / size], [0, 1 / size, -centre[1] / size], [0, 0, 1]])
    start, _ = cv2.findHomography((mm - centre) / size, (px - middle) / radius)
    if start is None:
        sentence = "the markers are on one line in the picture: photograph the page from above"
        raise Error(sentence, code="photo-markers-missing")
    unknowns = np.concatenate([start.ravel()[:8] / start[2, 2], np.zeros(len(DISTORTION_SIGMA))])

    def view(u: np.ndarray) -> View:
        homography = np.append(u[:8], 1.0).reshape(3, 3) @ to_unit
        return View(homography, tuple(u[8:]), middle, radius)

    def residuals(u: np.ndarray) -> np.ndarray:
        return np.concatenate([((view(u).to_px(mm) - px) / CORNER_SIGMA_PX).ravel(), u[8:] / DISTORTION_SIGMA])

    for _ in range(15):
        now = residuals(unknowns)
        slopes = np.column_stack([(residuals(unknowns + step) - now) / 1e-6 for step in 1e-6 * np.eye(len(unknowns))])
        change = np.linalg.lstsq(slopes, -now, rcond=None)[0]
        unknowns = unknowns + change
        if np.abs(change).max() < 1e-9:
            break
    fitted = view(unknowns)
    scale = _min_px_per_mm(fitted, printed.sheet_mm)
    squares = np.sum((fitted.to_px(mm) - px) ** 2, axis=1) / scale**2
    freedom = len(mm) - 4.5  # eight of the homography and k1; each corner gives two numbers
    rms_of_marker = {number: float(np.sqrt(squares[marker == number].mean())) for number in np.unique(marker).tolist()}
    worst = max(rms_of_marker, key=lambda number: rms_of_marker[number])
    residual = float(np.sqrt(squares.sum() / freedom))
    unsure_mm = _least_certain_px(view, unknowns, np.linalg.pinv(slopes.T @ slopes), printed.sheet_mm) / scale
    return View(
        fitted.homography,
        fitted.distortion,
        middle,
        radius,
        scale,
        residual,
        (worst, rms_of_marker[worst]),
        seen=ids,
        unsure_mm=unsure_mm,
    )


def _fit_without_covered(view: View, corners: dict, clear: dict, printed: Printed, shape) -> View:
    """Fit the view without covered corners.

    As few markers as possible lose corners, and the others must then fit flat paper. clear: for each marker, which of
    its corners (4,) are between visible edges. The marker with the largest displacement is also tried without all its
    corners, because the edge of the covering object may be mistaken for the marker's edge. Bulging paper, in contrast,
    moves all markers, and the clear corners of covered ones with them.
    """
    number, worst_mm = view.worst
    limit = view.most_residual_mm
    if view.residual_mm <= limit:
        return view
    hidden = {k: ~is_clear for k, is_clear in clear.items() if not is_clear.all()}
    if worst_mm >= MIN_COVERED_FACTOR * limit:
        hidden.setdefault(number, np.ones(4, bool))
    for count in range(1, min(len(hidden), len(corners) - MIN_MARKERS) + 1):
        fits = [
            _fit_view(corners | {k: np.where(hidden[k][:, None], np.nan, corners[k]) for k in chosen}, printed, shape)
            for chosen in combinations(sorted(hidden), count)
        ]
        others = min(fits, key=lambda fit: fit.residual_mm)
        if others.residual_mm < others.most_residual_mm / MIN_COVERED_FACTOR:
            return others
    return view


def _least_certain_px(view, unknowns: np.ndarray, covariance: np.ndarray, sheet_mm) -> float:
    at = np.array([(x * sheet_mm[0], y * sheet_mm[1]) for x in (0.1, 0.5, 0.9) for y in (0.1, 0.5, 0.9)])
    places_px = view(unknowns).to_px(at)
    slopes = [(view(unknowns + step).to_px(at) - places_px).ravel() / 1e-6 for step in 1e-6 * np.eye(len(unknowns))]
    spread = np.einsum("ki,kl,li->i", slopes, covariance, slopes).reshape(-1, 2)
    return float(np.sqrt(spread.sum(axis=1).max()))


def _min_px_per_mm(view: View, sheet_mm) -> float:
    """Return the smallest resolution on the sheet, from the magnification of areas."""
    at = np.array([(x * sheet_mm[0], y * sheet_mm[1]) for x in (0.1, 0.5, 0.9) for y in (0.1, 0.5, 0.9)])
    right, up = (view.to_px(at + step) - view.to_px(at - step) for step in 0.5 * np.eye(2))
    return float(np.sqrt(np.abs(right[:, 0] * up[:, 1] - right[:, 1] * up[:, 0]).min()))


def _refuse_unmeasurable(view: View, printed: Printed) -> None:
    if view.px_per_mm < MIN_PX_PER_MM:
        raise Error(
            f"the picture has only {view.px_per_mm:.1f} pixels per mm, at least {MIN_PX_PER_MM:g} are needed: let the "
            "page fill the picture, and use the full resolution of the camera",
            value=view.px_per_mm,
            code="photo-too-coarse",
        )
    if view.blur_mm > MAX_BLUR_MM:
        raise Error(
            f"the picture is blurred (edges are {view.blur_mm:.2f} mm wide, more than {MAX_BLUR_MM:g} mm): hold the "
            "camera still and let it focus on the paper",
            value=view.blur_mm,
            code="photo-blurred",
        )
    limit = view.most_residual_mm
    if view.residual_mm > limit and view.white > TOO_WHITE:
        raise Error(
            f"the picture is overexposed ({100 * view.white:.0f} % of its brightest parts are pure white), and its "
            f"markers are {view.residual_mm:.2f} mm (rms) from their places, more than {limit:.2f} mm: take it with "
            "less light",
            value=view.white,
            code="photo-overexposed",
        )
    if view.residual_mm > limit:
        number, worst_mm = view.worst
        raise Error(
            f"the markers are {view.residual_mm:.2f} mm (rms) from where flat paper would have them, more than "
            f"{limit:.2f} mm; marker {number} most, by {worst_mm:.2f} mm: press the page flat, and photograph it from "
            "straight above",
            value=view.residual_mm,
            code="photo-not-flat",
        )
