"""|dL - dR(x - dL)| <= lr_max_diff, over rows with pauses as the chain of the right winners gives them."""

import cocotb
from cocotb.triggers import FallingEdge
from cocotb_helpers import parameter, seeded, start
from rtl_package import package_constant

D, COST_W, RING_W = (parameter(name) for name in ("NumDisparities", "CostW", "RingW"))
CANDIDATE_LATENCY = (D - 1).bit_length() + sum(
    package_constant(f"{stage}Latency") for stage in ("Threshold", "Uniqueness", "Subpixel")
)
CHECK_DELAY = max(0, CANDIDATE_LATENCY + 2 - (D - 1))
LATENCY = 6
ROW_GAP = D - 1 + 4  # of the smallest block
INVALID, NO_SMIN = -16, 0xFFFF


def random_rows(random, max_diff):
    """Inputs and expected outputs by clock: (candidates, slots, results)."""
    candidates, slots, results = {}, {}, {}
    clock = index = 0
    pauses = random.choice([0, 0.3])
    for width in (1, 2, D, random.randrange(1, 4 * D)):
        base = random.randrange(D)
        spread = random.choice([2, D])
        right = [
            min(D - 1, max(0, base + random.randrange(-spread, spread + 1))) for _ in range(width + D - 1)
        ]
        left = [random.choice([0, D - 1, base, random.randrange(D)]) for _ in range(width)]
        cut_from = random.choice([width + D, random.randrange(width + D)])
        pixels = []
        for slot in range(width + D - 1):
            while slot < width and random.random() < pauses:
                clock += 1
            if slot < width:
                smin = random.choice([0, (1 << COST_W) - 2, random.randrange((1 << COST_W) - 1)])
                pixels.append((random.random() < 0.8, left[slot], smin, random.randrange(-8, 16 * D)))
                candidates[clock + CANDIDATE_LATENCY] = (index, *pixels[slot])
            slots[clock + 1] = (index, right[slot], slot >= D - 1, slot >= cut_from)
            if slot >= D - 1:
                ok, winner, smin, disparity = pixels[slot - (D - 1)]
                # The right pixel x - dL is as many slots before the one that decides x.
                stands = ok and (max_diff is None or abs(winner - right[slot - winner]) <= max_diff)
                cut = slot >= cut_from
                results[clock + 1 + CHECK_DELAY + LATENCY] = (
                    disparity if stands and not cut else INVALID,
                    NO_SMIN if cut else min(smin, NO_SMIN),
                )
            clock, index = clock + 1, (index + 1) % (1 << RING_W)
        clock += ROW_GAP - (D - 1)
    return candidates, slots, results


@cocotb.test()
async def verdicts_are_the_contracts(dut):
    random = seeded(dut)
    await start(
        dut, lr_enable_i=0, lr_max_diff_i=0, candidate_valid_i=0, slot_valid_i=0, decided_i=0, cut_i=0
    )
    invalid = valid = 0
    for max_diff in (None, 0, 1, 2, D - 2, 255, None, 0, 3, random.randrange(D)):
        candidates, slots, results = random_rows(random, max_diff)
        dut.lr_enable_i.value = max_diff is not None
        dut.lr_max_diff_i.value = random.randrange(256) if max_diff is None else max_diff
        for clock in range(max(results) + 2):
            expected = results.get(clock)
            assert bool(dut.valid_o.value) == (expected is not None), f"clock {clock}"
            if expected is not None:
                assert (dut.disparity_o.value.to_signed(), int(dut.smin_o.value)) == expected, (
                    f"clock {clock}"
                )
                invalid, valid = invalid + (expected[0] == INVALID), valid + (expected[0] != INVALID)
            # What is not valid may be anything.
            index, ok, winner, smin, disparity = candidates.get(
                clock, (random.randrange(1 << RING_W), 1, 0, 0, 0)
            )
            dut.candidate_valid_i.value, dut.candidate_index_i.value = clock in candidates, index
            dut.candidate_ok_i.value, dut.candidate_winner_i.value = ok, winner
            dut.candidate_smin_i.value, dut.candidate_disparity_i.value = smin, disparity
            index, winner, decided, cut = slots.get(
                clock, (random.randrange(1 << RING_W), random.randrange(D), False, random.random() < 0.5)
            )
            dut.slot_valid_i.value, dut.slot_index_i.value = clock in slots, index
            dut.right_winner_i.value, dut.decided_i.value, dut.cut_i.value = winner, decided, cut
            await FallingEdge(dut.clk_i)
    assert min(invalid, valid) > 50
