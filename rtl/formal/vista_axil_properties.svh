// SPDX-License-Identifier: Apache-2.0
// Properties of vista_axil, inside it: each address that is accepted makes one request, of its own address and data, and
// gets one response, which holds still until it is taken: that to a read a clock after the request, that to a write three.
//
// Assumed of the bus, as AXI has it: what is offered stays until it is accepted.

logic f_started = 1'b0;
logic f_aw_waited, f_w_waited, f_ar_waited, f_b_due, f_r_due;
logic [AddrW-1:0] f_awaddr, f_araddr;
logic [StrobeW+DataW-1:0] f_wdata;
logic [DataW-1:0] f_read;
logic f_error;
logic [1:0] f_early;  // the two clocks after the request of a write

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_aw_waited <= awvalid_i & ~awready_o & rst_ni;
  f_w_waited  <= wvalid_i & ~wready_o & rst_ni;
  f_ar_waited <= arvalid_i & ~arready_o & rst_ni;
  f_awaddr    <= awaddr_i;
  f_araddr    <= araddr_i;
  f_wdata     <= {wstrb_i, wdata_i};
  if (bvalid_o & bready_i) f_b_due <= 1'b0;
  if (rvalid_o & rready_i) f_r_due <= 1'b0;
  if (request_o & write_o) f_b_due <= 1'b1;
  if (request_o & ~write_o) f_r_due <= 1'b1;
  if (request_o) f_read <= read_data_i;
  if (request_o) f_error <= error_i;
  f_early <= {f_early[0], request_o & write_o};
  if (!rst_ni) begin
    f_early <= '0;
    f_b_due <= 1'b0;
    f_r_due <= 1'b0;
  end
end

`ifdef VERILATOR
`include "vista_settled.svh"
always_ff @(posedge clk_i) if (f_settled) begin
`else
always_comb begin
  if (!f_started) assume (!rst_ni);
`endif
  if (f_started) begin
    if (f_aw_waited) assume (awvalid_i && awaddr_i == f_awaddr);
    if (f_w_waited) assume (wvalid_i && {wstrb_i, wdata_i} == f_wdata);
    if (f_ar_waited) assume (arvalid_i && araddr_i == f_araddr);

    assert (awready_o == (request_o & write_o) && wready_o == awready_o && arready_o == (request_o & ~write_o));
    if (awready_o) assert (awvalid_i && wvalid_i && address_o == awaddr_i && write_data_o == wdata_i);
    if (arready_o) assert (arvalid_i && address_o == araddr_i);
    for (int i = 0; i < StrobeW; i++) if (awready_o) assert (write_mask_o[i*8+:8] == {8{wstrb_i[i]}});
    assert (bvalid_o == (f_b_due & ~|f_early) && rvalid_o == f_r_due && !(request_o & (f_b_due | f_r_due)));
    if (rvalid_o) assert (rdata_o == f_read);
    if (rvalid_o) assert (rresp_o == {f_error, 1'b0});
    if (bvalid_o) assert (bresp_o == {f_error, 1'b0});

    // What makes these inductive.
    assert (state_q <= Respond);
    assert (f_early == {state_q == Settle, state_q == Apply} && (f_early == '0 || (f_b_due && write_q)));
    if (f_b_due || f_r_due) assert (error_q == f_error);
    if (state_q == Request) assert (write_q ? f_aw_waited && f_w_waited : f_ar_waited);
    if (state_q == Request && write_q) assert (address_q == f_awaddr && {strobe_q, write_data_q} == f_wdata);
    if (state_q == Request && !write_q) assert (address_q == f_araddr);
  end
end
