#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Places and routes what the target synth_ecp5 of rtl/vista_stereo.core has checked with Verilator, whose list of
# sources and parameters it takes. Needs a yosys that has slang, and nextpnr-ecp5; the pins stay open.
set -eu
parameters=$(sed -n 's/^-G/-G /p' ./*.vc)
sources=$(grep '\.sv$' ./*.vc)
echo "read_slang -j 1 --top vista_stereo $parameters $sources" | tr '\n' ' ' >synth.ys
printf '\nsynth_ecp5 -top vista_stereo -json engine.json\n' >>synth.ys
yosys -q -l yosys.log -s synth.ys
nextpnr-ecp5 --25k --package CABGA381 --speed 6 --json engine.json --out-of-context --freq 110 \
  --placer-heap-timingweight 100 --timing-allow-fail --report report.json --quiet --log nextpnr.log
grep -E 'Max frequency|Total LUT4s|DP16KD:|TRELLIS_FF:' nextpnr.log
