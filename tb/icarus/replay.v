// Replays what a Verilated engine was given, clock by clock, on the plain Verilog of `make release-rtl`, and compares what
// comes out. This simulator knows four states: a bit that nothing has set is x and makes all that depends on it x.
//
// Out of reset, after the first one, every control output is compared in every clock, and data where they are valid. `x`
// counts the valid data that hold an x, `differ` the clocks in which any output that is compared is another one.
//
// The buffer of the pyramid of a front end is here, as prompt as that beside the Verilated engine. What goes through it is
// not in the trace, but an x in its framing counts, too. The filler of a frame that was cut may be x there: no word of it
// leaves.
//
// +trace=FILE  lines of inputs and outputs, as vista_rtl_record writes them

`timescale 1ns / 1ns

module replay;

  localparam BUFFER = 4096;  // beats; more than level 1 of the frames that are replayed

  reg clk_i, rst_ni, m_axis_tready;
  reg [2:0] stream;
  wire s_axis_tvalid, s_axis_tuser, s_axis_tlast;
  assign {s_axis_tvalid, s_axis_tuser, s_axis_tlast} = stream;
  reg s_axil_awvalid, s_axil_wvalid, s_axil_bready, s_axil_arvalid, s_axil_rready;
  reg [15:0] s_axis_tdata;
  reg [`ADDRESS_BITS-1:0] s_axil_awaddr, s_axil_araddr;
  reg [31:0] s_axil_wdata;

  wire s_axis_tready, m_axis_tvalid, m_axis_tuser, m_axis_tlast;
  wire s_axil_awready, s_axil_wready, s_axil_bvalid, s_axil_arready, s_axil_rvalid;
  wire [31:0] m_axis_tdata, s_axil_rdata;
  wire irq_o;
  wire [1:0] s_axil_bresp, s_axil_rresp;

  wire store_axis_tvalid, store_axis_tuser, store_axis_tlast, fetch_axis_tready, store_rst_no;
  wire [15:0] store_axis_tdata;
  wire [17:0] stored = {store_axis_tdata, store_axis_tuser, store_axis_tlast};
  reg fetch_axis_tvalid;
  reg [17:0] fetched;
  reg [17:0] buffer [0:BUFFER-1];
  integer first, behind;  // of the beats in the buffer, and behind the last one

  vista_stereo dut (
    .store_axis_tvalid(store_axis_tvalid), .store_axis_tready(1'b1), .store_axis_tdata(store_axis_tdata),
    .store_axis_tuser(store_axis_tuser), .store_axis_tlast(store_axis_tlast),
    .fetch_axis_tvalid(fetch_axis_tvalid), .fetch_axis_tready(fetch_axis_tready), .fetch_axis_tdata(fetched[17:2]),
    .fetch_axis_tuser(fetched[1]), .fetch_axis_tlast(fetched[0]), .store_rst_no(store_rst_no),
    .clk_i(clk_i), .rst_ni(rst_ni),
    .s_axis_tvalid(s_axis_tvalid), .s_axis_tready(s_axis_tready), .s_axis_tdata(s_axis_tdata),
    .s_axis_tuser(s_axis_tuser), .s_axis_tlast(s_axis_tlast),
    .m_axis_tvalid(m_axis_tvalid), .m_axis_tready(m_axis_tready), .m_axis_tdata(m_axis_tdata),
    .m_axis_tuser(m_axis_tuser), .m_axis_tlast(m_axis_tlast),
    .s_axil_awvalid(s_axil_awvalid), .s_axil_awready(s_axil_awready), .s_axil_awaddr(s_axil_awaddr),
    .s_axil_awprot(3'b0), .s_axil_wvalid(s_axil_wvalid), .s_axil_wready(s_axil_wready),
    .s_axil_wdata(s_axil_wdata), .s_axil_wstrb(4'hf), .s_axil_bvalid(s_axil_bvalid),
    .s_axil_bready(s_axil_bready), .s_axil_bresp(s_axil_bresp), .s_axil_arvalid(s_axil_arvalid),
    .s_axil_arready(s_axil_arready), .s_axil_araddr(s_axil_araddr), .s_axil_arprot(3'b0),
    .s_axil_rvalid(s_axil_rvalid), .s_axil_rready(s_axil_rready), .s_axil_rdata(s_axil_rdata),
    .s_axil_rresp(s_axil_rresp), .irq_o(irq_o)
  );

  wire [9:0] control = {s_axis_tready, m_axis_tvalid, s_axil_awready, s_axil_wready, s_axil_bvalid, s_axil_arready,
                        s_axil_rvalid, m_axis_tuser & m_axis_tvalid, m_axis_tlast & m_axis_tvalid,
                        irq_o};
  reg  [9:0] wanted_control;
  reg  [31:0] wanted_word, wanted_read;
  reg  [8*1024-1:0] name;
  reg  was_reset;
  integer file, read, clocks, words, x, differ;

  initial begin
    if (!$value$plusargs("trace=%s", name)) $finish;
    file = $fopen(name, "r");
    clocks = 0; words = 0; x = 0; differ = 0; was_reset = 0; clk_i = 0;
    read = 1;
    first = 0; behind = 0; fetch_axis_tvalid = 0; fetched = 0;
    while (read > 0) begin
      read = $fscanf(file, "%b %b %h %b %b %h %b %h %b %b %h %b | %b %h %h\n",
                     rst_ni, stream, s_axis_tdata, m_axis_tready,
                     s_axil_awvalid, s_axil_awaddr, s_axil_wvalid, s_axil_wdata, s_axil_bready,
                     s_axil_arvalid, s_axil_araddr, s_axil_rready, wanted_control, wanted_word, wanted_read);
      if (read > 0) begin
        #5;
        if (was_reset && rst_ni) begin
          if (control !== wanted_control || (m_axis_tvalid && m_axis_tdata !== wanted_word) ||
              (s_axil_rvalid && s_axil_rdata !== wanted_read)) begin
            if (differ == 0)
              $display("first: clock %0d, control %b for %b, word %h for %h, register %h for %h", clocks, control,
                       wanted_control, m_axis_tdata, wanted_word, s_axil_rdata, wanted_read);
            differ = differ + 1;
          end
          if ((m_axis_tvalid && ^{m_axis_tdata, m_axis_tuser, m_axis_tlast} === 1'bx) ||
              (s_axil_rvalid && ^s_axil_rdata === 1'bx)) x = x + 1;
          if (m_axis_tvalid && m_axis_tready) words = words + 1;
        end
        if (was_reset && rst_ni && store_axis_tvalid && ^stored[1:0] === 1'bx) x = x + 1;
        if (fetch_axis_tvalid && fetch_axis_tready) first = (first + 1) % BUFFER;
        if (store_axis_tvalid) begin
          buffer[behind] = stored;
          behind = (behind + 1) % BUFFER;
        end
        if (!store_rst_no || !rst_ni) first = behind;
        clk_i = 1;
        #5 clk_i = 0;
        fetch_axis_tvalid = first != behind;
        fetched = buffer[first];
        clocks = clocks + 1;
        if (!rst_ni) was_reset = 1;
      end
    end
    $display("%0d clocks, %0d words, %0d with x, %0d differ", clocks, words, x, differ);
    $finish;
  end

endmodule
