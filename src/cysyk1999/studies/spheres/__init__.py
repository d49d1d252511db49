"""What is round, against what was measured: four subjects' forces as domes, Goodwin's spheres."""
