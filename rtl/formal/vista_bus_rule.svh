// SPDX-License-Identifier: Apache-2.0
// A channel with `valid` and `ready`: what waits stays as it is, from one clock to the next, unless both are in reset.

`ifndef VISTA_BUS_RULE
`define VISTA_BUS_RULE(name, rst_n, valid, ready, payload, kind) \
  logic f_``name``_waited = 1'b0; \
  logic [$bits(payload)-1:0] f_``name``_held; \
  always_ff @(posedge clk_i) begin \
    f_``name``_waited <= rst_n & valid & ~ready; \
    f_``name``_held   <= payload; \
    if (rst_n & f_``name``_waited) kind (valid && payload == f_``name``_held); \
  end
`endif
