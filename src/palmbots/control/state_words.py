# SPDX-License-Identifier: Apache-2.0
"""What the states of the table-driven controllers mean, in words.

The names are those of the core, include/palmbots/control/{resilient,silent,shared_sign}.hpp. The
page shows these words beside the counterexamples of the model checker.
"""

STATE_MEANINGS: dict[str, dict[str, str]] = {
    "resilient": {
        "idle": "no correction",
        "a_request": "asks the partner to tilt its palm up",
        "a_move": "moves away, its partner assists",
        "a_stop": "stops moving away",
        "b_tilt_up": "tilts its palm up; both contacts are outward, and its partner goes first",
        "c_tilt_up": "tilts its palm up to assist",
        "c_grant": "permits its partner to move away",
        "c_withdraw": "no longer permits it, and waits until its partner has stopped",
        "c_tilt_down": "tilts its palm down after assisting",
        "d_tilt_up": "tilts its palm up to correct alone",
        "d_move": "moves closer",
        "d_tilt_down": "tilts its palm down after moving closer",
    },
    "silent": {
        "centred": "its contact is centred",
        "outward": "its contact is outward",
        "inward": "its contact is inward",
        "pause": "pauses, so that its partner alone moves",
        "outward_follower": "its contact is outward, and it follows",
        "outward_stop": "stands, because its contact stays outward",
        "inward_leader": "its contact is inward, and it leads",
        "inward_stop": "stands, because its contact stays inward",
        "inward_back": "backs towards its partner",
        "start_wait": "waits until it feels that the follower has started",
        "start_push": "pushes, so that the leader feels it",
    },
    "shared-sign": {
        "rest_steep": "both contacts are centred",
        "rest_shallow": "both contacts are centred",
        "own_out": "its contact is outward, its partner's is not",
        "help_out": "its partner's contact is outward",
        "help_in": "its partner's contact is inward",
        "own_in": "its contact is inward, its partner's is centred",
        "apart_in": "its contact is inward, its partner's outward",
        "lead_out_steep": "both are outward; it leads",
        "lead_out_shallow": "both are outward; it leads",
        "lead_out_steep_ends": "both are outward; it leads and announces its next palm",
        "lead_out_shallow_ends": "both are outward; it leads and announces its next palm",
        "lead_in_steep": "both are inward; it leads",
        "lead_in_shallow": "both are inward; it leads",
        "lead_in_steep_ends": "both are inward; it leads and announces its next palm",
        "lead_in_shallow_ends": "both are inward; it leads and announces its next palm",
        "follow_out_steep": "both are outward; it follows",
        "follow_out_shallow": "both are outward; it follows",
        "follow_in_steep": "both are inward; it follows",
        "follow_in_shallow": "both are inward; it follows",
        "alone_centred": "hears nothing; its contact is centred",
        "alone_watch": "hears nothing; watches whether its partner stands",
        "alone_outward": "hears nothing; its contact is outward",
        "alone_inward": "hears nothing; its contact is inward",
        "alone_pause": "hears nothing; pauses, so that its partner alone moves",
        "alone_outward_follower": "hears nothing; its contact is outward, and it follows",
        "alone_outward_stop": "hears nothing; stands, because its contact stays outward",
        "alone_inward_leader": "hears nothing; its contact is inward, and it leads",
        "alone_inward_stop": "hears nothing; stands, because its contact stays inward",
        "alone_inward_back": "hears nothing; backs towards its partner",
        "alone_wait": "hears nothing; waits before it tries again",
    },
}
"""The meaning of each state by controller and name."""
