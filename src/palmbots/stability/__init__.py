"""Know before you carry: what holds, by how much, and which palm angles to use."""
