"""Distance and margin of the rival: step 8 of the numpy model, without the texture."""

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge
from cocotb_helpers import pack, parameter, seeded, start
from rtl_package import package_constant
from vista_model.engine import confidence, winner

D, COST_W = parameter("NumDisparities"), parameter("CostW")
WINNER_LATER = package_constant("UniquenessLatency")  # than its costs
LATENCY = WINNER_LATER + package_constant("SubpixelLatency")
PIXELS = 800


def random_costs(rng):
    """Costs by (pixel, d); many a rival costs a whole number of 32nds more than the winner, or nearly so."""
    S = np.empty((PIXELS, D), np.int32)
    for pixel in S:
        scale = int(rng.integers(0, COST_W - 1))
        least = int(rng.choice([0, 1, 2**scale, rng.integers(2**scale)]))
        k = int(rng.choice([0, 1, 15, 16, rng.integers(18)]))
        rival = max(least, (least * k >> 5) + least + int(rng.integers(-1, 2)))
        if rng.random() < 0.2:  # far more than the winner
            rival = int(rng.integers(rival, 2**COST_W - 1))
        pixel[:] = np.minimum(rival + rng.integers(0, rng.choice([1, 3, 2**scale + 1]), D), 2**COST_W - 2)
        pixel[rng.integers(D)] = rival
        at = int(rng.choice([0, 1, D - 2, D - 1, rng.integers(D)]))
        pixel[max(0, at - 1) : at + 2] = min(rival, least + 1)
        pixel[at] = least
    return S


@cocotb.test()
async def distance_and_margin_are_the_models(dut):
    rng = np.random.default_rng(seeded(dut).randrange(1 << 30))
    await start(dut, near_i=0, cost_i=0, winner_i=0, smin_i=0)
    S = random_costs(rng)
    dL, smin = (plane[0] for plane in winner(S.T[:, None, :]))
    both = confidence(S.T[:, None, :], dL, smin, np.zeros((1, PIXELS), np.int32))[0]
    distances, margins = (both.view(np.int16) >> 8).tolist(), (both >> 4 & 15).tolist()
    near = [sum(1 << d for d in range(D) if abs(d - best) <= 1) for best in dL]
    for clock in range(PIXELS + LATENCY):
        if clock >= LATENCY:
            got = dut.distance_o.value.to_signed(), int(dut.margin_o.value)
            assert got == (distances[clock - LATENCY], margins[clock - LATENCY]), f"pixel {clock - LATENCY}"
        if clock < PIXELS:
            dut.cost_i.value, dut.near_i.value = pack(S[clock], COST_W), near[clock]
        if WINNER_LATER <= clock < PIXELS + WINNER_LATER:
            dut.winner_i.value, dut.smin_i.value = (
                int(dL[clock - WINNER_LATER]),
                int(smin[clock - WINNER_LATER]),
            )
        await FallingEdge(dut.clk_i)
    assert set(margins) == set(range(16)) and min(distances) < 0 < max(distances)
