"""What the soak over passes of a recording takes for a fault."""

from __future__ import annotations

from soak_passes import Held, faults_of, passes_of

HELD = Held(30.0, 5, 4)


def line(frame: int, t_ns: int, number: int) -> bytes:
    return b'{"frame": %d, "t_ns": %d, "processing_ms": %d.5, "obstacles": [{"id": %d}]}\n' % (
        frame, t_ns, t_ns % 7, number,
    )  # fmt: skip


def flown(passes: int = 10) -> list[bytes]:
    """Passes of two frames, with one obstacle whose number is counted on."""
    return [line(frame, 100 * k + 10 * frame, 3 * k) for k in range(passes) for frame in (5, 6)]


def faults(lines: list[bytes], held: Held | None = HELD) -> list[str]:
    passes = list(passes_of(lines))
    return list(faults_of(((one, HELD if k < 5 else held) for k, one in enumerate(passes)), 10))


def test_passes_that_are_alike_but_for_times_and_numbers_are_right() -> None:
    assert faults(flown()) == faults(flown(), None) == []


def test_what_differs_is_named_with_its_pass() -> None:
    other = flown()
    other[7] = other[7].replace(b"obstacles", b"obstacle")
    assert faults(other) == ["pass 4: its lines are not those of the first"]
    other[7] = line(6, 312, 9)
    assert faults(other) == ["pass 4: its times do not go on by the same step"]
    assert faults(flown(9)) == ["it ended after 9 of 10 passes"]


def test_what_the_process_holds_may_not_grow() -> None:
    for held in (Held(31.0, 5, 4), Held(30.0, 6, 4), Held(30.0, 5, 5)):
        assert faults(flown(), held) == ["it holds more at the end than after a tenth of the passes"]
