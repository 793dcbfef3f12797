"""Studies: many carries over any scene keys, controllers and seeds, kept where a kill cannot hurt.

axes → plan → design          what is asked: study file, design points
tally → layout → work         what a chunk of carries is, and what becomes of it
store → campaign              chunks on disk, which of them are due
local, cluster → run          who carries them
results → figures, report     what is shown
"""
