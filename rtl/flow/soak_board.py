# SPDX-License-Identifier: Apache-2.0
"""Sends random pairs to the simulated board over UDP, whose link drops, doubles and damages packets, and
compares every word with the C model.

Frames of 640x480, and with --kitti FOLDER a crop of a pair of KITTI 2012, go through `make board-sim D=32
B=11 W=640 R=32` as the client of libvista sends and fetches them, two at a time on the board. Sessions of one
to four frames follow each other, each with parameters, levels, smoothing and a map drawn anew. A frame takes
some 7 s.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import deque
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image
from simulated_board import program_of, running
from vista.engine import EngineParameters, StereoEngine
from vista.engine.board import BoardClient, BoardError
from vista.rectify import by_table

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / p) for p in ("scripts", "tb/common", "model", "build/python")]
from frames import IMAGE_KINDS, random_pair, random_parameters  # noqa: E402
from make_tables import as_text  # noqa: E402
from maps import Grids, random_grids  # noqa: E402

DISPARITIES, BLOCK_PX, WIDTH_PX, HEIGHT_PX, ROWS = 32, 11, 640, 480, 32
TIMEOUT_MS = 1_200_000  # a busy machine may let the simulation stand still for minutes
FRAMES_EACH_SESSION = 4  # at most

Pair = tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8]]


class Session:
    """What is drawn for a session: parameters, and a map of both cameras in two of three."""

    def __init__(self, rng: np.random.Generator, shape: tuple[int, int]) -> None:
        drawn = asdict(random_parameters(rng, DISPARITIES, BLOCK_PX))
        self.parameters = EngineParameters(
            **drawn, smooth=bool(rng.integers(2)), levels=int(rng.integers(1, 5))
        )
        self.grids: Grids | tuple[()] = random_grids(rng, ROWS, *shape) if rng.random() < 2 / 3 else ()

    def words(self, pair: Pair) -> npt.NDArray[np.int16]:
        """Words of the C model."""
        left, right = pair
        if len(self.grids):
            left, right = (by_table(grid)(image) for grid, image in zip(self.grids, pair, strict=True))
        levels = StereoEngine(**asdict(self.parameters)).compute_levels(left, right)
        return np.concatenate([words.ravel() for words in levels])

    def __str__(self) -> str:
        parts = [f"{self.parameters.levels} levels", "smoothed" * self.parameters.smooth]
        return ", ".join(filter(None, [*parts, "rectified" * bool(len(self.grids))]))


class Totals:
    def __init__(self) -> None:
        self.sent = self.answered = self.words = self.matched = self.differing = 0

    def compare(self, found: npt.NDArray[np.int16], wanted: npt.NDArray[np.int16]) -> None:
        self.answered += 1
        self.words += wanted.size
        self.matched += int((wanted >= 0).sum())
        self.differing += int((found != wanted).sum())


def textured_pair(rng: np.random.Generator) -> Pair:
    """Two of three times a texture on a slanted plane, else any of those that the benches know."""
    kind = "shifted" if rng.random() < 2 / 3 else str(rng.choice(IMAGE_KINDS))
    return random_pair(rng, kind, HEIGHT_PX, WIDTH_PX)


def kitti_crop(folder: Path) -> Pair:
    """The middle of the first pair with an even number."""
    pairs = sorted(p.name for p in folder.glob("*_0/*_10.png") if int(p.name[:6]) % 2 == 0)
    if not pairs:
        sys.exit(f"soak_board: {folder} has no pair of KITTI 2012")
    found = []
    for camera in (0, 1):
        path = next(folder.glob(f"*_{camera}/{pairs[0]}"))
        image = np.asarray(Image.open(path))
        first = (image.shape[1] - WIDTH_PX) // 2
        found.append(np.ascontiguousarray(image[:, first : first + WIDTH_PX]))
    return found[0], found[1]


def session_of_pairs(client: BoardClient, session: Session, pairs: list[Pair], totals: Totals) -> None:
    """Two frames are on the board, but for the first and the last. A frame that the client gives up is lost;
    the session is then begun again for those that follow."""
    height, width = pairs[0][0].shape
    client.configure(session.parameters, width, height, session.grids)
    waiting: deque[Pair] = deque()
    for pair in [*pairs, None]:
        try:
            if pair is not None:
                totals.sent += 1
                client.submit(*pair)
                waiting.append(pair)
            if len(waiting) == 2 or (pair is None and waiting):
                found = client.collect()
                totals.compare(found, session.words(waiting.popleft()))
        except BoardError as error:
            print(f"soak_board: {error}; the session is begun again", flush=True)
            waiting.clear()
            client.configure(session.parameters, width, height, session.grids)


def run(port: int, args: argparse.Namespace, totals: Totals) -> Any:
    rng = np.random.default_rng(args.seed)
    client = BoardClient("127.0.0.1", port, TIMEOUT_MS)
    left_over = args.frames
    crop = kitti_crop(args.kitti) if args.kitti else None
    while left_over > 0 or crop:
        begin = time.monotonic()
        if crop:
            pairs, crop = [crop], None
        else:
            pairs = [
                textured_pair(rng)
                for _ in range(min(left_over, int(rng.integers(1, FRAMES_EACH_SESSION + 1))))
            ]
            left_over -= len(pairs)
        session = Session(rng, pairs[0][0].shape)
        session_of_pairs(client, session, pairs, totals)
        seconds = (time.monotonic() - begin) / len(pairs)
        print(
            f"{totals.sent} frames, {totals.sent - totals.answered} lost, "
            f"{totals.differing} differing words; {session}: {seconds:.0f} s a frame",
            flush=True,
        )
    return client.counts


def table_of(found: dict[str, Any]) -> dict[str, Any]:
    packets = found["packets"]
    numbers = {
        "frames sent": found["frames"],
        "answered": found["answered"],
        "reported lost": found["lost"],
        "words compared": found["words"],
        "of which with a disparity": found["matched_words"],
        "words that differ": found["differing_words"],
        "packets": packets["packets"],
        "dropped": packets["dropped"],
        "doubled": packets["doubled"],
        "damaged, half of them cut off": packets["damaged"],
        "chunks of pixels sent again": found["chunks_sent_again"],
    }
    rows = [[name, f"{number:,}"] for name, number in numbers.items()]
    return {"name": "board-soak", "heads": ["through the simulated system", "count"], "rows": rows}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=100, help="of 640x480 (100)")
    parser.add_argument("--kitti", type=Path, help="folder of KITTI 2012, of which a crop goes first")
    parser.add_argument("--drop", type=float, default=0.01, help="share of packets that are lost (0.01)")
    parser.add_argument("--double", type=float, default=0.01, help="share of packets that come twice (0.01)")
    parser.add_argument(
        "--damage",
        type=float,
        default=0.01,
        help="share of packets to the board with a wrong bit or cut off (0.01)",
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "board" / "soak.json")
    args = parser.parse_args()
    totals = Totals()
    program = program_of("board-sim", DISPARITIES, BLOCK_PX, WIDTH_PX, ROWS)
    options = ["--drop", args.drop, "--double", args.double, "--damage", args.damage, "--seed", args.seed]
    with running(program, *map(str, options)) as board:
        counts = run(board.port, args, totals)
    found = {
        "seed": args.seed,
        "frames": totals.sent,
        "answered": totals.answered,
        "lost": totals.sent - totals.answered,
        "words": totals.words,
        "matched_words": totals.matched,
        "differing_words": totals.differing,
        "packets": board.packets,
        "chunks_sent_again": counts.chunks_sent_again,
        "chunks_received_again": counts.chunks_received_again,
        "retries": counts.retries,
    }
    args.out.write_text(as_text({"tables": [table_of(found)], "figures": found}) + "\n")
    print(as_text(found))
    return int(totals.differing > 0)


if __name__ == "__main__":
    sys.exit(main())
