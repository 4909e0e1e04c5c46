// SPDX-License-Identifier: Apache-2.0
rtl/csr/vista_stereo_csr_pkg.sv
rtl/csr/vista_stereo_csr.sv
rtl/src/vista_axil.sv
rtl/src/vista_registers.sv
