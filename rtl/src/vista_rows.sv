// SPDX-License-Identifier: Apache-2.0
// Takes video and gives each slot beside the pixels of its column: row m, the row below it and those above.
//
// Framing, drain and filler are those of vista_framer: frames may follow each other without a gap, and the last row of a
// frame needs no follower. Rows that do not exist (below the last, above the first) hold anything; the user mirrors.
//
// Latency: 4 clocks from a pixel to the slot of the row above it.

module vista_rows #(
  parameter int unsigned NumRows = 2,  // rows that are kept: m, m-1 ..
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned SideWidth = 1,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned DataW = 2 * vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // A frame has what is set in the clock in which its first pixel is first offered.
  input  logic                 enable_i,
  input  logic [ColW:0]        width_i,
  input  logic [RowW-1:0]      height_i,
  input  logic [SideWidth-1:0] side_i,  // whatever else belongs to the frame

  input  logic             valid_i,
  output logic             ready_o,
  input  logic             sof_i,
  input  logic             eol_i,
  input  logic [DataW-1:0] data_i,

  input  logic go_i,  // slots may be issued

  output vista_stereo_pkg::video_slot_t  slot_o,
  output logic                           odd_col_o,
  output logic                           odd_row_o,
  output logic [DataW-1:0]               below_o,  // row m+1
  output logic [NumRows-1:0][DataW-1:0]  row_o,    // row m, m-1 ..

  // Properties of the frame being stored; while the first slot of a frame is out, and for 2 clocks more, of that one.
  output logic [ColW:0]        width_o,
  output logic [RowW-1:0]      height_o,
  output logic [SideWidth-1:0] side_o,

  // Events, one clock each.
  output logic frame_start_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o,
  output logic upset_o  // of a memory
);

  import vista_stereo_pkg::*;

  logic head_valid, head_ready, head_sof, head_eol, head_enable, head_admit;
  logic [DataW-1:0] head;
  logic [ColW-1:0] head_last_col;
  logic [RowW-1:0] head_last_row;
  logic [SideWidth-1:0] head_side;

  vista_frame_input #(
    .MaxWidth  (MaxWidth),
    .SideWidth (SideWidth)
  ) u_input (
    .clk_i,
    .rst_ni,
    .enable_i,
    .width_i,
    .height_i,
    .side_i,
    .valid_i,
    .ready_o,
    .sof_i,
    .eol_i,
    .data_i,
    .valid_o    (head_valid),
    .ready_i    (head_ready),
    .sof_o      (head_sof),
    .eol_o      (head_eol),
    .data_o     (head),
    .enable_o   (head_enable),
    .admit_o    (head_admit),
    .last_col_o (head_last_col),
    .last_row_o (head_last_row),
    .side_o     (head_side),
    .busy_o     ()
  );

  video_slot_t next_slot;
  logic [ColW-1:0] next_col, store_col, frame_last_col;
  logic [RowW-1:0] frame_last_row;
  logic            store_valid;
  logic [DataW-1:0] store_data;
  logic [SideWidth-1:0] frame_side;

  vista_framer #(
    .MaxWidth  (MaxWidth),
    .SideWidth (SideWidth)
  ) u_framer (
    .clk_i,
    .rst_ni,
    .valid_i              (head_valid),
    .ready_o              (head_ready),
    .sof_i                (head_sof),
    .eol_i                (head_eol),
    .data_i               (head),
    .enable_i             (head_enable),
    .admit_i              (head_admit),
    .last_col_i           (head_last_col),
    .last_row_i           (head_last_row),
    .side_i               (head_side),
    .go_i,
    .slot_next_o          (next_slot),
    .slot_next_col_o      (next_col),
    .store_valid_o        (store_valid),
    .store_col_o          (store_col),
    .store_last_o         (),
    .store_data_o         (store_data),
    .last_col_o           (frame_last_col),
    .last_row_o           (frame_last_row),
    .side_o               (frame_side),
    .frame_start_o,
    .error_early_eol_o,
    .error_late_eol_o,
    .error_early_sof_o,
    .error_late_sof_o,
    .error_size_o
  );

  always_ff @(posedge clk_i) begin
    if (frame_start_o) begin
      width_o  <= (ColW + 1)'(frame_last_col) + 1'b1;
      height_o <= frame_last_row + 1'b1;
      side_o   <= frame_side;
    end
  end

  // The rows come out of the store two clocks later; the arriving pixel waits for them.
  video_slot_t slot_q, slot1_q;
  logic [ColW-1:0] slot_col_q, store_col1_q, store_col2_q;
  logic odd_col1_q, store1_q, store2_q, odd_row_q;
  logic [DataW-1:0] below1_q;

  vista_line_store #(
    .Width (NumRows * DataW),
    .Depth (MaxWidth),
    .Parity(Parity)
  ) u_lines (
    .clk_i,
    .clear_i      (1'b0),
    .write_i      (store2_q),
    .write_col_i  (store_col2_q),
    .write_data_i ({row_o[NumRows-2:0], below_o}),
    .read_col_i   (slot_col_q),
    .read_data_o  (row_o),
    .upset_o      (upset_o)
  );

  assign odd_row_o = odd_row_q & ~slot_o.first_row;

  always_ff @(posedge clk_i) begin
    slot_q       <= next_slot;
    slot_col_q   <= next_col;
    slot1_q      <= slot_q;
    slot_o       <= slot1_q;
    odd_col1_q   <= slot_col_q[0];
    odd_col_o    <= odd_col1_q;
    store1_q     <= store_valid;
    store2_q     <= store1_q;
    store_col1_q <= store_col;
    store_col2_q <= store_col1_q;
    below1_q     <= store_data;
    below_o      <= below1_q;
    if (slot_o.valid & slot_o.last_col) odd_row_q <= ~odd_row_o;
    if (!rst_ni) begin
      slot_q.valid  <= 1'b0;
      slot1_q.valid <= 1'b0;
      slot_o.valid  <= 1'b0;
      store1_q      <= 1'b0;
      store2_q      <= 1'b0;
    end
  end

endmodule
