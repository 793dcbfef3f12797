# SPDX-License-Identifier: Apache-2.0
"""The carrying task as a PettingZoo environment, `carry_v0`, with a baseline policy and rewards."""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.learn import carry_v0 as carry_v0
    from palmbots.learn.baseline_policies import Baseline as Baseline
    from palmbots.learn.baseline_policies import EpisodeResult as EpisodeResult
    from palmbots.learn.baseline_policies import Policy as Policy
    from palmbots.learn.baseline_policies import SilentBaseline as SilentBaseline
    from palmbots.learn.baseline_policies import run_episode as run_episode
    from palmbots.learn.reward import RewardWeights as RewardWeights
    from palmbots.learn.spaces import ACTION as ACTION
    from palmbots.learn.spaces import MESSAGES as MESSAGES
    from palmbots.learn.spaces import MOVES as MOVES
    from palmbots.learn.spaces import OBSERVATION as OBSERVATION
    from palmbots.learn.spaces import PALMS as PALMS
    from palmbots.learn.spaces import action as action
else:
    __getattr__, __dir__ = lazy_names(__name__)
