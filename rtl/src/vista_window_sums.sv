// SPDX-License-Identifier: Apache-2.0
// Sums over the block from the column sums of each channel: running sums of the last B slots.
//
//   S(x, m) = S(x-1, m) + C(x, m) - C(x-B, m)
//
// They start anew in every row with column D-1, the first that a matched block contains: until then they are held at
// zero, and what comes before it is not subtracted either. So nothing is carried from row to row: a bit that is upset in
// a sum is gone with the end of its row, and what memories and registers hold at power-up never enters one.
//
// The last B column sums of all channels wait in a ring, so the size of the block costs no logic.
//
// Latency: 4 clocks. S needs clog2(B * B * 255 + 1) bits. S keeps its value between slots.

module vista_window_sums #(
  parameter int unsigned NumChannels = 33,
  parameter int unsigned BlockSize = 11,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColumnW = vista_stereo_pkg::column_width(BlockSize),
  localparam int unsigned CostW = vista_stereo_pkg::cost_width(BlockSize)
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  vista_stereo_pkg::slot_t              slot_i,
  input  logic [NumChannels-1:0][ColumnW-1:0]  column_i,

  output vista_stereo_pkg::slot_t              slot_o,
  output vista_stereo_pkg::slot_t              slot_next_o,  // of the sums of the next clock
  output logic [NumChannels-1:0][CostW-1:0]    sum_o,
  output logic upset_o  // of a memory
);

  import vista_stereo_pkg::*;

  localparam int unsigned PtrW = $clog2(BlockSize);

  slot_t slot1_q, slot2_q, slot3_q;
  logic [PtrW-1:0] ptr_q, ptr1_q;
  logic clear1_q, start3_q;  // go to every channel, hence straight from registers

  logic [NumChannels-1:0][ColumnW-1:0] in1_q, in2_q, out2;

  always_ff @(posedge clk_i) begin
    slot1_q <= slot_i;
    slot2_q <= slot1_q;
    slot3_q <= slot2_q;
    slot_o  <= slot3_q;
    in1_q   <= column_i;
    in2_q   <= in1_q;
    ptr1_q  <= ptr_q;
    clear1_q <= slot_i.early_col;
    start3_q <= slot2_q.valid & slot2_q.before_col;
    if (slot_i.valid) ptr_q <= (32'(ptr_q) == BlockSize - 1) ? '0 : ptr_q + 1'b1;
    if (!rst_ni) begin
      slot1_q.valid <= 1'b0;
      slot2_q.valid <= 1'b0;
      slot3_q.valid <= 1'b0;
      slot_o.valid  <= 1'b0;
      ptr_q         <= '0;
    end
  end

  vista_line_store #(
    .Width (NumChannels * ColumnW),
    .Depth (2 ** PtrW),
    .Parity(Parity)
  ) u_ring (
    .clk_i,
    .clear_i      (clear1_q),
    .write_i      (slot1_q.valid),
    .write_col_i  (ptr1_q),
    .write_data_i (in1_q),
    .read_col_i   (ptr_q),
    .read_data_o  (out2),
    .upset_o      (upset_o)
  );

  assign slot_next_o = slot3_q;

  for (genvar c = 0; c < NumChannels; c++) begin : gen_channel
    logic [ColumnW:0] delta_q;

    always_ff @(posedge clk_i) begin
      delta_q <= {1'b0, in2_q[c]} - {1'b0, out2[c]};
      if (slot3_q.valid) sum_o[c] <= sum_o[c] + CostW'($signed(delta_q));
      if (start3_q) sum_o[c] <= '0;
    end
  end

endmodule
