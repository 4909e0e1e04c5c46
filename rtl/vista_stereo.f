// SPDX-License-Identifier: Apache-2.0
-f rtl/vista_stereo_core.f
-f rtl/vista_registers.f
rtl/src/vista_stereo.sv
