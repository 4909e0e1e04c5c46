// SPDX-License-Identifier: Apache-2.0
// The one memory of the core: all others hold one of these. Whoever wants a macro, or codes that correct, replaces this
// file. One port writes and one reads; words of up to 32 are in distributed memory, as they would leave most of a block
// unused, of several blocks if they are wide.
//
// A word that is read while it is written is undefined, and the logic that would define it is saved (`no_rw_check`),
// unless KeepOld asks for the one from before. The benches put tb/common/vista_memory.sv in its place, of which it comes
// out inverted, so that a use would show.
//
// With Parity each piece of up to 16 bits has one bit more. A piece that comes out with one bit upset is told of, 2 clocks
// after the word; the word is used as it came. A memory then starts with words of zeros, since what was never written is
// read, too, and used by nobody.
//
// Latency: a clock from `read_i` to `read_data_o`.

module vista_memory #(
  parameter int unsigned Width = 16,
  parameter int unsigned Depth = 32,
  parameter bit KeepOld = 1'b0,  // also where both ports have clocks of their own
  parameter bit Parity = 1'b0,
  localparam int unsigned AddrW = $clog2(Depth)
) (
  input  logic             write_clk_i,
  input  logic             write_i,
  input  logic [AddrW-1:0] write_addr_i,
  input  logic [Width-1:0] write_data_i,

  input  logic             clk_i,
  input  logic             read_i,
  input  logic [AddrW-1:0] read_addr_i,
  output logic [Width-1:0] read_data_o,
  output logic             upset_o
);

  localparam int unsigned PieceW = 16;
  localparam int unsigned NumPieces = (Width + PieceW - 1) / PieceW;
  localparam int unsigned StoredW = Width + (Parity ? NumPieces : 0);

  (* no_rw_check = !KeepOld, ram_style = Depth <= 32 ? "distributed" : "block" *)
  logic [StoredW-1:0] mem[Depth];
  logic [StoredW-1:0] write_word, read_q;

  always_ff @(posedge write_clk_i) begin
    if (write_i) mem[write_addr_i] <= write_word;
  end

  always_ff @(posedge clk_i) begin
    if (read_i) read_q <= mem[read_addr_i];
  end

  assign read_data_o = read_q[Width-1:0];

  if (Parity) begin : gen_parity
    function automatic logic [NumPieces-1:0] parity(logic [Width-1:0] word);
      logic [NumPieces-1:0] bits;
      bits = '0;
      for (int unsigned i = 0; i < Width; i++) bits[i/PieceW] ^= word[i];
      return bits;
    endfunction

    logic [StoredW-1:0] word_q;  // a register behind the slow output of a block
    logic fresh_q, checked_q, defined;

    assign write_word = {parity(write_data_i), write_data_i};
    assign defined    = KeepOld | ~write_i | (write_addr_i != read_addr_i);

    initial begin
      for (int unsigned i = 0; i < Depth; i++) mem[i] = '0;
    end

    always_ff @(posedge clk_i) begin
      fresh_q   <= read_i & defined;
      word_q    <= read_q;
      checked_q <= fresh_q;
      upset_o   <= checked_q & (parity(word_q[Width-1:0]) != word_q[StoredW-1:Width]);
    end
  end else begin : gen_no_parity
    assign write_word = write_data_i;
    assign upset_o    = 1'b0;
  end

endmodule
