"""The planner on recorded frames: how long a decision takes, for goals and speeds in many directions.

Each frame of KITTI odometry 00 is judged once, and then asked for decisions at four speeds, to goals ahead
and aside, with a planner that begins anew each time. Where the frames are not there, it says so. Times are
processor time of the thread, since wall time counts what else the machine does.

    bench_plan.py [--frames 51] [--out build/bench/plan.json]
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPOSITORY / "sw" / "tests"), str(REPOSITORY / "build" / "python")]

from shared_data import SHARED_DATA  # noqa: E402
from vista import parameters  # noqa: E402
from vista.chain import make_chain, run_frame  # noqa: E402
from vista.native import load  # noqa: E402
from vista.plan import Decision, Goal, Planner, State  # noqa: E402
from vista.sequence import open_sequence  # noqa: E402
from vista_eval.report.table import Table, write_measurement  # noqa: E402

STREET = SHARED_DATA / "kitti_odometry" / "sequences" / "00"
SPEEDS_M_S = (2.0, 5.0, 10.0, 15.0)
ASIDE = (-1.0, -0.4, 0.0, 0.4, 1.0)  # of the way to the goal, to the right
RADIUS_M = 1.0
TARGET_MS = 2.0  # at the 99.9th percentile


def decide(planner: Planner, handle: object, arguments: tuple[object, ...]) -> float:
    """Milliseconds of one decision."""
    planner.reset()
    _, lib = load("vista")
    start_ns = time.thread_time_ns()
    status = lib.vista_planner_decide(handle, *arguments)
    took_ns = time.thread_time_ns() - start_ns
    assert status == lib.VISTA_OK
    return 1e-6 * took_ns


def measure(vehicle: str, frames: int) -> tuple[list[float], list[int]]:
    """Times of decisions, and the places that were asked for."""
    sequence = open_sequence(STREET)
    values = parameters.defaults()
    values["obstacle_map"]["collision_radius_m"] = RADIUS_M
    values["plan"]["vehicle"] = vehicle
    chain, planner = make_chain(sequence, "golden", values, threads=1), Planner(values)
    up = np.array([0.0, -1.0, 0.0]) if sequence.up_world is None else np.asarray(sequence.up_world)
    ffi, _ = load("vista")
    out, times_ms, looks = ffi.new("vista_plan_decision *"), [], []
    for files in sequence.frames[:frames]:
        step = run_frame(chain, files)
        pose = step.result.outcome.motion.pose
        ahead, right = pose.rotation[:, 2], pose.rotation[:, 0]
        for speed_m_s in SPEEDS_M_S:
            for aside in ASIDE:
                way = ahead + aside * right
                state = State.made(
                    t_ns=step.raw.t_ns,
                    position_m=pose.translation_m,
                    velocity_m_s=speed_m_s * ahead,
                    up=up,
                    heading=ahead,
                )
                goal = Goal.made(
                    from_m=pose.translation_m,
                    to_m=pose.translation_m + 200.0 * way / np.linalg.norm(way),
                    speed_m_s=speed_m_s,
                    passed=True,
                )
                given = (chain.detector.in_c, state.in_c(), goal.in_c(), out)
                times_ms.append(decide(planner, planner.in_c, given))
                looks.append(Decision.copied(ffi, out).looks)
    return times_ms, looks


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=51)
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    if not STREET.is_dir():
        print(f"{STREET} is not there: nothing was measured")
        return 0
    print(f"load of the machine before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors\n")
    rows, figures = [], {}
    for vehicle in ("multirotor", "fixed_wing"):
        times_ms, looks = measure(vehicle, arguments.frames)
        shares = [float(np.percentile(times_ms, share)) for share in (50.0, 99.0, 99.9)]
        figures[vehicle] = {
            "decisions": len(times_ms),
            "median_p99_p999_ms": shares,
            "most_looks": max(looks),
        }
        rows.append((vehicle, f"{len(times_ms)}", *(f"{ms:.2f}" for ms in shares), f"{max(looks)}"))
    heads = ("vehicle", "decisions", "median ms", "p99 ms", "p99.9 ms", "places, most")
    legend = (
        f"KITTI odometry 00, 1226x370, four speeds and five goals a frame; target {TARGET_MS} ms at p99.9."
    )
    table = Table("plan-decisions", heads, rows, legend)
    print(table.as_text())
    if arguments.out is not None:
        write_measurement(arguments.out, [table], figures, target_ms=TARGET_MS)
    return 0


if __name__ == "__main__":
    sys.exit(main())
