# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of a material of steel with an internal variable of each kind: two surfaces, rate, temperature, damage, forming
limit."""

MANY_LAWS = """  density = 7.85e-9
  hardening = yoshida_uemori Y=124 B=168 C=200 m=12 b_sat=60 Rsat=190 h=0.5
  modulus = chord Ea=1.63e5 xi=30.8
  rate = power m=0.015 reference=1e-4
  temperature = johnson_cook Tr=20 Tm=500 m=0.8
  heat_capacity = 4.6e8
  fracture = table exponent=2 -0.6:2 0:0.7 0.6:0.4
  forming_limit = -0.2 0.26 0 0.16
"""
