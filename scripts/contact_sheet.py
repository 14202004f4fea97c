#!/usr/bin/env python3
"""Put pictures side by side, labelled, on one sheet.

Every pixel of a picture is one pixel of the sheet, so that nothing is blurred or resampled. With
--crop there is also one region of each picture below it, enlarged by a whole factor with hard
pixels, to compare the edges of shadows.

The same pictures give the same bytes: the sheet carries no date and uses the font that comes with
matplotlib.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from PIL import Image

DPI = 100
MARGIN = 24  # pixels around the sheet and between the pictures
LABEL = 40  # height of a label's strip, below its picture
TITLE = 64  # height of the title's strip
LABEL_POINTS, TITLE_POINTS = 12.0, 18.0
SMALLEST_POINTS = 6.0
INK, FRAME = "#202020", "#ff8c00"

Box = tuple[int, int, int, int]  # x0, y0, x1, y1 in pixels, x1 and y1 outside


class SheetError(Exception):
    """What is wrong with a picture or an option, in one line."""


@dataclass(frozen=True)
class Cell:
    """A picture, 8-bit sRGB, and what is written below it."""

    pixels: np.ndarray
    label: str


def read_srgb(path: Path) -> np.ndarray:
    """A PNG as height x width x 3 bytes. Colour PNGs of 16 bits come from Pillow as 8."""
    try:
        with Image.open(path) as image:
            if image.mode.startswith("I"):  # 16-bit grey: Pillow would clip it, not scale it
                grey = np.rint(np.asarray(image, dtype=np.float64) / 257.0).astype(np.uint8)
                return np.repeat(grey[:, :, None], 3, axis=2)
            return np.asarray(image.convert("RGB"))
    except FileNotFoundError:
        raise SheetError(f"{path}: no such picture; has it been rendered?") from None
    except (OSError, SyntaxError) as error:  # Pillow raises both for broken files
        raise SheetError(f"{path}: cannot be read as a picture: {error}") from None


def parse_crop(text: str) -> Box:
    """X0,Y0,X1,Y1 as whole pixels with X0 < X1 and Y0 < Y1."""
    try:
        x0, y0, x1, y1 = (int(word) for word in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not X0,Y0,X1,Y1 in whole pixels") from None
    if not (0 <= x0 < x1 and 0 <= y0 < y1):
        raise argparse.ArgumentTypeError(f"'{text}' is empty or negative: 0 <= X0 < X1 and 0 <= Y0 < Y1")
    return x0, y0, x1, y1


def positive(text: str) -> int:
    """A whole number above 0."""
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number above 0")
    return int(text)


def enlarged(pixels: np.ndarray, crop: Box) -> np.ndarray:
    """The region, every pixel repeated as often as fits the picture's own width and height."""
    x0, y0, x1, y1 = crop
    height, width = pixels.shape[:2]
    if x1 > width or y1 > height:
        raise SheetError(f"--crop {x0},{y0},{x1},{y1} leaves a picture of {width}x{height} pixels")
    factor = min(width // (x1 - x0), height // (y1 - y0))
    return pixels[y0:y1, x0:x1].repeat(factor, axis=0).repeat(factor, axis=1)


class Sheet:
    """A figure of an exact number of pixels, addressed from its top left corner."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor="white")

    def picture(self, pixels: np.ndarray, x: int, y: int) -> None:
        """Put the pixels, as they are, with their top left corner at x, y."""
        self.figure.figimage(pixels, xo=x, yo=self.height - y - pixels.shape[0], origin="upper")

    def frame(self, x: int, y: int, width: int, height: int) -> None:
        """Draw a thin frame around (outside of) a rectangle."""
        corner = (x - 1) / self.width, 1 - (y + height + 1) / self.height
        size = (width + 2) / self.width, (height + 2) / self.height
        self.figure.add_artist(
            Rectangle(corner, *size, transform=self.figure.transFigure, fill=False, ec=FRAME, lw=2 * 72 / DPI)
        )

    def text(self, text: str, x: float, y: float, room: int, points: float, weight: str) -> None:
        """Write a line centred on x, y, made smaller where it is wider than the room."""
        line = self.figure.text(
            x / self.width,
            1 - y / self.height,
            text,
            size=points,
            weight=weight,
            color=INK,
            ha="center",
            va="center",
            parse_math=False,
        )
        # The width does not follow the size exactly (glyphs sit on whole pixels): shrink step by step.
        while line.get_window_extent().width > room:
            points -= 0.25
            if points < SMALLEST_POINTS:
                raise SheetError(f"'{text}' is too long for a width of {room} pixels")
            line.set_fontsize(points)

    def save(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.figure.savefig(path, dpi=DPI, metadata={"Software": None})


def make_sheet(cells: list[Cell], title: str, columns: int, crop: Box | None) -> Sheet:
    """Lay the cells out in rows; a cell is as large as the largest picture."""
    columns = min(columns, len(cells))
    rows = -(-len(cells) // columns)
    width = max(cell.pixels.shape[1] for cell in cells)
    height = max(cell.pixels.shape[0] for cell in cells)
    crops = [enlarged(cell.pixels, crop) if crop else None for cell in cells]
    crop_height = max((MARGIN // 2 + part.shape[0] for part in crops if part is not None), default=0)
    row_height = height + crop_height + LABEL
    top = TITLE if title else MARGIN
    sheet = Sheet(MARGIN + columns * (width + MARGIN), top + rows * row_height + MARGIN // 2)
    if title:
        sheet.text(title, sheet.width / 2, TITLE / 2, sheet.width - 2 * MARGIN, TITLE_POINTS, "bold")
    for index, (cell, part) in enumerate(zip(cells, crops, strict=True)):
        row, column = divmod(index, columns)
        left, above = MARGIN + column * (width + MARGIN), top + row * row_height
        x = left + (width - cell.pixels.shape[1]) // 2
        y = above + height - cell.pixels.shape[0]  # smaller pictures stand on the common base line
        sheet.picture(cell.pixels, x, y)
        if crop and part is not None:
            x0, y0, x1, y1 = crop
            sheet.frame(x + x0, y + y0, x1 - x0, y1 - y0)
            part_x, part_y = left + (width - part.shape[1]) // 2, above + height + MARGIN // 2
            sheet.picture(part, part_x, part_y)
            sheet.frame(part_x, part_y, part.shape[1], part.shape[0])
        sheet.text(cell.label, left + width / 2, above + row_height - LABEL / 2, width, LABEL_POINTS, "normal")
    return sheet


def read_cells(arguments: list[str]) -> list[Cell]:
    """FILE=LABEL arguments; all that are missing are named at once."""
    cells, faults = [], []
    for argument in arguments:
        name, _, label = argument.partition("=")
        try:
            cells.append(Cell(read_srgb(Path(name)), label or Path(name).stem))
        except SheetError as error:
            faults.append(str(error))
    if faults:
        raise SheetError("\n".join(faults))
    return cells


def main() -> int:
    parser = argparse.ArgumentParser(description="Put pictures side by side, labelled and unscaled, on one sheet.")
    parser.add_argument("pictures", nargs="+", metavar="FILE=LABEL", help="an sRGB PNG and the text below it")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the sheet, a PNG")
    parser.add_argument("--title", default="", help="the line above all pictures")
    parser.add_argument("--columns", type=positive, default=3, help="pictures in a row (default: %(default)s)")
    parser.add_argument(
        "--crop", type=parse_crop, metavar="X0,Y0,X1,Y1", help="also show this region of each picture, enlarged"
    )
    options = parser.parse_args()
    matplotlib.rcdefaults()  # not the user's own style
    try:
        cells = read_cells(options.pictures)
        make_sheet(cells, options.title, options.columns, options.crop).save(options.output)
    except SheetError as error:
        for line in str(error).splitlines():
            print(f"contact_sheet: {line}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"contact_sheet: cannot write the sheet: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
