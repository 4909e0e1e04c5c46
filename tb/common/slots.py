"""Slots as the stages see them (rtl/src/vista_stereo_pkg.sv), for the benches of single stages."""

from __future__ import annotations

from collections.abc import Iterator

from rtl_package import struct_bits, struct_fields

_FIELDS = struct_fields("slot_t")


def slot_bits(**fields: bool) -> int:
    """The packed struct slot_t; fields that are not named are 0."""
    return struct_bits(_FIELDS, fields)


def frame_slots(
    width: int, height: int, num_disparities: int, block_size: int
) -> Iterator[tuple[int, int, int]]:
    """(row, column, slot_t) of every slot of a frame."""
    for row in range(height):
        for col in range(width):
            yield row, col, slot_bits(
                valid=True, first_col=col == 0, last_col=col == width - 1,
                before_col=col < num_disparities - 1, early_col=col < num_disparities - 1 + block_size,
                first_row=row == 0, last_row=row == height - 1,
                flat=row == height - 1 and height % 2 == 1, leave=row >= block_size,
                match_row=row >= block_size - 1 and width >= num_disparities + 2 * (block_size // 2),
                match=row >= block_size - 1 and col >= num_disparities - 1 + 2 * (block_size // 2),
            )  # fmt: skip
