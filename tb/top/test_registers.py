"""Registers against their description: reset values, access, absent fields, and the build read back."""

from __future__ import annotations

import numpy as np
import pytest
from registers import (
    ADDRESS_BITS,
    BUILD,
    BUILD_FRONT_END,
    BUILD_SIZE,
    CONFIDENCE,
    CONTROL,
    ID,
    INTERRUPT,
    MAP,
    MAP_READY,
    OUTPUT,
    SLVERR,
    STOPPED,
    VERSION,
    registers,
)
from verilated import FRONT_END, Config, Rtl

pytestmark = pytest.mark.slow

WITH_CONFIDENCE = Config(48, 7, 256, confidence=True)
CONFIGS = [Config(16, 5), Config(32, 11), FRONT_END, WITH_CONFIDENCE]
BUILD_FIELDS = {BUILD, BUILD_SIZE, BUILD_FRONT_END, MAP}


@pytest.mark.parametrize("config", CONFIGS, ids=lambda c: c.name)
def test_reset_values_and_build(config: Config) -> None:
    with Rtl(config) as rtl:
        for name, (address, fields) in registers().items():
            if address not in BUILD_FIELDS:
                assert rtl.read(address) == sum((f.reset or 0) << f.low for f in fields), name
        assert rtl.read(ID).to_bytes(4, "big") == b"VSTE"
        assert rtl.read(VERSION) >> 16 == 2
        confidence = CONFIDENCE * config.confidence
        assert rtl.read(BUILD) == config.num_disparities | config.block_size << 16 | confidence
        assert rtl.read(BUILD_SIZE) == config.max_width | 4095 << 16
        front_end = config.rows | config.points << 8 if config.rows else 0
        assert (rtl.read(BUILD_FRONT_END), rtl.read(MAP)) == (front_end, MAP_READY if front_end else 0)


def test_every_field_keeps_what_is_written_and_nothing_else_changes() -> None:
    rng = np.random.default_rng(1)
    with Rtl(WITH_CONFIDENCE) as rtl:
        values = {address: rtl.read(address) for address, _ in registers().values()}
        for name, (address, fields) in registers().items():
            writable = sum(f.mask for f in fields if f.kept and not f.clears and not f.pulse)
            for data in (0xFFFFFFFF, 0, 0xA5A5A5A5, *map(int, rng.integers(0, 1 << 32, 8))):
                rtl.write(address, data)
                values[address] = values[address] & ~writable | data & writable
                assert rtl.read(address) == values[address], f"{name} after {data:08x}"
            if address == CONTROL:
                rtl.write(INTERRUPT, STOPPED)  # told when enable fell
            assert {a: rtl.read(a) for a in values} == values, f"writing {name} changed another register"


def test_a_confidence_that_is_not_built_cannot_be_asked_for() -> None:
    with Rtl(Config(16, 5)) as rtl:
        rtl.write(OUTPUT, 3)
        assert rtl.read(OUTPUT) == 1


def test_addresses_do_not_overlap() -> None:
    addresses = [address for address, _ in registers().values()]
    assert len(set(addresses)) == len(addresses)
    for _, fields in registers().values():
        assert sum(f.mask for f in fields) == int(np.bitwise_or.reduce([f.mask for f in fields]))


@pytest.mark.parametrize("config", CONFIGS[:1], ids=lambda c: c.name)
def test_an_address_without_a_register_is_an_error(config: Config) -> None:
    """Reads and writes: SLVERR, and nothing changes."""
    mapped = {address for address, _ in registers().values()}
    with Rtl(config) as rtl:
        before = {address: rtl.read(address) for address in mapped}
        for address in range(0, 1 << ADDRESS_BITS, 4):
            response = 0 if address in mapped else SLVERR
            rtl.read(address)
            assert rtl.response() == response, hex(address)
            if address not in mapped:
                rtl.write(address, 0xFFFFFFFF)
                assert rtl.response() == response, hex(address)
        assert {address: rtl.read(address) for address in mapped} == before
