// SPDX-License-Identifier: Apache-2.0
// Column sums of the absolute differences, one for each disparity, and of the texture (channel D).
//
//   C(x, m, d) = C(x, m-1, d) + |l(x, m) - r(x-d, m)| - |l(x, m-B) - r(x-d, m-B)|
//
// kept in one memory of a word per column. Row 0 of a frame starts from zero, and nothing leaves before row B. Columns
// x < d meet right pixels of the row before; no matched block contains them, and the sums over the block leave them out.
//
// |a - b| of the difference e with sign s is (e ^ s) + s: the exclusive or costs logic, the two `+ s` ride on the
// carry inputs of the two additions that follow. With E entering and L leaving,
//   delta = E^ + ~L^ + sE = E^ - L^ - 1 + sE,   C' = C + delta + !sL.
//
// Latency: 4 clocks. C needs clog2(B * 255 + 1) bits; delta 10, signed.

module vista_cost_columns #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned BlockSize = 11,
  parameter int unsigned MaxWidth = 1024,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW,
  localparam int unsigned TextureW = vista_stereo_pkg::TextureW,
  localparam int unsigned ColumnW = vista_stereo_pkg::column_width(BlockSize)
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  vista_stereo_pkg::slot_t slot_i,
  input  logic [ColW-1:0]         slot_col_i,
  input  logic [PixelW-1:0]       left_entering_i,
  input  logic [PixelW-1:0]       right_entering_i,
  input  logic [TextureW-1:0]     texture_entering_i,
  input  logic [PixelW-1:0]       left_leaving_i,
  input  logic [PixelW-1:0]       right_leaving_i,
  input  logic [TextureW-1:0]     texture_leaving_i,

  output vista_stereo_pkg::slot_t               slot_o,
  output logic [NumDisparities:0][ColumnW-1:0]  column_o,
  output logic upset_o  // of a memory
);

  import vista_stereo_pkg::*;

  localparam int unsigned DeltaW = PixelW + 2;

  slot_t slot1_q, slot2_q, slot3_q;
  logic [ColW-1:0] col1_q, col2_q, col3_q, col4_q;

  always_ff @(posedge clk_i) begin
    slot1_q <= slot_i;
    slot2_q <= slot1_q;
    slot3_q <= slot2_q;
    slot_o  <= slot3_q;
    col1_q  <= slot_col_i;
    col2_q  <= col1_q;
    col3_q  <= col2_q;
    col4_q  <= col3_q;
    if (!rst_ni) begin
      slot1_q.valid <= 1'b0;
      slot2_q.valid <= 1'b0;
      slot3_q.valid <= 1'b0;
      slot_o.valid  <= 1'b0;
    end
  end

  // 1: the right pixels x .. x-D+1, entering and leaving.
  logic [PixelW-1:0] left_in_q, left_out_q;
  logic [TextureW-1:0] texture_in_q, texture_out_q;
  logic stay1_q;  // nothing leaves; goes to every disparity, hence straight from a register
  logic [NumDisparities-1:0][PixelW-1:0] right_in_q, right_out_q;

  always_ff @(posedge clk_i) begin
    stay1_q       <= ~slot_i.leave;
    left_in_q     <= left_entering_i;
    left_out_q    <= left_leaving_i;
    texture_in_q  <= texture_entering_i;
    texture_out_q <= texture_leaving_i;
    if (slot_i.valid) begin
      right_in_q  <= {right_in_q[NumDisparities-2:0], right_entering_i};
      right_out_q <= {right_out_q[NumDisparities-2:0], right_leaving_i};
    end
  end

  // 2: differences; 3: what the column gains.
  logic [NumDisparities:0][DeltaW-1:0] delta_q;
  logic [NumDisparities:0]             carry_q;

  for (genvar d = 0; d < NumDisparities; d++) begin : gen_difference
    logic [PixelW:0] in_q, out_q;
    logic [DeltaW:0] delta;

    assign delta = {2'b0, in_q[PixelW-1:0] ^ {PixelW{in_q[PixelW]}}, 1'b1} +
        {2'b11, ~(out_q[PixelW-1:0] ^ {PixelW{out_q[PixelW]}}), in_q[PixelW]};

    always_ff @(posedge clk_i) begin
      in_q  <= {1'b0, left_in_q} - {1'b0, right_in_q[d]};
      out_q <= {1'b0, left_out_q} - {1'b0, right_out_q[d]};
      if (stay1_q) out_q <= '0;
      delta_q[d] <= delta[DeltaW:1];
      carry_q[d] <= ~out_q[PixelW];
    end
  end

  logic [TextureW:0] texture_delta_q;

  always_ff @(posedge clk_i) begin
    texture_delta_q <= {1'b0, texture_in_q} - (stay1_q ? '0 : {1'b0, texture_out_q});
    delta_q[NumDisparities] <= DeltaW'($signed(texture_delta_q));
    carry_q[NumDisparities] <= 1'b0;
  end

  // 4: the new sums, written back one clock later. They start from zero here and not in the register of the memory, so
  // that a block RAM can have that one inside.
  logic [NumDisparities:0][ColumnW-1:0] stored_q;

  vista_line_store #(
    .Width     ((NumDisparities + 1) * ColumnW),
    .Depth     (MaxWidth),
    .Parity    (Parity)
  ) u_sums (
    .clk_i,
    .clear_i      (1'b0),
    .write_i      (slot_o.valid),
    .write_col_i  (col4_q),
    .write_data_i (column_o),
    .read_col_i   (col1_q),
    .read_data_o  (stored_q),
    .upset_o      (upset_o)
  );

  for (genvar c = 0; c <= NumDisparities; c++) begin : gen_column
    logic [ColumnW-1:0] held;
    logic [ColumnW:0] sum;

    assign held = stored_q[c] & {ColumnW{~slot3_q.first_row}};
    assign sum  = {held, 1'b1} + {ColumnW'($signed(delta_q[c])), carry_q[c]};

    always_ff @(posedge clk_i) column_o[c] <= sum[ColumnW:1];
  end

endmodule
