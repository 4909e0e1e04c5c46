// SPDX-License-Identifier: Apache-2.0
// Sends the pixels that a filter has computed as AXI4-Stream video, behind a pipeline that cannot stop.
//
// A frame whose input broke off ends with its last pixel that was computed from what came. That pixel carries an end of
// line in the wrong place, or none in the last column, so that whatever follows cuts the frame there as well. To know
// which pixel is the last, each waits for the next one. A frame that breaks off within its first three pixels is filled
// up to three.
//
// The writer has no `ready`: `go_o` falls early enough that what is still on its way, at most `InFlight` pixels, fits. How
// many wait is the difference of the places of writing and reading, and counted nowhere else.
//
// Latency: 4 clocks from the result behind a pixel to the pixel.

module vista_pixel_writer #(
  parameter int unsigned SideWidth = 24,
  parameter int unsigned InFlight = 10,
  parameter bit Parity = 1'b0,
  localparam int unsigned DataW = 2 * vista_stereo_pkg::PixelW,
  localparam int unsigned PtrW = $clog2(InFlight + 2)
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic                 result_valid_i,
  input  logic                 result_sof_i,
  input  logic                 result_eol_i,
  input  logic                 result_end_i,   // the last pixel of the frame
  input  logic                 result_cut_i,   // filler after a framing error, as all that follow in the frame
  input  logic [DataW-1:0]     result_data_i,
  input  logic [SideWidth-1:0] result_side_i,  // of the frame, beside its first pixel
  output logic                 go_o,

  output logic                 valid_o,
  input  logic                 ready_i,
  output logic                 sof_o,
  output logic                 eol_o,
  output logic [DataW-1:0]     data_o,
  output logic [SideWidth-1:0] side_o,  // of the frame that is leaving; changes when its first pixel is offered
  output logic upset_o  // of a memory
);

  localparam int unsigned Depth = 2 ** PtrW;
  localparam int unsigned WordW = SideWidth + 2 + DataW;
  localparam logic [1:0] Fewest = 2'd3;  // pixels of a frame that breaks off

  // The pixel that waits for the next one.
  logic hold_valid_q, hold_sof_q, hold_eol_q, hold_end_q;
  logic [DataW-1:0]     hold_data_q;
  logic [SideWidth-1:0] hold_side_q;
  logic [1:0]           count_q;  // pixels of the frame so far, saturating
  logic cut, load, write, write_eol;

  assign cut       = result_cut_i & ~result_sof_i & (count_q == Fewest);
  assign load      = result_valid_i & ~cut;
  assign write     = hold_valid_q & (hold_end_q | result_valid_i);
  assign write_eol = hold_eol_q ^ (cut & ~hold_end_q);

  always_ff @(posedge clk_i) begin
    if (load | write) hold_valid_q <= load;
    if (load) begin
      hold_sof_q  <= result_sof_i;
      hold_eol_q  <= result_eol_i;
      hold_end_q  <= result_end_i;
      hold_data_q <= result_data_i;
      if (result_sof_i) hold_side_q <= result_side_i;
      if (result_sof_i) count_q <= 2'd1;
      else if (count_q != Fewest) count_q <= count_q + 1'b1;
    end
    if (!rst_ni) begin
      hold_valid_q <= 1'b0;
      hold_end_q   <= 1'b0;
    end
  end

  // What waits for the reader.
  logic [PtrW:0] write_ptr_q, read_ptr_q, level;
  logic          read;
  logic [WordW-1:0] word;

  assign level = write_ptr_q - read_ptr_q;
  assign read  = (write_ptr_q != read_ptr_q) & (~valid_o | ready_i);

  vista_memory #(
    .Width  (WordW),
    .Depth  (Depth),
    .Parity (Parity)
  ) u_waiting (
    .write_clk_i  (clk_i),
    .write_i      (write),
    .write_addr_i (write_ptr_q[PtrW-1:0]),
    .write_data_i ({hold_side_q, hold_sof_q, write_eol, hold_data_q}),
    .clk_i,
    .read_i       (read),
    .read_addr_i  (read_ptr_q[PtrW-1:0]),
    .read_data_o  (word),
    .upset_o
  );

  always_ff @(posedge clk_i) begin
    if (write) write_ptr_q <= write_ptr_q + 1'b1;
    if (read) read_ptr_q <= read_ptr_q + 1'b1;
    if (~valid_o | ready_i) valid_o <= read;
    go_o <= 32'(level) < Depth - InFlight;
    if (!rst_ni) begin
      write_ptr_q <= '0;
      read_ptr_q  <= '0;
      valid_o     <= 1'b0;
      go_o        <= 1'b0;
    end
  end

  assign {side_o, sof_o, eol_o, data_o} = word;

`ifdef VISTA_ASSERT
  `include "vista_pixel_writer_properties.svh"
`endif

endmodule
