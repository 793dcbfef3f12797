# SPDX-License-Identifier: Apache-2.0
"""DDS for tests: on the loopback only, and apart from every other test on this machine."""

import secrets

_CONFIGURATION = """
<CycloneDDS><Domain>
  <General>
    <Interfaces><NetworkInterface name="lo"/></Interfaces>
    <AllowMulticast>false</AllowMulticast>
  </General>
  <Discovery>
    <ParticipantIndex>auto</ParticipantIndex>
    <MaxAutoParticipantIndex>50</MaxAutoParticipantIndex>
    <Peers><Peer address="127.0.0.1"/></Peers>
    {tag}
  </Discovery>
</Domain></CycloneDDS>
"""
_MOST_DOMAINS = 200  # larger ones use ports that the kernel may give to any socket


def dds_environment(*, tagged: bool = True) -> dict[str, str]:
    """Environment variables for all programs of one test.

    Args:
        tagged: participants see each other only with the same random tag. Without it, the random
            number of the domain has to keep tests apart, as other implementations know no tag.
    """
    tag = f"<Tag>{secrets.token_hex(8)}</Tag>" if tagged else ""
    return {
        "CYCLONEDDS_URI": _CONFIGURATION.format(tag=tag),
        "ROS_DOMAIN_ID": str(1 + secrets.randbelow(_MOST_DOMAINS)),
    }
