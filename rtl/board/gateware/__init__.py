# SPDX-License-Identifier: Apache-2.0
"""The gateware of a board, in LiteX: what feeds the engine with its front end from UDP and memory."""
