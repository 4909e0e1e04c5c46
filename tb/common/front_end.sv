// The way of a frame behind the registers, for the bench: the front end and the core. What belongs to a frame goes along
// with it, so that each level is matched with its own size and the parameters of its frame.

module front_end #(
  parameter int unsigned NumDisparities = 16,
  parameter int unsigned BlockSize = 5,
  parameter int unsigned MaxWidth = 64,
  parameter int unsigned NumRows = 16,
  parameter int unsigned MaxPoints = 64,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned FrontW = $bits(vista_stereo_pkg::front_end_t),
  localparam int unsigned ParamsW = $bits(vista_stereo_pkg::params_t)
) (
  input  logic clk_i,
  input  logic rst_ni,
  input  logic keep_map_i,

  input  logic               enable_i,
  input  logic [ColW:0]      width_i,
  input  logic [RowW-1:0]    height_i,
  input  logic [FrontW-1:0]  front_end_i,  // {rectify, levels, smooth}
  input  logic [ParamsW-1:0] side_i,       // parameters of the matching

  input  logic            map_begin_i,
  input  logic [ColW:0]   map_width_i,
  input  logic [RowW-1:0] map_height_i,
  input  logic            map_write_i,
  input  logic [31:0]     map_data_i,
  input  logic            map_commit_i,
  output logic            map_ready_o,
  output logic            map_accepted_o,
  output logic            map_refused_rows_o,
  output logic            map_refused_size_o,

  input  logic        s_axis_tvalid,
  output logic        s_axis_tready,
  input  logic [15:0] s_axis_tdata,
  input  logic        s_axis_tuser,
  input  logic        s_axis_tlast,

  output logic        store_axis_tvalid,
  input  logic        store_axis_tready,
  output logic [15:0] store_axis_tdata,
  output logic        store_axis_tuser,
  output logic        store_axis_tlast,

  input  logic        fetch_axis_tvalid,
  output logic        fetch_axis_tready,
  input  logic [15:0] fetch_axis_tdata,
  input  logic        fetch_axis_tuser,
  input  logic        fetch_axis_tlast,

  output logic        m_axis_tvalid,
  input  logic        m_axis_tready,
  output logic [31:0] m_axis_tdata,
  output logic        m_axis_tuser,
  output logic        m_axis_tlast,

  output logic frame_start_o,
  output logic error_map_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o
);

  logic pixel_valid, pixel_ready, pixel_sof, pixel_eol;
  logic [15:0] pixel;
  logic [ColW:0] pixel_width;
  logic [RowW-1:0] pixel_height;
  logic [ParamsW-1:0] pixel_params;
  vista_stereo_pkg::events_t events;

  assign frame_start_o      = events.frame_start;
  assign error_map_o        = events.no_map;
  assign error_early_eol_o  = events.early_eol;
  assign error_late_eol_o   = events.late_eol;
  assign error_early_sof_o  = events.early_sof;
  assign error_late_sof_o   = events.late_sof;
  assign error_size_o       = events.size;
  assign map_refused_rows_o = events.map_rows;
  assign map_refused_size_o = events.map_size;

  vista_front_end #(
    .MaxWidth  (MaxWidth),
    .NumRows   (NumRows),
    .MaxPoints (MaxPoints),
    .SideWidth (ParamsW)
  ) u_front_end (
    .map_i         ({map_begin_i, map_write_i, map_data_i, map_commit_i}),
    .m_axis_tvalid (pixel_valid),
    .m_axis_tready (pixel_ready),
    .m_axis_tdata  (pixel),
    .m_axis_tuser  (pixel_sof),
    .m_axis_tlast  (pixel_eol),
    .width_o       (pixel_width),
    .height_o      (pixel_height),
    .side_o        (pixel_params),
    .busy_o        (),
    .lost_o        (),
    .events_o      (events),
    .*
  );

  vista_stereo_core #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_core (
    .clk_i,
    .rst_ni,
    .enable_i          (1'b1),
    .bus_rst_ni        (rst_ni),
    .width_i           (pixel_width),
    .height_i          (pixel_height),
    .params_i          (pixel_params),
    .pixel_valid_i     (pixel_valid),
    .pixel_ready_o     (pixel_ready),
    .pixel_sof_i       (pixel_sof),
    .pixel_eol_i       (pixel_eol),
    .pixel_i           (pixel),
    .word_valid_o      (m_axis_tvalid),
    .word_ready_i      (m_axis_tready),
    .word_sof_o        (m_axis_tuser),
    .word_eol_o        (m_axis_tlast),
    .word_o            (m_axis_tdata),
    .busy_o            (),
    .frame_start_o     (),
    .frame_end_o       (),
    .error_early_eol_o (),
    .error_late_eol_o  (),
    .error_early_sof_o (),
    .error_late_sof_o  (),
    .error_size_o      ()
  );

endmodule
