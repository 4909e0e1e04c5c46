// SPDX-License-Identifier: Apache-2.0
// A line of words in memory, written and read at any column.
//
// Latency: 2 clocks from `read_col_i` to `read_data_o`. The second register keeps the slow output of a block RAM off
// the logic behind it. A word that is read while it is written is undefined: no user needs it.
//
// What is deeper than a block RAM is in several memories, and which of them has the word is decided behind these registers
// and not before.

module vista_line_store #(
  parameter int unsigned Width = 16,
  parameter int unsigned Depth = 1024,
  parameter bit Parity = 1'b0,
  parameter int unsigned PieceDepth = 2048,  // words of a memory: of up to 9 bits a block RAM holds so many
  localparam int unsigned ColW = $clog2(Depth)
) (
  input  logic             clk_i,
  input  logic             clear_i,  // the word that comes out next reads as zero
  input  logic             write_i,
  input  logic [ColW-1:0]  write_col_i,
  input  logic [Width-1:0] write_data_i,
  input  logic [ColW-1:0]  read_col_i,
  output logic [Width-1:0] read_data_o,
  output logic             upset_o
);

  localparam int unsigned NumPieces = (Depth + PieceDepth - 1) / PieceDepth;
  localparam int unsigned PieceWords = (NumPieces == 1) ? Depth : PieceDepth;
  localparam int unsigned PlaceW = $clog2(PieceWords);
  localparam int unsigned PieceW = (NumPieces == 1) ? 1 : $clog2(NumPieces);

  logic [NumPieces-1:0][Width-1:0] word_q;
  logic [NumPieces-1:0] upset;
  logic [PieceW-1:0] write_piece, read1_q, read2_q;

  assign write_piece = PieceW'(write_col_i >> PlaceW);
  assign read_data_o = (NumPieces == 1) ? word_q[0] : word_q[read2_q];
  assign upset_o     = |upset;

  always_ff @(posedge clk_i) begin
    read1_q <= PieceW'(read_col_i >> PlaceW);
    read2_q <= read1_q;
  end

  for (genvar p = 0; p < NumPieces; p++) begin : gen_piece
    logic [Width-1:0] read;

    vista_memory #(
      .Width  (Width),
      .Depth  (PieceWords),
      .Parity (Parity)
    ) u_memory (
      .write_clk_i  (clk_i),
      .write_i      (write_i & (write_piece == PieceW'(p))),
      .write_addr_i (PlaceW'(write_col_i)),
      .write_data_i,
      .clk_i,
      .read_i       (1'b1),
      .read_addr_i  (PlaceW'(read_col_i)),
      .read_data_o  (read),
      .upset_o      (upset[p])
    );

    always_ff @(posedge clk_i) begin
      word_q[p] <= clear_i ? '0 : read;
    end
  end

endmodule
