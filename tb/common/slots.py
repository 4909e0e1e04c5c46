"""Slots as the stages see them (rtl/src/vista_stereo_pkg.sv), for the benches of single stages."""

from __future__ import annotations

from collections.abc import Iterator

FIELDS = (
    "valid", "first_col", "last_col", "before_col", "early_col", "first_row", "last_row", "flat", "leave",
    "match_row", "match", "cut",
)  # fmt: skip


def slot_bits(**fields: bool) -> int:
    """The packed struct slot_t; fields that are not named are 0."""
    assert set(fields) <= set(FIELDS)
    return sum(bool(fields.get(name)) << len(FIELDS) - 1 - i for i, name in enumerate(FIELDS))


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
