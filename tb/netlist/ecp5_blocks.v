// SPDX-License-Identifier: Apache-2.0
// Cells of an ECP5 for the simulation of netlists: those that Yosys has no models of, and one that can fail.
//
// DP16KD as Yosys maps the memories of the engine: port A writes words of 9 or 18 bits and port B reads them, or words
// of 36 bits are written and read through the pins of both ports. A word that is read while it is written comes out
// inverted, as in vista_line_store. A netlist that asks for anything else stops the simulation.
//
// MULT18X18D: an unsigned product, without registers or with those before and behind it, on one clock.
//
// LUT4_CHANGED inverts its output while it is the chosen one.

module DP16KD (
    input DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2,
      DIA1, DIA0,
    input ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0,
    input CEA, OCEA, CLKA, WEA, RSTA, CSA2, CSA1, CSA0,
    output DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2,
      DOA1, DOA0,
    input DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2,
      DIB1, DIB0,
    input ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0,
    input CEB, OCEB, CLKB, WEB, RSTB, CSB2, CSB1, CSB0,
    output DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2,
      DOB1, DOB0
);
  parameter DATA_WIDTH_A = 18;
  parameter DATA_WIDTH_B = 18;
  parameter REGMODE_A = "NOREG";
  parameter REGMODE_B = "NOREG";
  parameter WRITEMODE_A = "NORMAL";
  parameter WRITEMODE_B = "NORMAL";
  parameter CLKAMUX = "CLKA";
  parameter CLKBMUX = "CLKB";
  parameter CSDECODE_A = "0b000";
  parameter CSDECODE_B = "0b000";
  parameter RESETMODE = "SYNC";
  parameter ASYNC_RESET_RELEASE = "SYNC";
  parameter GSR = "ENABLED";

  localparam WIDE = DATA_WIDTH_A == 36;
  localparam NARROW = DATA_WIDTH_A == 9;
  localparam BYTES = DATA_WIDTH_A / 9;  // of 9 bits, in a word
  localparam KNOWN = DATA_WIDTH_A == DATA_WIDTH_B && (NARROW || DATA_WIDTH_A == 18 || WIDE) &&
      REGMODE_A == "NOREG" && (REGMODE_B == "NOREG" || (REGMODE_B == "OUTREG" && !WIDE)) &&
      CLKAMUX == "CLKA" && CLKBMUX == "CLKB" && CSDECODE_A == "0b000" && CSDECODE_B == "0b000";

  wire [13:0] write_address =
      {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0};
  wire [13:0] read_address =
      {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0};
  wire [17:0] data_a =
      {DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2, DIA1,
       DIA0};
  wire [17:0] data_b =
      {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2, DIB1,
       DIB0};

  wire [10:0] write_byte = write_address[13:3] & ~(BYTES - 1);  // the first one of the word
  wire [10:0] read_byte = read_address[13:3] & ~(BYTES - 1);
  wire [3:0] parts = WIDE ? write_address[3:0] : NARROW ? 4'b1 : {2'b00, write_address[1:0]};  // bytes to be written
  wire write = CEA & WEA & |parts;
  wire [35:0] data = {data_b, data_a};
  wire [5:0] others = {CSA2, CSA1, CSA0, CSB2, CSB1, CSB0};

  reg [8:0] mem[0:2047];
  reg [35:0] array, register;
  wire [35:0] out = REGMODE_B == "OUTREG" ? register : array;
  integer i, j;

  always @(posedge CLKA) begin
    if (write) for (i = 0; i < BYTES; i = i + 1) if (parts[i]) mem[write_byte+i] <= data[9*i+:9];
    if (!KNOWN || {others, RSTA, RSTB, WEB, OCEB} != 10'b1)
      $error("a block RAM is used in a way that its model does not know");
  end

  always @(posedge CLKB) begin
    register <= array;
    if (CEB) begin
      for (j = 0; j < BYTES; j = j + 1)
        array[9*j+:9] <= (write && write_byte == read_byte) ? ~mem[read_byte+j] : mem[read_byte+j];
    end
  end

  // The upper half of a word of 36 bits leaves at port B, as one of 18 bits does.
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2,
          DOB1, DOB0} =
      WIDE ? out[35:18] : out[17:0];
  assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2,
          DOA1, DOA0} =
      WIDE ? out[17:0] : 18'b0;
endmodule

module MULT18X18D (
    input A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0,
    input B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0,
    input C17, C16, C15, C14, C13, C12, C11, C10, C9, C8, C7, C6, C5, C4, C3, C2, C1, C0,
    input SIGNEDA, SIGNEDB, SOURCEA, SOURCEB, CLK0, CE0, RST0,
    output P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15,
      P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0
);
  parameter REG_INPUTA_CLK = "NONE";
  parameter REG_INPUTA_CE = "CE0";
  parameter REG_INPUTA_RST = "RST0";
  parameter REG_INPUTB_CLK = "NONE";
  parameter REG_INPUTB_CE = "CE0";
  parameter REG_INPUTB_RST = "RST0";
  parameter REG_OUTPUT_CLK = "NONE";
  parameter REG_OUTPUT_CE = "CE0";
  parameter REG_OUTPUT_RST = "RST0";

  localparam REGISTERS = REG_OUTPUT_CLK == "CLK0";
  localparam KNOWN = REG_INPUTA_CLK == REG_OUTPUT_CLK && REG_INPUTB_CLK == REG_OUTPUT_CLK &&
      (REGISTERS || REG_OUTPUT_CLK == "NONE");

  wire [17:0] a =
      {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
  wire [17:0] b =
      {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
  reg [17:0] a_register, b_register;
  reg [35:0] register;
  wire [35:0] product = REGISTERS ? register : {18'b0, a} * {18'b0, b};

  always @(posedge CLK0) begin
    a_register <= a;
    b_register <= b;
    register   <= {18'b0, a_register} * {18'b0, b_register};
    if (!KNOWN || {CE0, RST0} != 2'b10) $error("a multiplier is used in a way that its model does not know");
  end

  assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15,
          P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0} =
      product;
endmodule

module LUT4_CHANGED (
    input A, B, C, D,
    output Z
);
  parameter [15:0] INIT = 0;
  parameter NUMBER = 1;

  wire z;
  LUT4 #(.INIT(INIT)) sound (.A(A), .B(B), .C(C), .D(D), .Z(z));
  assign Z = z ^ (vista_stereo.u_core.mutsel == NUMBER);
endmodule

// The number of the cell that fails, 0 for none; where tb/common/mutants_core.sv has it.
module netlist_choice;
  reg [9:0] mutsel /*verilator public_flat_rw*/;
endmodule
