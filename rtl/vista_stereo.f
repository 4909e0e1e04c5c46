// SPDX-License-Identifier: Apache-2.0
-f rtl/vista_frontend.f
-f rtl/vista_registers.f
rtl/src/vista_stereo.sv
