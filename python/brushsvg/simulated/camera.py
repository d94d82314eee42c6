"""Render photographs of painted sheets: a tilted camera with lens distortion above a sheet in uneven light.

The renderer shares no code with the photograph reader that it tests. Polygons become paint by the exact length of
each scan line inside them. Each pixel follows its ray down to the sheet. Only JPEG encoding, interpolation between
pixels and filtering come from OpenCV. Lengths are in mm, sheets have y up, light is in linear units.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache

import cv2
import numpy as np

TEXELS = 20.0  # default number of texels per mm of the sheet
INK = np.array([0.05, 0.04, 0.04])  # share of red, green and blue light that printer ink reflects
BLUE = np.array([0.05, 0.09, 0.35])


@dataclass(frozen=True)
class Camera:
    """A tilted camera above the middle of the sheet.

    focal: focal length in picture widths; bend: lens distortion, where 0.02 moves the corners of the picture by 2 %.
    """

    size_px: tuple[int, int] = (1700, 2300)
    focal: float = 1.1
    tilt_deg: tuple[float, float] = (4.0, -3.0)
    turn_deg: float = 2.0
    bend: float = -0.03
    fill: float = 0.93  # share of the picture that the sheet fills
    displacement_mm: tuple[float, float] = (3.0, -2.0)
    blur_px: float = 0.8
    noise: float = 0.008
    light: tuple[float, float] = (0.25, -0.18)  # change of the light across and up the sheet
    vignette: float = 0.15
    shadow: float = 0.0  # depth of a soft shadow over a corner
    quality: int = 92
    sag_mm: float = 0.0  # height of the bulge in the middle of the paper
    exposure: float = 1.0  # at 2, a surface that reflects half of the light is already white
    motion_px: tuple[float, float] = (0.0, 0.0)  # movement of the camera during the exposure, right and down
    glare: tuple[float, float, float] = (0.0, 0.0, 0.0)  # x, y and radius in mm of a lamp's mirror image
    edge: float = 0.0  # depth of a shadow with a hard edge across the sheet


class Sheet:
    """The light that a sheet reflects, as texels that are painted over ring by ring.

    texels: number of texels per mm; shown: (rows, columns, 3) reflected share of red, green and blue light.
    """

    texels = TEXELS

    def __init__(self, size_mm, seed=0, texels=TEXELS):
        self.size_mm, self.texels = size_mm, texels
        columns, rows = (round(side * texels) for side in size_mm)
        rng = np.random.default_rng(seed)
        grain = rng.normal(size=(rows // 8 + 2, columns // 8 + 2)).astype(np.float32)
        grain = np.repeat(np.repeat(grain, 8, axis=0), 8, axis=1)[:rows, :columns]
        self.shown = np.empty((rows, columns, 3), np.float32)
        for k, tint in enumerate((0.86, 0.85, 0.82)):
            self.shown[..., k] = tint * (1 + 0.006 * grain)

    def paint(self, rings, colour, opacity=1.0):
        """Paint the area inside the rings (even-odd).

        opacity: a number, or a function of the texel positions x (columns,) and y (rows,) in mm.
        """
        share, (r0, r1, c0, c1) = self._texel_coverage(rings)
        if share.size:
            if callable(opacity):
                x = (np.arange(c0, c1) + 0.5) / self.texels
                opacity = opacity(x, self.size_mm[1] - (np.arange(r0, r1) + 0.5) / self.texels)
            share = (opacity * share)[..., None].astype(np.float32)
            window = self.shown[r0:r1, c0:c1]
            window *= 1 - share
            window += share * np.asarray(colour, np.float32)

    def _texel_coverage(self, rings):
        """Return shares of texels inside the rings (even-odd), and the texels' window (r0, r1, c0, c1)."""
        rows, columns = self.shown.shape[:2]
        rings = [np.column_stack([r[:, 0], self.size_mm[1] - r[:, 1]]) * self.texels for r in map(np.asarray, rings)]
        points = np.vstack(rings)
        c0, c1 = max(0, int(points[:, 0].min()) - 1), min(columns, int(points[:, 0].max()) + 2)
        r0, r1 = max(0, int(points[:, 1].min()) - 1), min(rows, int(points[:, 1].max()) + 2)
        lines = 3  # scan lines per row of texels
        xa, ya, xb, yb = np.vstack([np.hstack([ring, np.roll(ring, -1, axis=0)]) for ring in rings]).T
        # Each edge crosses the scan lines from its lower end on. Its upper end is excluded, so that the
        # next edge does not count the same scan line again.
        first, last = (
            np.clip(np.ceil((y - r0) * lines - 0.5), 0, max(r1 - r0, 0) * lines).astype(int)
            for y in (np.minimum(ya, yb), np.maximum(ya, yb))
        )
        edge = np.repeat(np.arange(len(xa)), last - first)
        line = np.arange(len(edge)) - np.repeat(np.cumsum(last - first) - last, last - first)
        y = r0 + (line + 0.5) / lines
        x = xa[edge] + (y - ya[edge]) / (yb - ya)[edge] * (xb - xa)[edge] - c0
        order = np.lexsort((x, line))
        row = line[order][::2] // lines
        width = max(c1 - c0, 0) + 1
        a, b = np.clip(x[order].reshape(-1, 2).T, 0, width - 1)
        # A span covers its first and last texel in part and all texels between them completely. The differences from
        # texel to texel are added up first, and their cumulative sum is the coverage.
        left, right = a.astype(int), b.astype(int)
        coverage_steps = np.zeros((max(r1 - r0, 0), width + 1))
        np.add.at(coverage_steps, (row, left), left + 1 - a)
        np.add.at(coverage_steps, (row, left + 1), a - left)
        np.add.at(coverage_steps, (row, right), b - right - 1)
        np.add.at(coverage_steps, (row, right + 1), right - b)
        return np.cumsum(coverage_steps, axis=1)[:, : width - 1] / lines, (r0, r1, c0, c1)


