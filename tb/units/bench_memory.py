"""A memory with parity: each upset bit is told of 2 clocks after its word, and nothing else is."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import parameter, seeded, start

WIDTH, DEPTH = parameter("Width"), parameter("Depth")
PIECES = (WIDTH + 15) // 16
TELLS_AFTER = 2


@cocotb.test()
async def an_upset_bit_is_told_of(dut):
    random = seeded(dut)
    clock = dut.clk_i
    dut.write_clk_i.value = 0
    cocotb.start_soon(follow(dut))
    await start(dut, write_i=0, write_addr_i=0, write_data_i=0, read_i=0, read_addr_i=0)
    memory = [0] * DEPTH  # it starts so
    upset: set[int] = set()
    word, told = None, [False] * (TELLS_AFTER + 1)
    seen = {"upset": 0, "collision": 0, "sound": 0}
    for cycle in range(4000):
        assert bool(dut.upset_o.value) == told[0] or cycle < 2 * TELLS_AFTER, f"clock {cycle}"
        if word is not None:
            assert int(dut.read_data_o.value) == word
        if random.random() < 0.05:
            address, bit = random.randrange(DEPTH), random.randrange(WIDTH + PIECES)
            if address not in upset:
                dut.mem[address].value = int(dut.mem[address].value) ^ 1 << bit
                memory[address] ^= (1 << bit) & ((1 << WIDTH) - 1)
                upset.add(address)
        write, read = random.random() < 0.4, random.random() < 0.7
        at = random.randrange(DEPTH)
        address = random.choice([at, random.randrange(DEPTH)])
        data = random.getrandbits(WIDTH)
        dut.write_i.value, dut.write_addr_i.value, dut.write_data_i.value = write, at, data
        dut.read_i.value, dut.read_addr_i.value = read, address
        collision = write and at == address
        if read:
            word = None if collision else memory[address]
        wrong = read and not collision and address in upset
        told = [*told[1:], wrong]
        seen["upset"] += wrong
        seen["collision"] += read and collision and at in upset
        seen["sound"] += read and not wrong
        await FallingEdge(clock)
        if write:
            memory[at] = data
            upset.discard(at)
    assert min(seen.values()) > 10


async def follow(dut):
    """Both ports have one clock."""
    while True:
        await dut.clk_i.value_change
        dut.write_clk_i.value = dut.clk_i.value
