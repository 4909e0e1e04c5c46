// SPDX-License-Identifier: Apache-2.0
// Types, widths and latencies of the stereo engine, each derived in one place.
//
// Vocabulary. A *slot* is one column of one row being matched: the prefiltered pixel pair (col, m) enters the costs.
// Its costs belong to the pixel (col - r, m - r), r = BlockSize / 2. Slots pass from stage to stage without ever
// stopping; a stage that is not handed a valid slot keeps its state. B stands for BlockSize, D for NumDisparities.

package vista_stereo_pkg;

  parameter int unsigned PixelW = 8;  // grey values 0 .. 255
  parameter int unsigned TextureW = 6;  // |p - c|, at most the largest prefilter cap, 63
  parameter int unsigned HeightW = 12;  // frames of at most 4095 rows
  parameter int unsigned LargestWidth = 65535;  // of a build; as wide as the register
  parameter int unsigned MinWidth = 4;  // the longest memory read-to-write distance in slots, plus one
  parameter int unsigned MinHeight = 2;  // the mirror of the x-Sobel needs two rows
  parameter int unsigned DisparityW = 13;  // -8 .. 256*16 in 1/16 px, signed
  parameter int unsigned SminW = 16;  // as sent: saturated, all ones for a pixel that is not matched
  parameter int unsigned DistanceW = 8;  // of a rival in px, signed and saturated
  parameter int unsigned MarginW = 4;  // of a rival, in 1/32 of Smin, saturated
  parameter int unsigned LengthW = 4;  // of the binary digits of a texture, at most 21 * 21 * 63
  parameter int signed Invalid = -16;  // the word of a pixel without a disparity

  // Run-time parameters. A frame keeps those that were set when its first pixel was taken.
  typedef struct packed {
    logic        confidence;         // in place of Smin; the first, so that a build without it can leave it out
    logic        xsobel;             // 0: plain grey values
    logic [5:0]  cap;                // 1 .. 63
    logic [15:0] texture_threshold;
    logic [6:0]  uniqueness_ratio;   // 0 .. 100 percent
    logic        lr_enable;
    logic [7:0]  lr_max_diff;
    logic        narrow;             // words of two disparities
  } params_t;

  // What the front end does with a frame.
  typedef struct packed {
    logic       rectify;
    logic [2:0] levels;   // 1 .. 4
    logic       smooth;
  } front_end_t;

  // A map of rectification on its way in; see vista_rectify_map.
  typedef struct packed {
    logic        begin_load;
    logic        write;
    logic [31:0] point;       // {dy, dx}
    logic        commit;
  } map_load_t;

  // Events, one clock each.
  typedef struct packed {
    logic frame_start;
    logic level_follows;  // a frame has a further level
    logic frame_end;      // a frame, or a level of it, has all of its words
    logic early_eol;
    logic late_eol;
    logic early_sof;
    logic late_sof;
    logic size;
    logic no_map;
    logic map_rows;
    logic map_size;
    logic upset;  // a bit is not as it was written, or results and frames do not fit
  } events_t;

  // A pixel of a frame, which stands beside the one below it (vista_framer).
  typedef struct packed {
    logic valid;
    logic first_col;  // column 0
    logic last_col;   // column W-1
    logic first_row;  // row 0
    logic last_row;   // row H-1
    logic flat;       // last row of an odd height: the x-Sobel is 0 there
    logic cut;        // filler after a framing error: no disparity may come of it
  } video_slot_t;

  // The same for the matching (vista_match_slots).
  typedef struct packed {
    logic valid;
    logic first_col;
    logic last_col;
    logic before_col;  // column < D-1: no block that is matched contains it
    logic early_col;   // column < D-1+B: no column that counts leaves the block
    logic first_row;
    logic last_row;
    logic flat;
    logic leave;       // row >= B: a row leaves the block for the one that enters
    logic match_row;   // row >= B-1 of a frame that is wide enough: the row has matched pixels
    logic match;       // match_row and column >= D-1+2r: a pixel is matched
    logic cut;
  } slot_t;

  // Sum over a column of the block: at most B * 255. The texture needs less (B * 63).
  function automatic int unsigned column_width(int unsigned block_size);
    return $clog2(block_size * 255 + 1);
  endfunction

  // Sum over the block: at most B * B * 255, for every odd B below the all-ones word.
  function automatic int unsigned cost_width(int unsigned block_size);
    return $clog2(block_size * block_size * 255 + 1);
  endfunction

  // Clocks from the costs to ...
  function automatic int unsigned winner_latency(int unsigned num_disparities);
    return $clog2(num_disparities);  // ... the smallest of them, one level of comparisons a clock
  endfunction

  parameter int unsigned ThresholdLatency = 4;  // from the winner to the bound of step 5
  parameter int unsigned UniquenessLatency = 2;  // from the bound to the verdict, and to the neighbours' costs
  parameter int unsigned SubpixelLatency = 11;  // from the neighbours' costs to the disparity

  function automatic int unsigned candidate_latency(int unsigned num_disparities);
    return winner_latency(num_disparities) + ThresholdLatency + UniquenessLatency + SubpixelLatency;
  endfunction

  parameter int unsigned PrefilterLatency = 7;  // from a slot at the framer to its prefiltered pixels
  parameter int unsigned DelayLatency = 2;  // of the row delay
  parameter int unsigned ColumnLatency = 4;  // from those to the column sums
  parameter int unsigned WindowLatency = 4;  // from those to the costs
  parameter int unsigned CheckLatency = 6;  // from a candidate and its right winner to the result

  // A pixel meets its right winner D-1 slots after its own; few disparities leave it to wait for its candidate.
  function automatic int unsigned check_delay(int unsigned num_disparities);
    int unsigned ready = candidate_latency(num_disparities) + 2;
    return (ready > num_disparities - 1) ? ready - (num_disparities - 1) : 0;
  endfunction

  // Depth of the rings of the check, log2: a right winner is read at most D-1 slots, the wait and 3 clocks after it was
  // written, and must not have been overwritten by then.
  function automatic int unsigned ring_width(int unsigned num_disparities);
    return $clog2(num_disparities + check_delay(num_disparities) + 3);
  endfunction

  // Results that may still come after the framer has been told to stop: one a clock of latency, and the D-1 pixels
  // that wait for their right winner. The margin of 7 covers the registers of the stop signal itself.
  function automatic int unsigned results_in_flight(int unsigned num_disparities);
    return PrefilterLatency + DelayLatency + ColumnLatency + WindowLatency + candidate_latency(num_disparities) +
        CheckLatency + (num_disparities - 1) + 7;
  endfunction

  // How long the beginning of a frame waits before it follows the results into their queue. It has to come later than the
  // last result of the frame before it, which may take D clocks in vista_right_winner and whose slot came 5 clocks earlier
  // at least (a frame of 4x2 pixels begins with its last row), and before the first of its own, which come r rows later.
  function automatic int unsigned begin_latency(int unsigned num_disparities);
    return PrefilterLatency + DelayLatency + ColumnLatency + WindowLatency + CheckLatency +
        check_delay(num_disparities) + num_disparities - 4;
  endfunction

endpackage
