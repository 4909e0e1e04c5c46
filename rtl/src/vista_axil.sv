// SPDX-License-Identifier: Apache-2.0
// AXI4-Lite to the one-clock requests of the generated registers.
//
// One access at a time: a read, or a write whose address and data are both there; when both wait, they take turns. The
// request is issued from registers, so that what stands between it and the registers' enables, all over the chip, is
// their address decoder alone. Every request is answered in its own clock (no stalls: the generator is told so), which
// also accepts the address; where there is nothing, with SLVERR. The response to a write waits until everything behind the registers obeys it
// (vista_registers), so that what is sent after the response is treated as the write says.
//
// Latency: 2 clocks from the address to its acceptance; from there 1 clock to the response to a read, 3 to that to a
// write.

module vista_axil #(
  parameter int unsigned AddrW = 4,  // of words: without the two bits that number the bytes of one
  localparam int unsigned DataW = 32,
  localparam int unsigned StrobeW = DataW / 8
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic                awvalid_i,
  output logic                awready_o,
  input  logic [AddrW-1:0]    awaddr_i,
  input  logic                wvalid_i,
  output logic                wready_o,
  input  logic [DataW-1:0]    wdata_i,
  input  logic [StrobeW-1:0]  wstrb_i,
  output logic                bvalid_o,
  output logic [1:0]          bresp_o,
  input  logic                bready_i,
  input  logic                arvalid_i,
  output logic                arready_o,
  input  logic [AddrW-1:0]    araddr_i,
  output logic                rvalid_o,
  input  logic                rready_i,
  output logic [DataW-1:0]    rdata_o,
  output logic [1:0]          rresp_o,

  output logic              request_o,
  output logic              write_o,
  output logic [AddrW-1:0]  address_o,
  output logic [DataW-1:0]  write_data_o,
  output logic [DataW-1:0]  write_mask_o,
  input  logic [DataW-1:0]  read_data_i,   // beside the request
  input  logic              error_i        // likewise: there is nothing at its address
);

  typedef enum logic [2:0] {
    Idle,
    Request,
    Apply,
    Settle,
    Respond
  } state_e;

  state_e state_q;
  logic write_q, write_next, error_q;
  logic [AddrW-1:0]   address_q;
  logic [DataW-1:0]   write_data_q;
  logic [StrobeW-1:0] strobe_q;

  // `write_q` is the kind of the last access, until the next one is chosen.
  assign write_next = awvalid_i & wvalid_i & ~(arvalid_i & write_q);

  always_ff @(posedge clk_i) begin
    unique case (state_q)
      Idle: begin
        if (write_next | arvalid_i) begin
          state_q   <= Request;
          write_q   <= write_next;
          address_q <= write_next ? awaddr_i : araddr_i;
        end
        write_data_q <= wdata_i;
        strobe_q     <= wstrb_i;
      end
      Request: begin
        state_q <= write_q ? Apply : Respond;
        rdata_o <= read_data_i;
        error_q <= error_i;
      end
      Apply: state_q <= Settle;
      Settle: state_q <= Respond;
      Respond: if (write_q ? bready_i : rready_i) state_q <= Idle;
      default: state_q <= Idle;
    endcase
    if (!rst_ni) begin
      state_q <= Idle;
      write_q <= 1'b0;
    end
  end

  assign request_o    = (state_q == Request);
  assign write_o      = write_q;
  assign address_o    = address_q;
  assign write_data_o = write_data_q;

  for (genvar i = 0; i < StrobeW; i++) begin : gen_mask
    assign write_mask_o[i*8+:8] = {8{strobe_q[i]}};
  end

  assign awready_o = request_o & write_q;
  assign wready_o  = request_o & write_q;
  assign arready_o = request_o & ~write_q;
  assign bvalid_o  = (state_q == Respond) & write_q;
  assign bresp_o   = {error_q, 1'b0};
  assign rresp_o   = bresp_o;
  assign rvalid_o  = (state_q == Respond) & ~write_q;

`ifdef VISTA_ASSERT
  `include "vista_axil_properties.svh"
`endif

endmodule
