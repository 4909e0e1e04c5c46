"""Who may import whom: the product knows nothing of what evaluates it."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest
from vista_eval.cache import our_packages

MAY_IMPORT = {
    "vista": {"vista"},
    "vista_eval": {"vista", "vista_eval"},
    "vista_throughput": {"vista", "vista_throughput"},
}


def imported(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module or ""


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_packages_import_those_below_only(package: str) -> None:
    folder = dict(our_packages())[package]
    files = list(folder.rglob("*.py"))
    assert len(files) > 10
    for file in files:
        ours = {name.split(".")[0] for name in imported(ast.parse(file.read_text()))} & set(MAY_IMPORT)
        assert ours <= MAY_IMPORT[package], file
