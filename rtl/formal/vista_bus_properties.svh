// SPDX-License-Identifier: Apache-2.0
// Rules of AXI4-Stream and AXI4-Lite at the top, in every simulation: what is offered stays, and does not change, until it
// is taken; only the reset of all may withdraw it, and of the buffer of the pyramid `store_rst_no` as well. On the way in
// these are assumptions.

`include "vista_bus_rule.svh"

`VISTA_BUS_RULE(s_axis, rst_ni, s_axis_tvalid, s_axis_tready, {s_axis_tuser, s_axis_tlast, s_axis_tdata}, assume)
`VISTA_BUS_RULE(m_axis, rst_ni, m_axis_tvalid, m_axis_tready, {m_axis_tuser, m_axis_tlast, m_axis_tdata}, assert)
`VISTA_BUS_RULE(store, store_rst_no, store_axis_tvalid, store_axis_tready, {store_axis_tuser, store_axis_tlast, store_axis_tdata}, assert)
`VISTA_BUS_RULE(fetch, store_rst_no, fetch_axis_tvalid, fetch_axis_tready, {fetch_axis_tuser, fetch_axis_tlast, fetch_axis_tdata}, assume)
`VISTA_BUS_RULE(aw, rst_ni, s_axil_awvalid, s_axil_awready, {s_axil_awprot, s_axil_awaddr}, assume)
`VISTA_BUS_RULE(w, rst_ni, s_axil_wvalid, s_axil_wready, {s_axil_wstrb, s_axil_wdata}, assume)
`VISTA_BUS_RULE(b, rst_ni, s_axil_bvalid, s_axil_bready, s_axil_bresp, assert)
`VISTA_BUS_RULE(ar, rst_ni, s_axil_arvalid, s_axil_arready, {s_axil_arprot, s_axil_araddr}, assume)
`VISTA_BUS_RULE(r, rst_ni, s_axil_rvalid, s_axil_rready, {s_axil_rresp, s_axil_rdata}, assert)

logic [2:0] f_accesses;  // writes that have no response yet, of which there is one at most, and reads

always_ff @(posedge clk_i) begin
  f_accesses <= f_accesses + 3'(s_axil_awvalid & s_axil_awready) + 3'(s_axil_arvalid & s_axil_arready) -
      3'(s_axil_bvalid & s_axil_bready) - 3'(s_axil_rvalid & s_axil_rready);
  if (!rst_ni) f_accesses <= '0;
  else if (s_axil_bvalid | s_axil_rvalid) assert (f_accesses == 3'd1);
end
