"""The interface of the block with the rigid substrate: pair forces, substrate sites and heights."""
