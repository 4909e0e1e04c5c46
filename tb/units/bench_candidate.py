"""Winner, uniqueness, sub-pixel and rival of pixel after pixel: steps 3, 5, 7 and 8 of the numpy model."""

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, FallingEdge
from cocotb_helpers import pack, parameter, seeded, start
from vista_model.engine import confidence, subpixel, unique, winner

D, B, CONFIDENCE = (parameter(name) for name in ("NumDisparities", "BlockSize", "Confidence"))
HIGHEST = B * B * 255
COST_W = HIGHEST.bit_length()
LATENCY = (D - 1).bit_length() + 17
RATIO_LEAD = 16  # clocks that a new ratio stands before the first cost
PIXELS = 60


def random_costs(rng):
    """Costs by (pixel, d): wide, in a narrow band, or a valley, which may lie at an end of the range."""
    S = np.empty((PIXELS, D), np.int32)
    for pixel in S:
        floor = int(rng.choice([0, rng.integers(HIGHEST - 100), HIGHEST - 100]))
        pixel[:] = rng.integers(floor, floor + int(rng.choice([1, 4, 100, HIGHEST - floor])) + 1, D)
        if rng.random() < 0.7:
            at = int(rng.choice([0, 1, D - 2, D - 1, rng.integers(D)]))
            valley = pixel[max(0, at - 1) : at + 2]
            valley[:] = rng.integers(floor // 2, floor + 1, len(valley))
    return S


@cocotb.test()
async def candidates_are_the_models(dut):
    random = seeded(dut)
    rng = np.random.default_rng(random.randrange(1 << 30))
    await start(dut, uniqueness_ratio_i=0, cost_i=0)
    winners, verdicts, margins = set(), set(), set()
    for ratio in (1, 15, 99, 100, *rng.integers(1, 101, 12).tolist()):
        S = random_costs(rng)
        planes = S.T[:, None, :]  # d, row, pixel
        dL, smin = winner(planes)
        rival = ~unique(planes, dL, smin, ratio)
        sure = confidence(planes, dL, smin, np.zeros_like(dL)) * CONFIDENCE
        outputs = (dL, smin, rival, subpixel(planes, dL, smin), sure.view(np.int16) >> 8, sure >> 4 & 15)
        expected = list(zip(*(plane[0].tolist() for plane in outputs), strict=True))
        dut.uniqueness_ratio_i.value = ratio
        await ClockCycles(dut.clk_i, RATIO_LEAD, FallingEdge)
        for clock in range(PIXELS + LATENCY):
            if clock >= LATENCY:
                got = (
                    int(dut.winner_o.value), int(dut.smin_o.value), bool(dut.rival_o.value),
                    dut.disparity_o.value.to_signed(), dut.distance_o.value.to_signed(),
                    int(dut.margin_o.value),
                )  # fmt: skip
                assert got == expected[clock - LATENCY], f"u {ratio}, pixel {clock - LATENCY}"
            if clock < PIXELS:
                dut.cost_i.value = pack(S[clock], COST_W)
            await FallingEdge(dut.clk_i)
        winners |= {e[0] for e in expected}
        verdicts |= {e[2] for e in expected}
        margins |= {e[5] for e in expected}
    assert winners >= {0, 1, D - 2, D - 1} and verdicts == {True, False}
    assert margins >= ({0, 1, 15} if CONFIDENCE else {0})
