"""The carrying task as an environment to learn in: `palmbots.learn.carry_v0` (PettingZoo)."""