def box(left, bottom, right, top):
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])


def corners_seen(camera, sheet_mm, points_mm):
    """Return the pixels (n, 2) that show points (n, 2) of the sheet. (0, 0) is the middle of the first pixel."""
    rotation, place, focal_px, middle = _camera_pose(camera, sheet_mm)
    world = np.column_stack(
        [np.asarray(points_mm, float), _paper_height_mm(camera, sheet_mm, np.asarray(points_mm, float))]
    )
    ray = (world - place) @ rotation
    ideal = ray[:, :2] / ray[:, 2:]
    return ideal * _distortion_factor(camera, np.hypot(*ideal.T))[:, None] * focal_px + middle


def _distortion_factor(camera, radius):
    """Return the distorted over the ideal distance from the optical axis."""
    widest = 0.5 * np.hypot(*camera.size_px) / (camera.focal * camera.size_px[0])
    square = (radius / widest) ** 2
    return 1 + camera.bend * square + 0.2 * camera.bend * square**2


def _camera_pose(camera, sheet_mm):
    """Return the camera's rotation, position, focal length and optical centre.

    The position is in mm, focal length and centre are in px. The columns of the rotation (3, 3) are the camera's right,
    down and forward directions in the sheet's frame.
    """
    across, up, turn = np.radians([*camera.tilt_deg, camera.turn_deg])
    forward = np.array([np.sin(across), np.sin(up), -np.cos(across) * np.cos(up)])
    forward /= np.linalg.norm(forward)
    right = np.array([np.cos(turn), np.sin(turn), 0.0])
    right -= (right @ forward) * forward
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    focal_px = camera.focal * camera.size_px[0]
    scale = min(c / s for c, s in zip(camera.size_px, sheet_mm, strict=True)) * camera.fill
    middle = np.array([*np.array(sheet_mm) / 2 + camera.displacement_mm, 0.0])
    place = middle - forward * focal_px / scale
    centre = (np.array(camera.size_px) - 1) / 2 + [3.0, -4.0]  # no lens is exactly centred
    return np.column_stack([right, down, forward]), place, focal_px, centre


def _paper_height_mm(camera, sheet_mm, points):
    """Return the height of paper that bulges between its left and right edges."""
    return camera.sag_mm * np.sin(np.pi * np.clip(points[..., 0] / sheet_mm[0], 0, 1))


def photograph(sheet, camera=Camera(), seed=1, mirrored=False):
    """Return a photograph of the sheet as JPEG bytes."""
    return encoded(exposed(sheet, camera, seed, mirrored), camera.quality)


