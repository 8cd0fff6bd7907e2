"""The interface of the block with the rigid substrate: pair forces, sites and heights, adhesion of flat layers."""
