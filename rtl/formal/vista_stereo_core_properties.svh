// SPDX-License-Identifier: Apache-2.0
// Properties of vista_stereo_core, looked at in simulation: the beginning of a frame has a clock of its own, between the
// results of the frame before it and those of its own; so no frame has too few results or too many.

logic f_started = 1'b0;

always_ff @(posedge clk_i) if (!rst_ni) f_started <= 1'b1;

`include "vista_settled.svh"

always_ff @(posedge clk_i) if (f_settled && rst_ni) begin
  assert (!(begins & result_valid));
  assert (!upset[8]);
end
