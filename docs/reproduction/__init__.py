"""How each paper's figures are made: a module a paper."""
