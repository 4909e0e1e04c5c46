# SPDX-License-Identifier: Apache-2.0
"""The gateware of a board, in LiteX: what feeds vista_raw_stereo from UDP and memory."""
