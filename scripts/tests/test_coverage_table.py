"""The table of coverage: shares by folder from what gcovr and coverage.py write."""

from coverage_table import lines_by_folder, table

FILES = {"sw/src/a.c": (9, 10), "sw/src/b.c": (0, 10), "sw/apps/c.c": (5, 5)}


def test_lines_of_a_folder_are_added_up() -> None:
    assert lines_by_folder(FILES) == {"sw/apps": (5, 5), "sw/src": (9, 20)}


def test_the_last_line_is_all_folders_together() -> None:
    heading, *rows, together = table("C", FILES)
    assert heading.split() == ["C", "lines", "covered"]
    assert [row.split() for row in rows] == [["sw/apps", "5", "100.0", "%"], ["sw/src", "20", "45.0", "%"]]
    assert together.split() == ["together", "25", "56.0", "%"]
