// SPDX-License-Identifier: Apache-2.0
// Takes the video of a camera from its pixel clock to the clock of the engine.
//
// A camera cannot wait: a pixel that finds no room is lost, and told of. Its line is then too short or has no end, so the
// frame is cut there and told of once more by whoever watches the framing (vista_framer); none is wrong in silence.
//
// The pointers cross in Gray code through two registers each way; rtl/constraints/vista_camera_fifo.xdc and .sdc bound their
// delays. Both resets are to be low together for four clocks of the slower side. Latency: 3 to 4 clocks of the reader.

module vista_camera_fifo #(
  parameter int unsigned Width = 18,
  parameter int unsigned Depth = 32,  // a power of two, 8 or more
  parameter bit Parity = 1'b0
) (
  input  logic             pixel_clk_i,
  input  logic             pixel_rst_ni,
  input  logic             valid_i,
  input  logic [Width-1:0] data_i,
  output logic             lost_o,        // for a clock: what was offered a clock before found no room

  input  logic             clk_i,
  input  logic             rst_ni,
  output logic             valid_o,
  input  logic             ready_i,
  output logic [Width-1:0] data_o,
  output logic             upset_o        // of the memory
);

  localparam int unsigned PtrW = $clog2(Depth);

  if (Depth < 8 || Depth != 2 ** PtrW) begin : gen_bad_depth
    $fatal(1, "Depth must be a power of two, 8 or more");
  end

  function automatic logic [PtrW:0] gray(logic [PtrW:0] number);
    return number ^ (number >> 1);
  endfunction

  logic [PtrW:0] write_q, write_gray_q, write_gray_meta_q, write_gray_read_q;
  logic [PtrW:0] read_q, read_gray_q, read_gray_meta_q, read_gray_write_q;
  logic full, store, empty, take;

  assign full  = (write_gray_q == {~read_gray_write_q[PtrW:PtrW-1], read_gray_write_q[PtrW-2:0]});
  assign store = valid_i & ~full;

  always_ff @(posedge pixel_clk_i) begin
    read_gray_meta_q  <= read_gray_q;
    read_gray_write_q <= read_gray_meta_q;
    lost_o            <= valid_i & full;
    if (store) begin
      write_q      <= write_q + 1'b1;
      write_gray_q <= gray(write_q + 1'b1);
    end
    if (!pixel_rst_ni) begin
      write_q           <= '0;
      write_gray_q      <= '0;
      read_gray_meta_q  <= '0;
      read_gray_write_q <= '0;
      lost_o            <= 1'b0;
    end
  end

  vista_memory #(
    .Width   (Width),
    .Depth   (Depth),
    .KeepOld (1'b1),  // what is read was written two clocks before
    .Parity  (Parity)
  ) u_memory (
    .write_clk_i  (pixel_clk_i),
    .write_i      (store),
    .write_addr_i (write_q[PtrW-1:0]),
    .write_data_i (data_i),
    .clk_i,
    .read_i       (take),
    .read_addr_i  (read_q[PtrW-1:0]),
    .read_data_o  (data_o),
    .upset_o
  );

  assign empty = (read_gray_q == write_gray_read_q);
  assign take  = ~empty & (~valid_o | ready_i);

  always_ff @(posedge clk_i) begin
    write_gray_meta_q <= write_gray_q;
    write_gray_read_q <= write_gray_meta_q;
    if (take) begin
      read_q      <= read_q + 1'b1;
      read_gray_q <= gray(read_q + 1'b1);
    end
    if (take | ready_i) valid_o <= take;
    if (!rst_ni) begin
      read_q            <= '0;
      read_gray_q       <= '0;
      write_gray_meta_q <= '0;
      write_gray_read_q <= '0;
      valid_o           <= 1'b0;
    end
  end

endmodule
