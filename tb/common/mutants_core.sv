// Stands in for vista_stereo_core: the netlist of `make mutate`, with the mutant chosen from the test bench.

module vista_stereo_core #(
  parameter int unsigned NumDisparities = 16,
  parameter int unsigned BlockSize = 5,
  parameter int unsigned MaxWidth = 64
) (
  input  logic                      clk_i,
  input  logic                      rst_ni,
  input  logic                      bus_rst_ni,
  input  logic                      enable_i,
  input  logic [$clog2(MaxWidth):0] width_i,
  input  logic [vista_stereo_pkg::HeightW-1:0] height_i,
  input  vista_stereo_pkg::params_t params_i,
  input  logic                      pixel_valid_i,
  output logic                      pixel_ready_o,
  input  logic                      pixel_sof_i,
  input  logic                      pixel_eol_i,
  input  logic [15:0]               pixel_i,
  output logic                      word_valid_o,
  input  logic                      word_ready_i,
  output logic                      word_sof_o,
  output logic                      word_eol_o,
  output logic [31:0]               word_o,
  output logic                      busy_o,
  output logic                      frame_start_o,
  output logic                      frame_end_o,
  output logic                      error_early_eol_o,
  output logic                      error_late_eol_o,
  output logic                      error_early_sof_o,
  output logic                      error_late_sof_o,
  output logic                      error_size_o
);

  logic [9:0] mutsel /*verilator public_flat_rw*/;

  vista_stereo_core_mutants u_mutants (.*);

endmodule
