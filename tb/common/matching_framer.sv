// SPDX-License-Identifier: Apache-2.0
// The framer with what the matching adds to its slots, as in vista_stereo_core.

module matching_framer #(
  parameter int unsigned NumDisparities = 16,
  parameter int unsigned BlockSize = 5,
  parameter int unsigned MaxWidth = 32,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned DataW = 2 * vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic                      valid_i,
  output logic                      ready_o,
  input  logic                      sof_i,
  input  logic                      eol_i,
  input  logic [DataW-1:0]          data_i,
  input  logic                      enable_i,
  input  logic                      admit_i,
  input  logic [ColW-1:0]           last_col_i,
  input  logic [RowW-1:0]           last_row_i,
  input  vista_stereo_pkg::params_t params_i,

  input  logic go_i,

  output vista_stereo_pkg::slot_t   slot_o,
  output logic [ColW-1:0]           slot_col_o,
  output vista_stereo_pkg::params_t params_o,

  output logic             store_valid_o,
  output logic [ColW-1:0]  store_col_o,
  output logic             store_last_o,
  output logic [DataW-1:0] store_data_o,

  output logic            begin_valid_o,
  output logic [ColW-1:0] begin_last_col_o,
  output logic [RowW-1:0] begin_last_row_o,
  output logic            begin_narrow_o,

  output logic frame_start_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o
);

  vista_stereo_pkg::video_slot_t next_slot;
  logic [ColW-1:0] next_col, last_col;
  logic [RowW-1:0] last_row;

  vista_framer #(
    .MaxWidth  (MaxWidth),
    .SideWidth ($bits(vista_stereo_pkg::params_t))
  ) u_framer (
    .*,
    .side_i          (params_i),
    .slot_next_o     (next_slot),
    .slot_next_col_o (next_col),
    .last_col_o      (last_col),
    .last_row_o      (last_row),
    .side_o          (params_o)
  );

  vista_match_slots #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_match_slots (
    .*,
    .slot_next_i     (next_slot),
    .slot_next_col_i (next_col),
    .last_col_i      (last_col),
    .last_row_i      (last_row),
    .narrow_i        (params_o.narrow)
  );

endmodule
