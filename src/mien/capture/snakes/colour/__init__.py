"""The colour transformation of [B] eq. 1 and the network that sets it."""
