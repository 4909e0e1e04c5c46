#!/bin/bash
# Writes the bill of materials of what is installed to run VISTA (CycloneDX, build/bom.json), and looks the same pinned
# versions up in PyPI's database of vulnerabilities: make audit
set -euo pipefail
cd "$(dirname "$0")/.."
readonly tools=build/audit-tools pinned=scripts/requirements/run.txt
[ -x $tools/bin/pip-audit ] || { python3 -m venv $tools && $tools/bin/pip install --quiet cyclonedx-bom==7.5.0 pip-audit==2.10.1; }
$tools/bin/cyclonedx-py requirements --pyproject pyproject.toml --output-reproducible -o build/bom.json $pinned 2>/dev/null
echo "bill of materials: build/bom.json"
$tools/bin/pip-audit --strict --disable-pip --require-hashes --progress-spinner off --requirement $pinned
