// SPDX-License-Identifier: Apache-2.0
// Widths and limits of rectification, each derived in one place.

package vista_rectify_pkg;

  parameter int unsigned OffsetW = 16;  // dx, dy of a control point, signed, in 1/Scale px
  parameter int unsigned Scale = 32;
  parameter int unsigned FractionW = 5;
  parameter int unsigned StepPx = 16;  // from one control point to the next
  parameter int unsigned StepW = 4;
  parameter int unsigned ValueW = OffsetW + StepW;  // an offset between two control points, times StepPx
  parameter int unsigned SlopeW = ValueW + 1;  // the difference of two of these
  parameter int unsigned SpareRows = 2;  // of the line buffer: one that arrives, one that keeps its users from waiting

  parameter int unsigned ValueLatency = 6;  // from the address of a control point to its value
  parameter int unsigned ReadLatency = 7;  // from a pixel's offset to the last clock in which the line buffer is read
  parameter int unsigned SampleLatency = 15;  // from a pixel's offset to its grey value

  // How many rows above its own a pixel may be taken from, and one less than how many below.
  function automatic int unsigned reach(int unsigned num_rows);
    return (num_rows - SpareRows) / 2 - 1;
  endfunction

  // The number of the last control point along a side: ceil(side / StepPx).
  function automatic int unsigned last_point(int unsigned side);
    return (side + StepPx - 1) >> StepW;
  endfunction

  parameter int unsigned SmallestMap = 4;  // control points of the smallest frame
  parameter int unsigned LargestMap = 2 ** 23;  // what the register can tell of

endpackage
