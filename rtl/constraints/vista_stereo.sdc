# SPDX-License-Identifier: Apache-2.0
# Constraints of vista_stereo in SDC, which Vivado, Quartus and OpenSTA read: one clock. Streams and registers begin and
# end in registers of the core but for a gate (doc/porting.md), so a third of the clock is left to what is around it.
create_clock -name clk_i -period 8.0 [get_ports clk_i]
set_input_delay 2.7 -clock clk_i [all_inputs]
set_output_delay 2.7 -clock clk_i [all_outputs]
