"""From the global policy to each robot's rules, and controllers checked against the policy."""
