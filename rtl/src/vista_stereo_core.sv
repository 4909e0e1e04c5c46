// SPDX-License-Identifier: Apache-2.0
// The stereo engine without registers: two streams and the parameters of a frame. See doc/design/rtl.md for the picture.
//
// Words out: {Smin, sign-extended disparity} of W * H pixels for every frame that was begun, in raster order, or two
// disparities in a word (vista_word_packer). With Confidence a frame may have that in place of Smin.
// Latency: the disparity of (x, y) leaves r + 1 rows and r columns after its pixel came, plus a number of clocks that
// depends on D only (doc/rtl.md).

module vista_stereo_core #(
  parameter int unsigned NumDisparities = 32,   // 16, 32 .. 256
  parameter int unsigned BlockSize = 11,        // odd, 5 .. 21
  parameter int unsigned MaxWidth = 1024,       // NumDisparities + BlockSize .. 65535
  parameter bit Parity = 1'b0,
  parameter bit Confidence = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,
  input  logic bus_rst_ni,  // of what is offered at `word_*`, which a reset of the rest leaves until it is taken

  // A frame has what is set in the clock in which its first pixel is first offered.
  input  logic                      enable_i,
  input  logic [ColW:0]             width_i,
  input  logic [RowW-1:0]           height_i,
  input  vista_stereo_pkg::params_t params_i,

  input  logic                pixel_valid_i,
  output logic                pixel_ready_o,
  input  logic                pixel_sof_i,
  input  logic                pixel_eol_i,
  input  logic [2*PixelW-1:0] pixel_i,  // {right, left}

  output logic        word_valid_o,
  input  logic        word_ready_i,
  output logic        word_sof_o,
  output logic        word_eol_o,
  output logic [31:0] word_o,  // {Smin or confidence, disparity}, or two disparities

  output logic busy_o,  // a pixel of a frame that is to be taken waits

  // Events, one clock each.
  output logic frame_start_o,
  output logic frame_end_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o,
  output logic upset_o  // of a memory, or results and frames do not fit
);

  import vista_stereo_pkg::*;

  if (NumDisparities < 16 || NumDisparities > 256 || NumDisparities % 16 != 0) begin : gen_bad_disparities
    $fatal(1, "NumDisparities must be 16, 32 .. 256");
  end
  if (BlockSize < 5 || BlockSize > 21 || BlockSize % 2 == 0) begin : gen_bad_block
    $fatal(1, "BlockSize must be odd, 5 .. 21");
  end
  if (MaxWidth < NumDisparities + BlockSize || MaxWidth > LargestWidth) begin : gen_bad_width
    $fatal(1, "MaxWidth must be NumDisparities + BlockSize .. 65535");
  end

  localparam int unsigned ColumnW = column_width(BlockSize);
  localparam int unsigned CostW = cost_width(BlockSize);
  localparam int unsigned IndexW = $clog2(NumDisparities);
  localparam int unsigned RingW = ring_width(NumDisparities);

  // Framing.
  logic head_valid, head_ready, head_sof, head_eol, head_enable, head_admit;
  logic [2*PixelW-1:0] head;
  logic [ColW-1:0] head_last_col;
  logic [RowW-1:0] head_last_row;
  params_t head_params;
  logic results_go, go_q;
  video_slot_t next_slot;
  slot_t raw_slot;
  logic [ColW-1:0] next_col, frame_last_col, raw_col, store_col, begin_last_col;
  logic [RowW-1:0] frame_last_row;
  logic [RowW-1:0]     begin_last_row;
  logic                begin_narrow;
  params_t             raw_params;
  logic store_valid, begin_valid;
  logic [2*PixelW-1:0] store_data;

  vista_frame_input #(
    .MaxWidth  (MaxWidth),
    .SideWidth ($bits(params_t))
  ) u_input (
    .clk_i,
    .rst_ni,
    .enable_i,
    .width_i,
    .height_i,
    .side_i     (params_i),
    .valid_i    (pixel_valid_i),
    .ready_o    (pixel_ready_o),
    .sof_i      (pixel_sof_i),
    .eol_i      (pixel_eol_i),
    .data_i     (pixel_i),
    .valid_o    (head_valid),
    .ready_i    (head_ready),
    .sof_o      (head_sof),
    .eol_o      (head_eol),
    .data_o     (head),
    .enable_o   (head_enable),
    .admit_o    (head_admit),
    .last_col_o (head_last_col),
    .last_row_o (head_last_row),
    .side_o     (head_params),
    .busy_o
  );

  always_ff @(posedge clk_i) begin
    go_q <= results_go;
    if (!rst_ni) go_q <= 1'b0;
  end

  vista_framer #(
    .MaxWidth  (MaxWidth),
    .SideWidth ($bits(params_t))
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
    .side_i               (head_params),
    .go_i                 (go_q),
    .slot_next_o          (next_slot),
    .slot_next_col_o      (next_col),
    .store_valid_o        (store_valid),
    .store_col_o          (store_col),
    .store_last_o         (),
    .store_data_o         (store_data),
    .last_col_o           (frame_last_col),
    .last_row_o           (frame_last_row),
    .side_o               (raw_params),
    .frame_start_o,
    .error_early_eol_o,
    .error_late_eol_o,
    .error_early_sof_o,
    .error_late_sof_o,
    .error_size_o
  );

  vista_match_slots #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_match_slots (
    .clk_i,
    .rst_ni,
    .slot_next_i          (next_slot),
    .slot_next_col_i      (next_col),
    .last_col_i           (frame_last_col),
    .last_row_i           (frame_last_row),
    .narrow_i             (raw_params.narrow),
    .slot_o               (raw_slot),
    .slot_col_o           (raw_col),
    .begin_valid_o        (begin_valid),
    .begin_last_col_o     (begin_last_col),
    .begin_last_row_o     (begin_last_row),
    .begin_narrow_o       (begin_narrow)
  );

  // Costs.
  slot_t filtered_slot, delayed_slot, column_slot, cost_slot, next_cost_slot;
  logic [ColW-1:0] filtered_col, delayed_col;
  params_t frame_params;
  logic [PixelW-1:0] left, right, left_in, right_in, left_out, right_out;
  logic [TextureW-1:0] texture, texture_in, texture_out;
  logic [NumDisparities:0][ColumnW-1:0] column;
  logic [NumDisparities:0][CostW-1:0]   sum;

  logic [8:0] upset;
  assign upset_o = |upset;

  vista_prefilter #(
    .MaxWidth (MaxWidth),
    .Parity   (Parity)
  ) u_prefilter (
    .clk_i,
    .rst_ni,
    .slot_i        (raw_slot),
    .slot_col_i    (raw_col),
    .params_i      (raw_params),
    .store_valid_i (store_valid),
    .store_col_i   (store_col),
    .store_data_i  (store_data),
    .slot_o        (filtered_slot),
    .slot_col_o    (filtered_col),
    .params_o      (frame_params),
    .left_o        (left),
    .right_o       (right),
    .texture_o     (texture),
    .upset_o       (upset[0])
  );

  vista_row_delay #(
    .Width     (2 * PixelW + TextureW),
    .BlockSize (BlockSize),
    .MaxWidth  (MaxWidth),
    .Parity    (Parity)
  ) u_row_delay (
    .clk_i,
    .rst_ni,
    .slot_i     (filtered_slot),
    .slot_col_i (filtered_col),
    .entering_i ({texture, right, left}),
    .slot_o     (delayed_slot),
    .slot_col_o (delayed_col),
    .entering_o ({texture_in, right_in, left_in}),
    .leaving_o  ({texture_out, right_out, left_out}),
    .upset_o    (upset[1])
  );

  vista_cost_columns #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth),
    .Parity   (Parity)
  ) u_cost_columns (
    .clk_i,
    .rst_ni,
    .slot_i             (delayed_slot),
    .slot_col_i         (delayed_col),
    .left_entering_i    (left_in),
    .right_entering_i   (right_in),
    .texture_entering_i (texture_in),
    .left_leaving_i     (left_out),
    .right_leaving_i    (right_out),
    .texture_leaving_i  (texture_out),
    .slot_o             (column_slot),
    .column_o           (column),
    .upset_o            (upset[2])
  );

  vista_window_sums #(
    .NumChannels (NumDisparities + 1),
    .BlockSize   (BlockSize),
    .Parity      (Parity)
  ) u_window_sums (
    .clk_i,
    .rst_ni,
    .slot_i   (column_slot),
    .column_i (column),
    .slot_o      (cost_slot),
    .slot_next_o (next_cost_slot),
    .sum_o       (sum),
    .upset_o     (upset[3])
  );

  // The parameters of the stages behind the costs change with the first column of a row that has matches: 2r rows after
  // the last pixel of the frame before, D-1+2r columns before the first pixel of this one. A frame without matches may be
  // so short that the one before is still being decided when it ends; it leaves them as they are.
  params_t params_q;
  logic    match;

  assign match = cost_slot.valid & cost_slot.match;

  always_ff @(posedge clk_i) begin
    if (cost_slot.valid & cost_slot.match_row & cost_slot.first_col) params_q <= frame_params;
  end

  // Decisions.
  logic textured;
  logic [IndexW-1:0] winner, right_winner;
  logic [CostW-1:0] smin;
  logic rival, candidate_valid, candidate_textured;
  logic signed [DisparityW-1:0] disparity;
  logic [RingW-1:0] match_index, candidate_index, slot_index;
  logic slot_valid, decided, cut;

  assign textured = (32'(sum[NumDisparities]) >= 32'(params_q.texture_threshold));

  logic signed [DistanceW-1:0] distance;
  logic [MarginW-1:0]          margin;

  vista_candidate #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .Confidence (Confidence)
  ) u_candidate (
    .clk_i,
    .rst_ni,
    .uniqueness_ratio_i (params_q.uniqueness_ratio),
    .cost_i             (sum[NumDisparities-1:0]),
    .winner_o           (winner),
    .smin_o             (smin),
    .rival_o            (rival),
    .disparity_o        (disparity),
    .distance_o         (distance),
    .margin_o           (margin)
  );

  // What goes along with a candidate; with Confidence also the length of its texture.
  localparam int unsigned CandidateW = 2 + RingW + (Confidence ? LengthW : 0);
  localparam int unsigned SideW = Confidence ? SminW : CostW;  // of Smin, or of what is in its place

  logic unused_since_reset;
  logic [LengthW-1:0]    texture_length;
  logic [CandidateW-1:0] candidate_with;
  logic [SideW-1:0]      candidate_side;

  assign {candidate_valid, candidate_textured, candidate_index} = candidate_with[RingW+1:0];

  if (Confidence) begin : gen_confidence
    logic [SminW-1:0] saturated;

    always_comb begin
      texture_length = '0;
      for (int unsigned i = 0; i < 2 ** LengthW - 1 && i < CostW; i++) begin
        if (sum[NumDisparities][i]) texture_length = LengthW'(i + 1);
      end
    end

    assign saturated      = (32'(smin) > 32'(SminW'('1))) ? '1 : SminW'(smin);
    assign candidate_side = params_q.confidence ? {distance, margin, candidate_with[CandidateW-1-:LengthW]}
                                                : saturated;
  end else begin : gen_no_confidence
    logic unused_confidence;
    assign unused_confidence = ^{distance, margin, params_q.confidence};
    assign texture_length    = '0;
    assign candidate_side    = smin;
  end

  vista_delay_ring #(
    .Width   (CandidateW),
    .Latency (candidate_latency(NumDisparities)),
    .Parity  (Parity)
  ) u_candidate_slot (
    .clk_i,
    .rst_ni,
    .data_i (CandidateW'({texture_length, match, textured, match_index})),
    .data_o (candidate_with),
    .since_reset_o (unused_since_reset),
    .upset_o(upset[6])
  );

  vista_right_winner #(
    .NumDisparities (NumDisparities),
    .CostW (CostW),
    .RingW (RingW)
  ) u_right_winner (
    .clk_i,
    .rst_ni,
    .match_i       (next_cost_slot.valid & next_cost_slot.match),
    .match_last_i  (next_cost_slot.last_col),
    .match_cut_i   (next_cost_slot.cut),
    .cost_i        (sum[NumDisparities-1:0]),
    .match_index_o (match_index),
    .slot_valid_o  (slot_valid),
    .slot_index_o  (slot_index),
    .winner_o      (right_winner),
    .decided_o     (decided),
    .cut_o         (cut)
  );

  logic                         result_valid;
  logic signed [DisparityW-1:0] result_disparity;
  logic [SminW-1:0]             result_smin;

  vista_lr_check #(
    .NumDisparities (NumDisparities),
    .CostW (SideW),
    .RingW (RingW),
    .Parity(Parity)
  ) u_lr_check (
    .clk_i,
    .rst_ni,
    .lr_enable_i           (params_q.lr_enable),
    .lr_max_diff_i         (params_q.lr_max_diff),
    .candidate_valid_i     (candidate_valid),
    .candidate_index_i     (candidate_index),
    .candidate_ok_i        (candidate_textured & (~rival | (params_q.uniqueness_ratio == '0))),
    .candidate_winner_i    (winner),
    .candidate_smin_i      (candidate_side),
    .candidate_disparity_i (disparity),
    .slot_valid_i          (slot_valid),
    .slot_index_i          (slot_index),
    .right_winner_i        (right_winner),
    .decided_i             (decided),
    .cut_i                 (cut),
    .valid_o               (result_valid),
    .disparity_o           (result_disparity),
    .smin_o                (result_smin),
    .upset_o               (upset[4])
  );

  // Words. The beginning of a frame waits in one queue with the results, behind those of the frame before it and before
  // its own, so that results which are lost or too many end with their frame.
  localparam int unsigned ResultW = DisparityW + SminW;
  localparam int unsigned BeginW = ColW + RowW + 1;
  localparam int unsigned QueuedW = (ResultW > BeginW) ? ResultW : BeginW;

  logic queued_valid, queued_ready, pixel_valid, pixel_ready, pixel_sof, pixel_eol, pixel_narrow, pixel_complete;
  logic begins, since_reset, queued_begin;
  logic [1:0] begins_late;  // twice, so that no single bit begins a frame
  logic [BeginW-1:0] begin_late;
  logic [QueuedW-1:0] queued;
  logic signed [DisparityW-1:0] pixel_disparity;
  logic [SminW-1:0] pixel_smin;
  logic word_valid, word_ready, word_sof, word_eol;
  logic [31:0] word;

  vista_delay_ring #(
    .Width   (2 + BeginW),
    .Latency (begin_latency(NumDisparities) - 1),
    .Parity  (Parity)
  ) u_begin (
    .clk_i,
    .rst_ni,
    .data_i ({{2{begin_valid}}, begin_narrow, begin_last_row, begin_last_col}),
    .data_o ({begins_late, begin_late}),
    .since_reset_o (since_reset),
    .upset_o(upset[7])
  );

  // What a block RAM gives is late in the clock, and the queue's is written with it.
  logic [1:0] begins_q;
  logic [BeginW-1:0] begin_q;

  always_ff @(posedge clk_i) begin
    begins_q <= begins_late & {2{since_reset}};
    begin_q  <= begin_late;
    if (!rst_ni) begins_q <= '0;
  end

  assign begins = &begins_q;

  vista_result_fifo #(
    .Width    (1 + QueuedW),
    .InFlight (results_in_flight(NumDisparities)),
    .Parity   (Parity)
  ) u_result_fifo (
    .clk_i,
    .rst_ni,
    .write_i (result_valid | begins),
    .data_i  ({begins, begins ? QueuedW'(begin_q) : QueuedW'({result_smin, result_disparity})}),
    .go_o    (results_go),
    .valid_o (queued_valid),
    .ready_i (queued_ready),
    .data_o  ({queued_begin, queued}),
    .upset_o (upset[5])
  );

  vista_frame_writer #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_frame_writer (
    .clk_i,
    .rst_ni,
    .queued_valid_i     (queued_valid),
    .queued_ready_o     (queued_ready),
    .queued_begin_i     (queued_begin),
    .begin_last_col_i   (queued[0+:ColW]),
    .begin_last_row_i   (queued[ColW+:RowW]),
    .begin_narrow_i     (queued[ColW+RowW]),
    .result_disparity_i (queued[0+:DisparityW]),
    .result_smin_i      (queued[DisparityW+:SminW]),
    .valid_o            (pixel_valid),
    .ready_i            (pixel_ready),
    .sof_o              (pixel_sof),
    .eol_o              (pixel_eol),
    .narrow_o           (pixel_narrow),
    .complete_o         (pixel_complete),
    .disparity_o        (pixel_disparity),
    .smin_o             (pixel_smin),
    .frame_end_o,
    .upset_o            (upset[8])
  );

  vista_word_packer u_word_packer (
    .clk_i,
    .rst_ni,
    .valid_i     (pixel_valid),
    .ready_o     (pixel_ready),
    .sof_i       (pixel_sof),
    .eol_i       (pixel_eol),
    .narrow_i    (pixel_narrow),
    .complete_i  (pixel_complete),
    .disparity_i (pixel_disparity),
    .smin_i      (pixel_smin),
    .valid_o     (word_valid),
    .ready_i     (word_ready),
    .sof_o       (word_sof),
    .eol_o       (word_eol),
    .word_o      (word)
  );

  vista_skid #(
    .Width(2 + 32)
  ) u_word_skid (
    .clk_i,
    .rst_ni  (bus_rst_ni),
    .valid_i (word_valid),
    .ready_o (word_ready),
    .data_i  ({word_sof, word_eol, word}),
    .valid_o (word_valid_o),
    .ready_i (word_ready_i),
    .data_o  ({word_sof_o, word_eol_o, word_o})
  );

`ifdef VISTA_ASSERT
  `include "vista_stereo_core_properties.svh"
`endif

endmodule