def encoded(pixels, quality=92):
    return cv2.imencode(".jpg", pixels[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()


def exposed(sheet, camera=Camera(), seed=1, mirrored=False):
    """Return a photograph of the sheet as 8-bit sRGB pixels (rows, columns, 3)."""
    rng = np.random.default_rng(seed)
    at, from_middle = _sheet_points_of_pixels(
        *(sheet.size_mm, camera.size_px, camera.focal, camera.tilt_deg, camera.turn_deg),
        *(camera.bend, camera.fill, camera.displacement_mm, camera.sag_mm),
    )
    out = _sample_sheet(sheet, at)
    out *= _light_on_sheet(camera, sheet.size_mm, at)[..., None]
    if camera.glare[2]:
        away = np.hypot(at[..., 0] - camera.glare[0], at[..., 1] - camera.glare[1]) / camera.glare[2]
        out += 1.5 * np.exp(-((np.minimum(away, 5.0)) ** 4))[..., None]
    out *= (camera.exposure * (1 - camera.vignette * from_middle**2))[..., None]
    if camera.blur_px:
        out = _blurred(out, camera.blur_px)
    if any(camera.motion_px):
        out = _blur_along_path(out, camera.motion_px)
    grain = rng.standard_normal(size=out.shape).astype(np.float32)
    grain *= np.float32(camera.noise) * np.sqrt(np.maximum(out, np.float32(0.02)))
    out += grain
    pixels = coded(out)
    return np.ascontiguousarray(pixels[:, ::-1]) if mirrored else pixels


@lru_cache(maxsize=2)  # most photographs in one test file differ only in their paint
def _sheet_points_of_pixels(sheet_mm, size_px, focal, tilt_deg, turn_deg, bend, fill, displacement_mm, sag_mm):
    """Return the point on the sheet that each pixel shows, (rows, columns, 2) in mm.

    Also returns the distance of each pixel from the optical axis. The distance (rows, columns) is relative to that of
    the picture's corner. Both arrays have single precision.
    """
    camera = Camera(size_px, focal, tilt_deg, turn_deg, bend, fill, displacement_mm, sag_mm=sag_mm)
    columns, rows = size_px
    rotation, place, focal_px, middle = _camera_pose(camera, sheet_mm)
    # The lens is symmetric about its axis, so that one table of distances inverts its distortion.
    farthest = np.hypot(*(np.array(size_px) / 2 + 10)) / focal_px
    seen_at = np.linspace(0, 1.1 * farthest, 10_000)
    ideal_at = seen_at.copy()
    for _ in range(6):
        ideal_at = seen_at / _distortion_factor(camera, ideal_at)
    at = np.empty((rows, columns, 2), np.float32)
    from_middle = np.empty((rows, columns), np.float32)
    for top in range(0, rows, 256):
        v, u = np.mgrid[top : min(top + 256, rows), 0:columns].astype(float)
        directions = np.stack([(u - middle[0]) / focal_px, (v - middle[1]) / focal_px], axis=-1)
        distance = np.hypot(directions[..., 0], directions[..., 1])
        directions *= (np.interp(distance, seen_at, ideal_at) / np.maximum(distance, 1e-12))[..., None]
        ray = directions @ rotation[:, :2].T + rotation[:, 2]
        height = 0.0
        for _ in range(1 if sag_mm == 0 else 4):
            points_mm = place[:2] + ray[..., :2] * ((height - place[2]) / ray[..., 2])[..., None]
            height = _paper_height_mm(camera, sheet_mm, points_mm)
        at[top : top + len(v)] = points_mm
        from_middle[top : top + len(v)] = distance / (0.5 * np.hypot(columns, rows) / focal_px)
    at.flags.writeable = from_middle.flags.writeable = False
    return at, from_middle


def coded(light):
    """Encode linear light as 8-bit sRGB."""
    out = np.empty(light.shape, np.uint8)
    for top in range(0, len(light), 32):  # 32 rows fit into the processor's cache
        block = np.clip(light[top : top + 32], 0, 1)
        block *= 65535
        block += 0.5
        out[top : top + 32] = _srgb_table()[block.astype(np.uint16)]
    return out


@cache
def _srgb_table():
    light = np.arange(65536) / 65535
    code = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)
    return np.round(code * 255).astype(np.uint8)


def _light_on_sheet(camera, size_mm, at):
    x, y = at[..., 0] / size_mm[0] - 0.5, at[..., 1] / size_mm[1] - 0.5
    light = 0.85 * (1 + camera.light[0] * x + camera.light[1] * y - 0.1 * (x * x + y * y))
    if camera.shadow:
        light = light * (1 - camera.shadow / (1 + np.exp(-(x + y - 0.2) * 25)))
    if camera.edge:
        light = np.where(x + 0.6 * y > 0.05, light * (1 - camera.edge), light)
    return light


def _sample_sheet(sheet, at):
    """Interpolate the reflected light between texels. Points off the sheet show a brown table."""
    rows, columns = sheet.shown.shape[:2]
    c = at[..., 0] * sheet.texels - 0.5
    r = (sheet.size_mm[1] - at[..., 1]) * sheet.texels - 0.5
    inside = (c >= 0) & (r >= 0) & (c <= columns - 2) & (r <= rows - 2)
    value = cv2.remap(sheet.shown, c, r, cv2.INTER_LINEAR)
    value[~inside] = (0.22, 0.15, 0.1)
    return value


def _blurred(picture, sigma):
    reach = int(np.ceil(4 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    return cv2.sepFilter2D(picture, -1, kernel, kernel, borderType=cv2.BORDER_REPLICATE)


def _blur_along_path(picture, path_px):
    """Average the picture along a straight path, in steps of half a pixel."""
    steps = max(2, round(2 * np.hypot(*path_px)))
    reach = int(np.ceil(0.5 * np.abs(path_px).max())) + 1
    kernel = np.zeros((2 * reach + 1, 2 * reach + 1))
    for share in np.linspace(-0.5, 0.5, steps):
        right, down = share * np.array(path_px)
        (r, fr), (c, fc) = ((int(np.floor(v)), v - np.floor(v)) for v in (-down, -right))
        for dr, wr in ((r, 1 - fr), (r + 1, fr)):
            for dc, wc in ((c, 1 - fc), (c + 1, fc)):
                kernel[reach + dr, reach + dc] += wr * wc / steps
    return cv2.filter2D(picture, -1, kernel, borderType=cv2.BORDER_REPLICATE)
