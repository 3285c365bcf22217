"""Deformation transfer: the key models of one face made for another that has none."""
