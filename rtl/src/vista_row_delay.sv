// Delays the prefiltered pixels by B rows: gives the word that leaves the block beside the one that enters it.
//
// A chain of B line stores, the word of column x handed on from each to the next: no wide bank multiplexer stands
// behind the memories, which would limit the clock.
//
// Latency: 2 clocks. `leaving_o` is meaningful from row B of a frame on (`slot_o.leave`).

module vista_row_delay #(
  parameter int unsigned Width = 22,
  parameter int unsigned BlockSize = 11,
  parameter int unsigned MaxWidth = 1024,
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
  output logic [Width-1:0]        leaving_o
);

  vista_stereo_pkg::slot_t         slot_q;
  logic [ColW-1:0]                 col_q;
  logic [Width-1:0]                entering_q;
  logic [BlockSize:0][Width-1:0]   rows;

  assign rows[0]   = entering_o;
  assign leaving_o = rows[BlockSize];

  for (genvar i = 0; i < BlockSize; i++) begin : gen_rows
    vista_line_store #(
      .Width (Width),
      .Depth (MaxWidth)
    ) u_row (
      .clk_i,
      .write_i      (slot_o.valid),
      .write_col_i  (slot_col_o),
      .write_data_i (rows[i]),
      .read_col_i   (slot_col_i),
      .read_data_o  (rows[i+1])
    );
  end

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
