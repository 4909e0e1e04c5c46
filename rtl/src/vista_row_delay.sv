// SPDX-License-Identifier: Apache-2.0
// Delays the prefiltered pixels by B rows: gives the word that leaves the block beside the one that enters it.
//
// One memory holds the last B words of each column side by side, and every slot shifts in one more: no bank multiplexer
// stands behind it, which would limit the clock, and a word of B * Width bits fills block RAMs well.
//
// Latency: 2 clocks. `leaving_o` is meaningful from row B of a frame on (`slot_o.leave`).

module vista_row_delay #(
  parameter int unsigned Width = 22,
  parameter int unsigned BlockSize = 11,
  parameter int unsigned MaxWidth = 1024,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth)
) (
  input  logic                    clk_i,
  input  logic                    rst_ni,
  input  vista_stereo_pkg::slot_t slot_i,
  input  logic [ColW-1:0]         slot_col_i,
  input  logic [Width-1:0]        entering_i,
  output vista_stereo_pkg::slot_t slot_o,
  output logic [ColW-1:0]         slot_col_o,
  output logic [Width-1:0]        entering_o,
  output logic [Width-1:0]        leaving_o,
  output logic upset_o  // of a memory
);

  vista_stereo_pkg::slot_t         slot_q;
  logic [ColW-1:0]                 col_q;
  logic [Width-1:0]                entering_q;
  logic [BlockSize-1:0][Width-1:0] column;

  vista_line_store #(
    .Width (BlockSize * Width),
    .Depth (MaxWidth),
    .Parity(Parity)
  ) u_columns (
    .clk_i,
    .clear_i      (1'b0),
    .write_i      (slot_o.valid),
    .write_col_i  (slot_col_o),
    .write_data_i ({column[BlockSize-2:0], entering_o}),
    .read_col_i   (slot_col_i),
    .read_data_o  (column),
    .upset_o      (upset_o)
  );

  assign leaving_o = column[BlockSize-1];

  always_ff @(posedge clk_i) begin
    slot_q     <= slot_i;
    slot_o     <= slot_q;
    col_q      <= slot_col_i;
    slot_col_o <= col_q;
    entering_q <= entering_i;
    entering_o <= entering_q;
    if (!rst_ni) begin
      slot_q.valid <= 1'b0;
      slot_o.valid <= 1'b0;
    end
  end

endmodule
