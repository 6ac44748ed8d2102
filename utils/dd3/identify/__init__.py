"""Identification of parameters of materials from measured values."""
