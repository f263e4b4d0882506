"""Limit analysis of rigid blocks: eqs. (1)-(3) of Malena, Portioli et al. (2019)."""
