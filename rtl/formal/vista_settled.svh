// SPDX-License-Identifier: Apache-2.0
// For the properties of a module in simulation: when they are to be looked at. A bench may change the inputs between
// clocks, so they are looked at on the edge. A clock that starts at random may give some modules an edge more: what is
// around this one is reset once the second clock of a reset has passed.

logic f_settled = 1'b0;

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_settled <= f_started;
end
