"""A list of words: read two clocks later, zero when cleared, undefined when read while written."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import parameter, seeded, start

WIDTH, DEPTH = parameter("Width"), parameter("Depth")


@cocotb.test()
async def words_are_those_of_a_list(dut):
    random = seeded(dut)
    await start(dut, clear_i=0, write_i=0, write_col_i=0, write_data_i=0, read_col_i=0)
    memory: list[int | None] = [None] * DEPTH
    read = expected = None  # None: not yet defined
    seen = {"clear": 0, "collision": 0, "word": 0}
    for clock in range(6000):
        if expected is not None:
            assert int(dut.read_data_o.value) == expected, f"clock {clock}"
        clear, write = random.random() < 0.1, random.random() < 0.5
        near = random.randrange(DEPTH)
        write_col, read_col = near, random.choice([near, (near + 1) % DEPTH, random.randrange(DEPTH)])
        data = random.randrange(1 << WIDTH)
        dut.clear_i.value, dut.write_i.value, dut.write_col_i.value = clear, write, write_col
        dut.write_data_i.value, dut.read_col_i.value = data, read_col
        expected, read = 0 if clear else read, memory[read_col]
        collision = write and write_col == read_col
        seen["collision"] += read is not None and collision
        read = None if collision else read
        if write:
            memory[write_col] = data
        seen["clear"] += clear
        seen["word"] += read is not None
        await FallingEdge(dut.clk_i)
    assert min(seen.values()) > 100
