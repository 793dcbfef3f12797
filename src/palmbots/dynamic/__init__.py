"""The dynamic world: robots, palms and object in MuJoCo, with mass, wheels and soft contacts."""
