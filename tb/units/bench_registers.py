"""A write has taken effect in the clock in which its response comes, and nothing else has changed."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb_helpers import parameter, seeded, start
from frames import params_bits, random_frame, register_values
from registers import COMMIT, COMMIT_SET, CONTROL, ENABLE, FRONT_END, SOFT_RESET
from rtl_package import struct_bits, struct_fields

D, B, MAX_WIDTH = (parameter(name) for name in ("NumDisparities", "BlockSize", "MaxWidth"))
FRONT_END_FIELDS = struct_fields("front_end_t")
IN_FORCE = ("enable_o", "width_o", "height_o", "params_o", "front_end_o", "rst_no")
MOST_CLOCKS = 40


async def written(dut, random, address, data):
    """Writes at any pace, address and data in any order. Returns what is in force in the first clock of the
    response, and whether what is behind the registers was reset between the request and that clock."""
    waits = {"aw": random.randrange(4), "w": random.randrange(4)}
    dut.s_axil_awaddr.value, dut.s_axil_wdata.value = address, data
    seen, was_reset = None, False
    for clock in range(MOST_CLOCKS):
        for channel, wait in waits.items():
            getattr(dut, f"s_axil_{channel}valid").value = clock >= wait
        dut.s_axil_bready.value = random.randrange(2)
        await ReadOnly()
        for channel in [c for c in waits if getattr(dut, f"s_axil_{c}valid").value]:
            if getattr(dut, f"s_axil_{channel}ready").value:
                waits[channel] = MOST_CLOCKS  # taken
        if dut.s_axil_bvalid.value and seen is None:
            seen = {name: int(getattr(dut, name).value) for name in IN_FORCE}
        was_reset |= seen is None and not dut.rst_no.value
        over = dut.s_axil_bvalid.value and dut.s_axil_bready.value
        await FallingEdge(dut.clk_i)
        if over:
            return seen, was_reset
    raise AssertionError("no response")


def in_force_of(frame, front_end):
    height, width = frame.shape
    return {
        "width_o": width,
        "height_o": height,
        "params_o": params_bits(frame.parameters, frame.narrow, frame.confidence),
        "front_end_o": struct_bits(FRONT_END_FIELDS, front_end),
    }


@cocotb.test()
async def writes_have_taken_effect_with_their_response(dut):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    bus = [
        "awvalid",
        "awaddr",
        "awprot",
        "wvalid",
        "wdata",
        "bready",
        "arvalid",
        "araddr",
        "arprot",
        "rready",
    ]
    idle = [
        *(f"s_axil_{name}" for name in bus),
        "map_ready_i",
        "lost_i",
        "events_i",
        "busy_i",
        "stall_in_i",
        "word_i",
    ]
    await start(dut, s_axil_wstrb=15, word_ready_i=1, **dict.fromkeys(idle, 0))
    await ReadOnly()
    wanted = {name: int(getattr(dut, name).value) for name in IN_FORCE} | {"rst_no": 1}
    await FallingEdge(dut.clk_i)
    for _ in range(40):
        frame = random_frame(rng, D, B, MAX_WIDTH)
        frame.narrow, frame.confidence = map(bool, rng.integers(2, size=2))
        front_end = {
            "rectify": random.randrange(2),
            "levels": random.randrange(1, 5),
            "smooth": random.randrange(2),
        }
        bits = front_end["smooth"] | front_end["rectify"] << 1 | front_end["levels"] << 8
        writes = [*register_values(frame).items(), (FRONT_END, bits)]
        writes = [write for write in writes if write[0] != COMMIT]
        random.shuffle(writes)
        writes.append((COMMIT, COMMIT_SET))
        for _ in range(random.randrange(4)):
            control = random.randrange(2) * ENABLE | random.randrange(2) * SOFT_RESET
            writes.insert(random.randrange(len(writes) + 1), (CONTROL, control))
        for address, data in writes:
            seen, was_reset = await written(dut, random, address, data)
            if address == COMMIT:
                wanted |= in_force_of(frame, front_end)
            elif address == CONTROL:
                wanted["enable_o"] = data & ENABLE
            assert seen == wanted, f"after {data:#x} to {address:#x}: {seen}, wanted {wanted}"
            resets = address == CONTROL and data & SOFT_RESET != 0
            assert was_reset == resets, f"after {data:#x} to {address:#x}: reset {was_reset}"
