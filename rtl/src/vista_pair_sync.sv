// SPDX-License-Identifier: Apache-2.0
// Joins the pixels of two cameras into pairs, frame by frame; what does not belong together is refused.
//
// Cameras that are triggered together send the same pixel at nearly the same time. A frame is joined when both of its
// first pixels are there, the second no more than `max_skew_i` clocks after the first; else the one that waits is refused,
// to its end. Within a frame, too, no pixel waits longer for its partner: so a line that one camera leaves out is noticed
// before a pixel of another row is joined, as long as max_skew_i is less than the clocks between two lines, what the FIFO
// holds included.
//
// A pixel that comes too late or after a gap, an end of line on one side alone, or the start of another frame break the
// pair off before that pixel. A last pixel with an end of line in the wrong place is sent then, or without one in the last
// column, so that the frame is cut there (vista_framer) and its filler does not hold up the next one. It need not be a pair:
// the disparities of a cut frame end D pixels to the left of it. In the last column they do not, so it is sent there only
// if it is one; else the next start of frame cuts.
//
// Behind a gap it is not known any more which pixels came at the same time. So everything is dropped until both FIFOs have
// been empty, and what comes then comes as it is sent. They run empty if the engine is faster than the sensors.
//
// Latency: none; the outputs are those of the FIFOs before it, and a gate.

module vista_pair_sync #(
  parameter int unsigned SkewW = 16,
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,
  input  logic [SkewW-1:0] max_skew_i,

  input  logic [1:0]             valid_i,  // left, right
  output logic [1:0]             ready_o,
  input  logic [1:0]             sof_i,
  input  logic [1:0]             eol_i,
  input  logic [1:0]             gap_i,    // pixels before this one were lost
  input  logic [1:0][PixelW-1:0] data_i,

  output logic                valid_o,
  input  logic                ready_i,
  output logic                sof_o,
  output logic                eol_o,
  output logic [2*PixelW-1:0] data_o,  // {right, left}

  // Events, one clock each.
  output logic       pair_o,    // a pair begins to leave
  output logic       broken_o,  // one that had begun ends before its time
  output logic [1:0] refused_o  // a frame of this camera found no partner
);

  localparam int unsigned ColW = 16;

  logic paired_q;      // the pixels that come continue a pair
  logic ending_q;      // the last pixel of a pair that broke off waits
  logic [1:0] stale_q;  // this FIFO has not been empty since a gap
  logic [1:0] open_q;  // a pair has begun, and this camera has begun no other frame since
  logic [SkewW-1:0] waited_q;
  logic [ColW-1:0] col_q, last_col_q;  // of the next pixel; of the lines before
  logic ending_eol_q;
  logic [2*PixelW-1:0] ending_data_q;
  logic [1:0] starts, follows, drop;
  logic gap;
  logic both, late, start, go_on, breaks, last_col;

  assign starts   = valid_i & sof_i;
  assign follows  = valid_i & ~sof_i;
  assign gap      = |(valid_i & gap_i);
  assign both     = (&follows) & ~gap;
  assign late     = (waited_q == max_skew_i);
  assign last_col = (col_q == last_col_q);

  assign start  = (&starts) & ~gap & ~ending_q & (stale_q == '0);
  assign go_on  = paired_q & both & (eol_i[0] == eol_i[1]);
  assign breaks = paired_q & ~go_on & ~start & ((&valid_i) | (late & (|follows)));

  // What belongs to no pair goes, and the first pixel of a frame when it has waited long enough.
  always_comb begin
    if (ending_q) drop = '0;
    else if (stale_q != '0) drop = valid_i;
    else drop = (follows & {2{~paired_q}}) | (starts & {2{~start & late}});
  end

  assign refused_o = drop & starts;

  assign valid_o  = start | go_on | ending_q;
  assign sof_o    = start;
  assign eol_o    = ending_q ? ending_eol_q : eol_i[0];
  assign data_o   = ending_q ? ending_data_q : data_i;
  assign ready_o  = ({2{(start | go_on) & ready_i}}) | drop;
  assign pair_o   = start & ready_i;
  assign broken_o = breaks | (|(open_q & drop & follows));

  always_ff @(posedge clk_i) begin
    if (start) paired_q <= ready_i;
    else if (breaks | (|refused_o)) paired_q <= 1'b0;
    if (breaks) begin
      ending_q      <= both | ~last_col;
      ending_eol_q  <= ~last_col;
      ending_data_q <= data_i;
    end else if (ready_i) begin
      ending_q <= 1'b0;
    end
    if (gap & ~paired_q & ~ending_q) stale_q <= '1;
    else stale_q <= stale_q & valid_i;
    if (start) open_q <= {2{ready_i}};
    else open_q <= broken_o ? '0 : open_q & ~starts;

    if (valid_o & ready_i) col_q <= eol_o ? '0 : start ? ColW'(1) : col_q + 1'b1;
    if (go_on & ready_i & eol_o) last_col_q <= col_q;

    if (valid_o | breaks | (drop == valid_i) | (|refused_o)) waited_q <= '0;
    else if (!late) waited_q <= waited_q + 1'b1;

    if (!rst_ni) begin
      paired_q <= 1'b0;
      ending_q <= 1'b0;
      stale_q  <= '0;
      open_q   <= '0;
      waited_q <= '0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_pair_sync_properties.svh"
`endif

endmodule
